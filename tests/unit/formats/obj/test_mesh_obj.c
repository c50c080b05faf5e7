/* OBJ and OFF read: the dialects of text. */
#include "support/meshes.h"

#include <math.h>
#include <stdio.h>

static const float points[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.5f};
static const uint32_t fan[6] = {0, 1, 2, 0, 2, 3};

#define POINTS "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 .5\n"

static void obj_is_read_in_every_dialect(void **state)
{
    (void)state;
    static const char *const texts[] = {
        POINTS "f 1 2 3 4\n",
        POINTS "f 1 2 3\nf 1 3 4",
        POINTS "f -4 -3 -2 -1\n",
        POINTS "vt 0 0\nf 1/1 2/1 3/1 4/1\n",
        POINTS "f 1/ 2/ 3// 4//\n",
        "f 1 2 3 4\n" POINTS,
        "v 0 0 0 1.0\r\nv 1 0 0\t0.5 0.5 0.5\r\no first\r\ng a b\r\nusemtl none\r\n"
        "v 1 1 0 # a corner\r\ns off\r\nv 0 1 .5\r\nf 1 2 3 \\\r\n  4\r\n",
        "# v 9 9 9\n\n\n   v 0 0 \\\n 0\nv 1 0 0\nmtllib x.mtl\no second\nv 1 1 0\nv 0 1 5e-1\n"
        "f 1 2\\\n 3 4 # f 1 1 1\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        assert_ok(read_text("a.obj", texts[i], &mesh, &file, &err), err);
        check_positions(&mesh, 4, points);
        check_triangles(&mesh, 2, fan);
        assert_int_equal(file.polygons, i != 1);
        assert_int_equal(file.known, 0);
        assert_null(mesh.normals);
        assert_usable(&mesh);
        cw_mesh_free(&mesh);
    }
}

#define NORMALS "vn 0 0 1\nvn 0 1 0\nvn 0 0 1\n"

static void obj_normals_are_kept_when_each_vertex_has_one(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        bool kept;
    } rows[] = {
        {POINTS NORMALS "f 1//1 2//1 3//2 4//2\n", true},
        {POINTS NORMALS "f 1/1/1 2//-3 3//2 4//-2\n", true},
        {POINTS NORMALS "f 1//1 2//1 3//2\nf 1//3 3//2 4//2\n", true}, /* the same by value */
        {POINTS NORMALS "f 1//1 2//1 3//2\nf 1//2 3//2 4//2\n", false},
        {POINTS NORMALS "f 1//1 2//1 3//2\n", false},
        {POINTS NORMALS "f 1//1 2//1 3//2 4\n", false},
        {POINTS NORMALS "f 1//1 2//1 3//2 4//4\n", false},
        {POINTS NORMALS "f 1//1 2//1 3//2 4//-9\n", false},
        {POINTS "vn nan 0 1\nf 1//1 2//1 3//1 4//1\n", false},
        {POINTS "vn 0 1e99 1\nf 1//1 2//1 3//1 4//1\n", false},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        cw_mesh mesh;
        cw_error err = {0};
        assert_ok(read_text("a.obj", rows[i].text, &mesh, NULL, &err), err);
        if (!mesh.normals != !rows[i].kept)
            fail_msg("row %zu: normals are %s", i, rows[i].kept ? "missing" : "there");
        if (mesh.normals)
            assert_true(mesh.normals[5] == 1 && mesh.normals[10] == 1);
        cw_mesh_free(&mesh);
    }
}

static void obj_points_and_lines_are_counted(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    assert_ok(read_text("a.obj", POINTS "p 1\nl 1 2\nl 2 3\nf 1 2\n", &mesh, &file, &err), err);
    assert_int_equal(file.skipped, 4);
    assert_int_equal(mesh.vertex_count, 4);
    assert_int_equal(mesh.triangle_count, 0);
    cw_mesh_free(&mesh);
}

/* A comment like our writer's counts only in a file that begins as ours do. */
static void obj_origins_of_others_are_comments(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_mesh_file file;
    cw_error err = {0};
    assert_ok(read_text("a.obj", "# origin 1 2 3\n" POINTS, &mesh, &file, &err), err);
    assert_true(mesh.origin[0] == 0 && !file.local);
    cw_mesh_free(&mesh);
    assert_ok(read_text("a.obj", "# cubewright 9, LPS, mm\n# origin 1 2 3\n" POINTS, &mesh,
                        &file, &err),
              err);
    assert_true(mesh.origin[2] == 3 && file.local);
    assert_int_equal(file.known, CW_KNOWN_UNIT | CW_KNOWN_FRAME);
    cw_mesh_free(&mesh);
}

/* A polygon on a line of a megabyte. */
static void obj_lines_may_be_long(void **state)
{
    (void)state;
    enum { CORNERS = 200000 };
    char *text = malloc(100 + 6 * CORNERS);
    cw_mesh mesh;
    cw_error err = {0};
    assert_non_null(text);
    size_t used = (size_t)sprintf(text, POINTS "f");
    for (int i = 0; i < CORNERS; i++)
        used += (size_t)sprintf(text + used, " %d", i % 4 + 1);
    text[used++] = '\n';
    assert_ok(read_bytes("a.obj", text, used, &mesh, NULL, &err), err);
    assert_int_equal(mesh.triangle_count, CORNERS - 2);
    cw_mesh_free(&mesh);
    free(text);
}

