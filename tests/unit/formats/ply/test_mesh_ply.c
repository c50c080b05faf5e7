/* PLY read: every encoding, any order, and headers that lie. */
#include "support/meshes.h"

#include <math.h>
#include <stdio.h>

static const float points[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.5f};
static const uint32_t fan[6] = {0, 1, 2, 0, 2, 3};

static void text_in_any_order_with_things_unknown(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
        "0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n4 0 1 2 3\n",
        /* faces first, z first, lists among the vertices, an element of its own, no
         * line ends */
        "ply\r\nformat ascii 1.0\r\nobj_info made by hand\r\ncomment x y z\r\n"
        "element face 2\r\nproperty float quality\r\nproperty list int8 uint16 "
        "vertex_indices\r\n"
        "property list uchar float texcoord\r\n"
        "element edge 2\r\nproperty int a\r\nproperty int b\r\n"
        "element vertex 4\r\nproperty float64 z\r\nproperty list uint char odd\r\n"
        "property float32 y\r\nproperty int16 x\r\nend_header\r\n"
        "7 3 0 1 2 2 0.5 0.5\r\n7 3 0 2 3 0 1 2 3 4 0 0 0 0 0 2 9 9 0 1\r\n"
        "0 0 1e0 1 0.5 1 3 1 0",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        assert_ok(read_text("a.txt", texts[i], &mesh, &file, &err), err);
        assert_string_equal(file.format, "ply");
        assert_int_equal(file.known, 0);
        assert_int_equal(file.polygons, i == 0);
        check_positions(&mesh, 4, points);
        check_triangles(&mesh, 2, fan);
        assert_null(mesh.normals);
        assert_usable(&mesh);
        cw_mesh_free(&mesh);
    }
}

/* Puts a number in a type of PLY, in either byte order; returns the end of it. */
static char *put(char *to, double value, const char *type, bool big_endian)
{
    union {
        char bytes[8];
        int8_t i8;
        uint8_t u8;
        int16_t i16;
        uint16_t u16;
        int32_t i32;
        uint32_t u32;
        float f32;
        double f64;
    } n = {{0}};
    size_t size = 0;
#define CASE(name, member, ctype)                                                              \
    if (strcmp(type, name) == 0) {                                                             \
        n.member = (ctype)value;                                                               \
        size = sizeof(ctype);                                                                  \
    }
    CASE("char", i8, int8_t)
    CASE("uchar", u8, uint8_t)
    CASE("short", i16, int16_t)
    CASE("ushort", u16, uint16_t)
    CASE("int", i32, int32_t)
    CASE("uint", u32, uint32_t)
    CASE("float", f32, float)
    CASE("double", f64, double)
#undef CASE
    for (size_t i = 0; i < size; i++)
        to[i] = n.bytes[big_endian ? size - 1 - i : i];
    return to + size;
}

/* A quadrilateral of points in one type, its corners in the same, counted in uchar. */
static size_t make_binary(char *bytes, const char *type, bool big_endian)
{
    char *at =
        bytes + sprintf(bytes,
                        "ply\nformat binary_%s_endian 1.0\nelement vertex 4\nproperty %s x\n"
                        "property %s y\nproperty %s z\nelement face 1\n"
                        "property list uchar %s vertex_indices\nend_header\n",
                        big_endian ? "big" : "little", type, type, type, type);
    for (size_t i = 0; i < 12; i++)
        at = put(at, (double)points[i], type, big_endian);
    *at++ = 4;
    for (int i = 0; i < 4; i++)
        at = put(at, i, type, big_endian);
    return (size_t)(at - bytes);
}

static void every_type_in_both_byte_orders(void **state)
{
    (void)state;
    static const char *const types[] = {"char", "uchar", "short", "ushort",
                                        "int",  "uint",  "float", "double"};
    for (size_t i = 0; i < 16; i++) {
        char bytes[500];
        cw_mesh mesh;
        cw_error err = {0};
        float wanted[12];
        memcpy(wanted, points, sizeof wanted);
        wanted[11] = i / 2 < 6 ? 0 : 0.5f;
        const size_t size = make_binary(bytes, types[i / 2], i % 2);
        assert_ok(read_bytes("a.ply", bytes, size, &mesh, NULL, &err), err);
        check_positions(&mesh, 4, wanted);
        check_triangles(&mesh, 2, fan);
        cw_mesh_free(&mesh);
        for (size_t n = 4; n < size; n++) /* no beginning of it is a file */
            assert_true(read_bytes("a.ply", bytes, n, &mesh, NULL, &err) != CW_OK);
    }
}

