/* Tests the reader and writer of FreeSurfer's surfaces: triangles, quadrangles, the geometry behind them,
 * and files that lie. */
#include "support/meshes.h"

#include <stdio.h>

static const float places[12] = {1, 2, 3, 4, 2, 3, 1, 6, 3, 1, 2, 9.5f};
static const uint32_t corners[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
static const float turned[12] = {-1, -2, 3, -4, -2, 3, -1, -6, 3, -1, -2, 9.5f}; /* LPS */

typedef struct buffer {
    unsigned char at[2000];
    size_t size;
} buffer;

static void put(buffer *b, const void *bytes, size_t size)
{
    assert_true(b->size + size <= sizeof b->at);
    memcpy(b->at + b->size, bytes, size);
    b->size += size;
}

/* Puts a number, its highest byte first. */
static void put_number(buffer *b, uint32_t number, size_t bytes)
{
    for (size_t n = bytes; n-- > 0;)
        b->at[b->size++] = (unsigned char)(number >> 8 * n);
}

static void put_real(buffer *b, float real)
{
    uint32_t bits;
    memcpy(&bits, &real, sizeof bits);
    put_number(b, bits, 4);
}

/* A tetrahedron of triangles, with text behind it. tags: 0 no tags, 1 none of use of the scanner, else
 * that and its value + 2. */
static void make_file(buffer *b, const char *stamp, int tags, const char *geometry)
{
    b->size = 0;
    put_number(b, 0xFFFFFE, 3);
    put(b, stamp, strlen(stamp));
    put_number(b, 4, 4);
    put_number(b, 4, 4);
    for (size_t i = 0; i < 12; i++)
        put_real(b, places[i]);
    for (size_t i = 0; i < 12; i++)
        put_number(b, corners[i], 4);
    if (tags >= 2) {
        put_number(b, 2, 4);
        put_number(b, (uint32_t)tags - 2, 4);
    }
    if (tags)
        put_number(b, 20, 4);
    put(b, geometry, strlen(geometry));
}

#define STAMP "created by me on a day\n\n"
#define GEOMETRY(valid, x, y, z, c)                                                            \
    "valid = " valid                                                                           \
    "\nfilename = cras\nvolume = 200 220 256\nvoxelsize = 1 0.9 1.1\nxras   = " x              \
    "\nyras   = " y "\nzras   = " z "\ncras   = " c "\n"
#define CORONAL_AT(valid, c) GEOMETRY(valid, "-1.0e+00 0 1e-9", "0 0 -1", "0 1 0", c)

static void surfaces_lie_in_the_scanner(void **state)
{
    (void)state;
    static const struct {
        const char *stamp;
        int tags;
        const char *geometry;
        double origin[3];
        float first[3]; /* vertex */
        const char *placed;
    } rows[] = {
        {STAMP, 0, "", {0}, {-1, -2, 3}, ""},
        {"created long ago\n", 0, "", {0}, {-1, -2, 3}, ""},
        {"\n\n", 2, CORONAL_AT("1  # volume info valid", "0 0 0"), {0}, {-1, -2, 3}, ""},
        {STAMP,
         2,
         CORONAL_AT("1  # volume info valid", "3.5 -17.25 9"),
         {-3.5, 17.25, 9},
         {-1, -2, 3},
         "c_ras: a shift by (3.5, -17.25, 9) mm, RAS"},
        {STAMP,
         1,
         CORONAL_AT("1", "3.5 -17.25 9"),
         {-3.5, 17.25, 9},
         {-1, -2, 3},
         "c_ras: a shift by (3.5, -17.25, 9) mm, RAS"},
        {STAMP,
         3,
         CORONAL_AT("1", "3.5 -17.25 9"),
         {0},
         {-1, -2, 3},
         ""}, /* is there already */
        {STAMP,
         2,
         CORONAL_AT("0  # volume info invalid", "3.5 -17.25 9"),
         {0},
         {-1, -2, 3},
         ""},
        /* x, y, z of the volume to the left, back and up: (x, y, z) comes to (-x, -(-y), ...) */
        {STAMP,
         2,
         GEOMETRY("1", "-1 0 0", "0 -1 0", "0 0 1", "10 0 0"),
         {0},
         {-11, -3, 2},
         "c_ras: a turn and a shift by (10, 0, 0) mm, RAS"},
        {STAMP, 0, "\0\0\0\7 something else", {0}, {-1, -2, 3}, ""},
    };
    static buffer b;
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        make_file(&b, rows[n].stamp, rows[n].tags, rows[n].geometry);
        assert_ok(read_bytes("lh.white", b.at, b.size, &mesh, &file, &err), err);
        assert_string_equal(file.format, "freesurfer");
        assert_true(file.axes.ras && file.known == (CW_KNOWN_UNIT | CW_KNOWN_FRAME));
        for (size_t a = 0; a < 3; a++)
            if (mesh.origin[a] != rows[n].origin[a] || mesh.positions[a] != rows[n].first[a])
                fail_msg("row %zu, axis %zu: %g + %g", n, a, mesh.origin[a],
                         (double)mesh.positions[a]);
        if (!strstr(rows[n].placed, "turn")) {
            check_positions(&mesh, 4, turned);
            check_triangles(&mesh, 4, corners);
        }
        assert_string_equal(file.placed, rows[n].placed);
        cw_mesh_free(&mesh);
    }
}