static void broken_obj_is_told_by_line(void **state)
{
    (void)state;
    static const refused rows[] = {
        {"v 1 2\n", "line 1: the line ends before a coordinate; a number was expected"},
        {"v 1 2 z\n", "line 1: a coordinate is 'z'"},
        {"v 1 2 1e400\n", "'z' of vertex 1 is inf"},
        {"v 1 2 nan\n", "'z' of vertex 1 is nan"},
        {"v 0 0 0\nv 1 2 1e39\n", "beyond single precision"},
        {"vn 1 2\n", "line 1: the line ends before a normal's coordinate"},
        {POINTS "f 1 2 5\n", "triangle 0 names vertex 5 of 4"},
        {POINTS "f 1 2 0\n", "line 5: a corner names vertex 0; there are 4 so far, from 1"},
        {POINTS "f 1 2 -5\n", "line 5: a corner names vertex -5"},
        {POINTS "f 1 2 99999999999\n", "line 5: a corner names vertex 99999999999"},
        {POINTS "f 1 2 3x\n", "line 5: a corner is '3x'"},
        {POINTS "f 1 2 3/x\n", "line 5: a corner is '3/x'"},
        {POINTS "f 1 2 3/1/1/1\n", "line 5: a corner is '3/1/1/1'"},
        {POINTS "f 1 2 99999999999999999999\n", "line 5: a corner is '9999"},
    };
    check_refused("a.obj", rows, sizeof rows / sizeof *rows);
}

static void off_is_read_in_every_dialect(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "OFF\n4 1 4\n0 0 0\n1 0 0\n1 1 0\n0 1 .5\n4 0 1 2 3\n",
        "OFF 4 2\n# a comment\n0 0 0 # here\n\n1 0 0\n1 1 0\n0 1 .5\n3 0 1 2 255 0 0\n3 0 2 3",
        "\n# first\nCOFF\n4 1 0\r\n0 0 0 255 0 128\n1 0 0 1. 0. 0.502 1.\n1 1 0\n"
        "0 1 .5 255 0 128 255\n4  0 1 2 3  0.1 0.2 0.3\n",
        "NOFF\n4 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 .5 0 0 1\n4 0 1 2 3\n",
        "STCNOFF\n4 1 0\n0 0 0 0 0 1 1 2 3 4 .5 .5\n1 0 0 0 0 1 1 2 3 4 .5 .5\n"
        "1 1 0 0 0 1 1 2 3 4 .5 .5\n0 1 .5 0 0 1 1 2 3 4 .5 .5\n4 0 1 2 3\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        cw_mesh mesh;
        cw_mesh_file file;
        cw_error err = {0};
        assert_ok(read_text("a.off", texts[i], &mesh, &file, &err), err);
        assert_string_equal(file.format, "off");
        check_positions(&mesh, 4, points);
        check_triangles(&mesh, 2, fan);
        assert_true(!mesh.normals == (i < 3));
        assert_true(!mesh.colors == (i != 2 && i != 4));
        if (i == 2)
            assert_memory_equal(mesh.colors,
                                "\xff\0\x80\xff"
                                "\xff\0\x80\xff"
                                "\xff\xff\xff\xff"
                                "\xff\0\x80\xff",
                                16);
        assert_usable(&mesh);
        cw_mesh_free(&mesh);
    }
}

#define OFF3 "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n"

static void broken_off_is_told_by_line(void **state)
{
    (void)state;
    static const refused rows[] = {
        {"3 1 0\n", "line 1: the first word is '3'; OFF, COFF, NOFF or STOFF was expected"},
        {"4OFF\n1 1 0\n", "another dimension than 3"},
        {"OFF BINARY\n", "binary OFF is not read"},
        {"OFF\n", "the number of vertices"},
        {"OFF\n3\n", "line 2: the line ends before the number of faces"},
        {"OFF\n-3 1 0\n", "there cannot be -3 vertices"},
        {"OFF\n1000000000 1 0\n0 0 0\n", "line 2 counts 1000000000 vertices and 1 faces"},
        {"OFF\n1 9223372036854775807 0\n0 0 0\n", "the file has only"},
        {"OFF\n2 0 0\n0 0 0                  \n", "the file ends after 1 of 2 vertices"},
        {OFF3, "the file ends after 0 of 1 faces"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0            \n", "the file ends after 0 of 1 faces"},
        {OFF3 "3 0 1 3\n", "triangle 0 names vertex 3 of 3"},
        {OFF3 "3 0 1 -1\n", "vertex -1, which cannot be"},
        {OFF3 "3 0 1\n", "line 6: the line ends before a corner"},
        {OFF3 "-1 0 1\n", "line 6: a face has -1 corners"},
        {"OFF\n1 0 0\n0 0 inf\n", "'z' of vertex 0 is inf"},
    };
    check_refused("a.off", rows, sizeof rows / sizeof *rows);
}

static void memory_may_run_out_in_off_and_obj(void **state)
{
    (void)state;
    static const char off[] = "CNOFF\n3 1 0\n0 0 0 0 0 1 9 9 9\n1 0 0 0 0 1 9 9 9\n"
                              "0 1 0 0 0 1 9 9 9\n3 0 1 2\n";
    static const char obj[] = POINTS NORMALS "f 1//1 2//1 3//2 4//2\n";
    test_file_write(test_path("a.off"), off, strlen(off));
    test_file_write(test_path("a.obj"), obj, strlen(obj));
    check_starved_mesh_reads("a.off");
    check_starved_mesh_reads("a.obj");
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(obj_is_read_in_every_dialect),
        TEST(obj_normals_are_kept_when_each_vertex_has_one),
        TEST(obj_points_and_lines_are_counted),
        TEST(obj_origins_of_others_are_comments),
        TEST(obj_lines_may_be_long),
        TEST(broken_obj_is_told_by_line),
        TEST(off_is_read_in_every_dialect),
        TEST(broken_off_is_told_by_line),
        TEST(memory_may_run_out_in_off_and_obj),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