#define XYZ  "property float x\nproperty float y\nproperty float z\n"
#define HEAD "ply\nformat ascii 1.0\n"

static void colors_of_every_kind_become_bytes(void **state)
{
    (void)state;
    static const struct {
        const char *type, *values;
    } rows[] = {
        {"uchar", "255 0 128"},
        {"ushort", "65535 0 32896"},
        {"float", "1 -3 0.5"}, /* halves go up */
        {"double", "7 0 0.5"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        static const uint8_t wanted[4] = {255, 0, 128, 255};
        char text[500];
        cw_mesh mesh;
        cw_error err = {0};
        const char *t = rows[i].type;
        snprintf(text, sizeof text,
                 HEAD
                 "element vertex 1\n" XYZ
                 "property %s red\nproperty %s green\nproperty %s blue\nend_header\n1 2 3 %s",
                 t, t, t, rows[i].values);
        assert_ok(read_text("a.ply", text, &mesh, NULL, &err), err);
        assert_int_equal(mesh.vertex_count, 1);
        assert_int_equal(mesh.triangle_count, 0);
        assert_memory_equal(mesh.colors, wanted, 4);
        cw_mesh_free(&mesh);
    }
}

/* Labels are whole numbers from 0 to the largest; others become the nearest of these. */
static void labels_stay_in_their_range(void **state)
{
    (void)state;
    static const uint32_t wanted[] = {7, 0, 4294967295, 0};
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(read_text("a.ply",
                        HEAD "element vertex 4\n" XYZ "property double label\nend_header\n"
                             "1 2 3 7\n1 2 4 -9\n1 2 5 1e12\n1 2 6 nan\n",
                        &mesh, NULL, &err),
              err);
    assert_non_null(mesh.labels);
    assert_memory_equal(mesh.labels, wanted, sizeof wanted);
    cw_mesh_free(&mesh);
}

/* Half a set of normals, or one that is NaN, is worth nothing. */
static void normals_must_be_whole(void **state)
{
    (void)state;
    static const struct {
        const char *properties, *values;
        bool kept;
    } rows[] = {
        {"property float nx\nproperty float ny\nproperty float nz\n", "0 0 1", true},
        {"property float nx\nproperty float ny\nproperty float nz\n", "0 nan 1", false},
        {"property float nx\nproperty float ny\n", "0 0", false},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[500];
        cw_mesh mesh;
        cw_error err = {0};
        snprintf(text, sizeof text, HEAD "element vertex 1\n" XYZ "%send_header\n1 2 3 %s\n",
                 rows[i].properties, rows[i].values);
        assert_ok(read_text("a.ply", text, &mesh, NULL, &err), err);
        assert_true(!mesh.normals == !rows[i].kept);
        cw_mesh_free(&mesh);
    }
}

static void faces_of_two_corners_are_counted(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    assert_ok(read_text("a.ply",
                        HEAD "element vertex 3\n" XYZ
                             "element face 4\nproperty list uchar int vertex_indices\n"
                             "end_header\n0 0 0 1 0 0 0 1 0\n0\n1 0\n2 0 1\n3 0 1 2\n",
                        &mesh, &file, &err),
              err);
    assert_int_equal(mesh.triangle_count, 1);
    assert_int_equal(file.skipped, 3);
    cw_mesh_free(&mesh);
}

/* Doubles far from zero keep their shape through an origin; singles keep their bits. */
static void far_doubles_get_an_origin(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(read_text("a.ply",
                        HEAD
                        "element vertex 2\nproperty double x\nproperty double y\n"
                        "property double z\nend_header\n1e6 2e6 3e6\n1000000.001 2e6 3e6\n",
                        &mesh, NULL, &err),
              err);
    assert_near(mesh.origin[0], 1000000.0005, 1e-9);
    assert_near((double)mesh.positions[3] - (double)mesh.positions[0], 0.001, 1e-9);
    cw_mesh_free(&mesh);
    assert_ok(read_text("a.ply",
                        HEAD "element vertex 2\n" XYZ "end_header\n1e6 2e6 3e6\n"
                             "1000000.0625 2e6 3e6\n",
                        &mesh, NULL, &err),
              err);
    assert_true(mesh.origin[0] == 0 && mesh.positions[3] == 1000000.0625f);
    cw_mesh_free(&mesh);
}

#define FACES "element face 1\nproperty list uchar int vertex_indices\n"
#define THREE HEAD "element vertex 3\n" XYZ FACES "end_header\n0 0 0 1 0 0 0 1 0\n"

static void broken_files_are_told_apart(void **state)
{
    (void)state;
    static const refused rows[] = {
        {"ply\n", "the second line is not 'format ...'"},
        {"ply \nformat binary 1.0\n", "'format' is 'binary'"},
        {HEAD, "the header has no 'end_header'"},
        {HEAD "property float x\n", "stands before any element"},
        {HEAD "element vertex 3\nproperty half x\n", "a property of type 'half'"},
        {HEAD "element vertex -3\n", "'element' is"},
        {HEAD "element vertex 99999999999999999999\n", "'element' is"},
        {HEAD "element vertex 1\nelement vertex 1\n", "two elements 'vertex'"},
        {HEAD "element vertex 1\n" XYZ "property float x\nend_header\n0 0 0 0",
         "is there twice in the header"},
        {HEAD "element tristrips 1\n", "'tristrips' is not read"},
        {HEAD "element vertex 1\nproperty float x\nend_header\n1", "no properties x, y and z"},
        {HEAD "element vertex 0\n" XYZ "element face 1\nproperty int vertex_indices\n"
              "end_header\n1 1",
         "no list 'vertex_indices'"},
        {HEAD "element face 1\nproperty list float int vertex_indices\n",
         "counts with a type that is not whole"},
        {HEAD "elephant\n", "holds 'elephant'"},
        {HEAD "element thing 1000000000000\nend_header\n", "element 'thing' has no properties"},
        {HEAD "element vertex 3000000000\n" XYZ "end_header\n1 2 3\n",
         "element 'vertex' is there 3000000000 times; the file has only 7 bytes"},
        {THREE "3 0 1 3\n", "triangle 0 names vertex 3 of 3"},
        {THREE "3 0 1 -1\n", "names vertex -1, which cannot be"},
        {THREE "3 0 1 99999999999\n", "names vertex 99999999999, which cannot be"},
        {THREE "3 0 1 1.5\n", "element 'face' holds 1.5 where a whole number belongs"},
        {THREE "-1 0 1 1\n", "element 'face' has a list of -1 numbers"},
        {THREE "200 0 1 1\n", "the file ends before element 'face'"},
        {THREE "3 0 1\n", "the file ends before element 'face'"},
        {THREE "3 0 one 2\n", "line 11: element 'face' is 'one'; a number was expected"},
        {HEAD "element vertex 1\n" XYZ "end_header\n1 inf 3\n", "'y' of vertex 0 is inf"},
        {HEAD "element vertex 2\n" XYZ "end_header\n0 0 0 1 2 1e99\n",
         "beyond single precision"},
        {HEAD "element vertex 1\n" XYZ "end_header\n1 2 1e999\n", "'z' of vertex 0 is inf"},
    };
    check_refused("a.ply", rows, sizeof rows / sizeof *rows);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(text_in_any_order_with_things_unknown),
        TEST(every_type_in_both_byte_orders),
        TEST(colors_of_every_kind_become_bytes),
        TEST(labels_stay_in_their_range),
        TEST(normals_must_be_whole),
        TEST(faces_of_two_corners_are_counted),
        TEST(far_doubles_get_an_origin),
        TEST(broken_files_are_told_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