static void geometry_that_lies_is_told(void **state)
{
    (void)state;
    static const struct {
        const char *geometry, *words;
    } rows[] = {
        {"valid = 1\nxras = 1 0 0\n", "the geometry of the volume is cut off"},
        {GEOMETRY("1", "1 0", "0 1 0", "0 0 1", "0 0 0"),
         "the geometry of the volume is cut off"},
        {GEOMETRY("1", "1 0 0", "1 0 0", "0 0 1", "0 0 0"),
         "c_ras maps everything onto a plane"},
        {GEOMETRY("1", "1 0 0", "0 1 0", "0 0 1", "0 nan 0"),
         "c_ras has a number that is not finite"},
    };
    static buffer b;
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_mesh mesh;
        cw_error err = {0};
        make_file(&b, STAMP, 2, rows[n].geometry);
        assert_fails(read_bytes("lh.white", b.at, b.size, &mesh, NULL, &err), CW_ERR_FORMAT,
                     rows[n].words, err);
    }
}

/* Two quadrangles: the first begins at an even vertex, the second at an odd one. */
static void make_quadrangles(buffer *b, bool hundredths)
{
    static const int16_t points[15] = {0, 0, 0, 10, 0, 0, 10, 10, 0, 0, 10, 0, 0, -5, 5};
    static const uint32_t faces[8] = {0, 1, 2, 3, 1, 2, 3, 4};
    b->size = 0;
    put_number(b, hundredths ? 0xFFFFFF : 0xFFFFFD, 3);
    put_number(b, 5, 3);
    put_number(b, 2, 3);
    for (size_t i = 0; i < 15; i++)
        if (hundredths)
            put_number(b, (uint16_t)(100 * points[i]), 2);
        else
            put_real(b, points[i]);
    for (size_t i = 0; i < 8; i++)
        put_number(b, faces[i], 3);
}

static void quadrangles_are_cut_as_by_freesurfer(void **state)
{
    (void)state;
    static const float expected[15] = {0, 0, 0, -10, 0, 0, -10, -10, 0, 0, -10, 0, 0, 5, 5};
    static const uint32_t triangles[12] = {0, 1, 3, 2, 3, 1, 1, 2, 3, 1, 3, 4};
    static buffer b;
    for (int n = 0; n < 2; n++) {
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        make_quadrangles(&b, n);
        assert_ok(read_bytes("lh.orig", b.at, b.size, &mesh, &file, &err), err);
        check_positions(&mesh, 5, expected);
        check_triangles(&mesh, 4, triangles);
        assert_int_equal(file.polygons, 2);
        cw_mesh_free(&mesh);
    }
}

static void damaged_files_are_told_where(void **state)
{
    (void)state;
    static const struct {
        size_t at; /* of a byte that is changed */
        unsigned char to;
        size_t cut; /* bytes left; 0: all */
        const char *words;
    } rows[] = {
        {0, 0xFF, 130, "the header counts 4 vertices and 4 faces; the file has 130 bytes"},
        {27, 0x70, 0, "the header counts 1879048196 vertices"},
        {31, 0xF0, 0, "vertices and 4026531844 faces"},
        {35, 0x7f, 0, "'x' of vertex 0 is"},
        {83, 0x80, 0, "triangle 0 names vertex -2147483648 of 4"},
        {86, 4, 0, "triangle 0 names vertex 4 of 4"},
    };
    static buffer b;
    cw_mesh mesh;
    cw_error err = {0};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        make_file(&b, STAMP, 0, "");
        b.at[rows[n].at] = rows[n].to;
        if (rows[n].at == 35)
            b.at[36] = 0xC0; /* not a number */
        assert_fails(
            read_bytes("lh.white", b.at, rows[n].cut ? rows[n].cut : b.size, &mesh, NULL, &err),
            CW_ERR_FORMAT, rows[n].words, err);
    }
    const cw_mesh_read_desc named = {.reader = "freesurfer"};
    test_file_write(test_path("a"), "OFF\n", 4);
    assert_fails(cw_mesh_read(test_path("a"), &named, &mesh, NULL, &err), CW_ERR_FORMAT,
                 "does not begin as a surface of FreeSurfer", err);
    b.size = 0; /* lh.curv */
    put_number(&b, 0xFFFFFF, 3);
    put_number(&b, 2, 4);
    put_number(&b, 1, 4);
    put_number(&b, 1, 4);
    put_real(&b, 1);
    put_real(&b, 2);
    assert_fails(read_bytes("lh.curv", b.at, b.size, &mesh, NULL, &err), CW_ERR_FORMAT,
                 "the file holds the curvature of 2 vertices", err);
}

static void no_byte_is_trusted(void **state)
{
    (void)state;
    static buffer b;
    for (int n = 0; n < 3; n++) {
        if (n)
            make_quadrangles(&b, n == 1);
        else
            make_file(&b, STAMP, 2, CORONAL_AT("1", "3.5 -17.25 9"));
        for (size_t i = 0; i < b.size; i++) {
            cw_mesh mesh;
            cw_error err = {0};
            const unsigned char kept = b.at[i];
            b.at[i] ^= 0x11;
            if (read_bytes("lh.white", b.at, b.size, &mesh, NULL, &err) == CW_OK)
                assert_usable(&mesh);
            cw_mesh_free(&mesh);
            b.at[i] = kept;
            if (read_bytes("lh.white", b.at, i + 1, &mesh, NULL, &err) == CW_OK)
                assert_usable(&mesh);
            cw_mesh_free(&mesh);
        }
    }
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    static buffer b;
    make_quadrangles(&b, true);
    test_file_write(test_path("lh.orig"), b.at, b.size);
    check_starved_mesh_reads("lh.orig");
}

static void a_local_file_has_its_origin_as_centre(void **state)
{
    (void)state;
    cw_mesh mesh, back;
    cw_mesh_file file;
    cw_error err = {0};
    test_make_cube(&mesh);
    mesh.origin[0] = 1000.1;
    assert_ok(
        cw_mesh_write(test_path("lh.white"), &mesh, &(cw_write_desc){.local = true}, &err),
        err);
    assert_ok(cw_mesh_read(test_path("lh.white"), NULL, &back, &file, &err), err);
    assert_true(file.local && back.origin[0] == 1000.1);
    check_positions(&back, mesh.vertex_count, mesh.positions);
    cw_mesh_free(&back);
    assert_ok(cw_mesh_write(test_path("lh.sphere"), &mesh,
                            &(cw_write_desc){.format = "freesurfer"}, &err),
              err);
    assert_ok(cw_mesh_read(test_path("lh.sphere"), NULL, &back, &file, &err), err);
    assert_true(!file.local && back.origin[0] == 0);
    check_triangles(&back, mesh.triangle_count, mesh.triangles);
    cw_mesh_free(&back);
    cw_mesh_free(&mesh);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(surfaces_lie_in_the_scanner),
        TEST(geometry_that_lies_is_told),
        TEST(quadrangles_are_cut_as_by_freesurfer),
        TEST(damaged_files_are_told_where),
        TEST(no_byte_is_trusted),
        TEST(memory_may_run_out_anywhere),
        TEST(a_local_file_has_its_origin_as_centre),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
