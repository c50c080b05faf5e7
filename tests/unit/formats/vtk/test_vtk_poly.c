/* Tests the reader of legacy VTK surfaces: both forms, both generations of lists, strips, damage. */
#include "support/files/reading.h"
#include "support/surface.h"

#include <stdio.h>
#include <string.h>

#define HEAD(form) "# vtk DataFile Version 3.0\na surface\n" form "\nDATASET POLYDATA\n"
#define POINTS     "POINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n"
#define FACES      "POLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"

static cw_status read_mesh(const char *name, cw_mesh *mesh, cw_mesh_file *file, cw_error *err)
{
    return cw_mesh_read(test_path(name), NULL, mesh, file, err);
}

static void check_tetrahedron(const char *name)
{
    cw_mesh mesh;
    cw_mesh_file file;
    cw_quality q;
    cw_error err = {0};
    assert_ok(read_mesh(name, &mesh, &file, &err), err);
    assert_string_equal(file.format, "vtk");
    assert_true(mesh.vertex_count == 4 && mesh.triangle_count == 4);
    assert_ok(cw_quality_measure(&mesh, NULL, &q, &err), err);
    assert_true(cw_quality_is_closed_manifold(&q));
    assert_near(q.volume_mm3, 1.0 / 6, 1e-6);
    cw_mesh_free(&mesh);
}

static void texts_of_both_generations_are_read(void **state)
{
    (void)state;
    put_file("a.vtk", HEAD("ASCII") POINTS FACES, NULL, 0);
    check_tetrahedron("a.vtk");
    put_file("b.vtk",
             "# vtk DataFile Version 5.1\nt\nASCII\nDATASET POLYDATA\n" POINTS
             "METADATA\nINFORMATION 0\n\nPOLYGONS 5 12\nOFFSETS vtktypeint64\n0 3 6 9 12\n"
             "CONNECTIVITY vtktypeint64\n0 2 1 0 1 3 0 3 2 1 2 3\n",
             NULL, 0);
    check_tetrahedron("b.vtk");
    /* two triangles as a strip, two as polygons, and what is no face */
    put_file("c.vtk",
             HEAD("ASCII") POINTS
             "VERTICES 1 2\n1 0\nLINES 1 3\n2 0 1\nPOLYGONS 2 8\n3 0 1 3\n3 0 3 2\n"
             "TRIANGLE_STRIPS 1 5\n4 0 2 1 3\n",
             NULL, 0);
    check_tetrahedron("c.vtk");
    put_file("d.vtk",
             "# vtk DataFile Version 2.0\nt\nASCII\nFIELD f 1\nyear 1 1 int\n2026\n"
             "DATASET POLYDATA\n" POINTS FACES,
             NULL, 0);
    check_tetrahedron("d.vtk");
}

static void put_big(unsigned char **to, uint32_t bits)
{
    for (int n = 0; n < 4; n++)
        *(*to)++ = (unsigned char)(bits >> (24 - 8 * n));
}

static void binary_numbers_are_big_endian(void **state)
{
    (void)state;
    static const float points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t faces[16] = {3, 0, 2, 1, 3, 0, 1, 3, 3, 0, 3, 2, 3, 1, 2, 3};
    unsigned char file[512], *at = file;
    at += sprintf((char *)at, HEAD("BINARY") "POINTS 4 float\n");
    for (int n = 0; n < 12; n++) {
        uint32_t bits;
        memcpy(&bits, points + n, sizeof bits);
        put_big(&at, bits);
    }
    at += sprintf((char *)at, "\nPOLYGONS 4 16\n");
    for (int n = 0; n < 16; n++)
        put_big(&at, faces[n]);
    *at++ = '\n';
    test_file_write(test_path("a.vtk"), file, (size_t)(at - file));
    check_tetrahedron("a.vtk");
}

static void scalars_of_points_are_kept(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    put_file("a.vtk",
             HEAD("ASCII") POINTS FACES
             "CELL_DATA 4\nSCALARS area float 1\nLOOKUP_TABLE default\n1 1 1 1\n"
             "POINT_DATA 4\nSCALARS heat double 1\nLOOKUP_TABLE default\n5 6 7 8\n"
             "NORMALS n float\n0 0 1 0 0 1 0 0 1 0 0 1\n",
             NULL, 0);
    assert_ok(read_mesh("a.vtk", &mesh, NULL, &err), err);
    for (int n = 0; n < 4; n++)
        assert_true(mesh.scalars[n] == (float)(5 + n));
    cw_mesh_free(&mesh);
}

static void damaged_files_are_told_where(void **state)
{
    (void)state;
    static const struct {
        const char *text, *words;
    } cases[] = {
        {"# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\n",
         "volume (vtk), not a mesh"},
        {HEAD("ASCII") POINTS "POLYGONS 1 4\n9 0 1 2\n", "number 0 of 'POLYGONS' ends beyond"},
        {HEAD("ASCII") POINTS "POLYGONS 2 4\n3 0 1 2\n", "number 1 of 'POLYGONS' ends beyond"},
        {HEAD("ASCII") POINTS "POLYGONS 1 4\n3 0 1 7\n", "names vertex 7 of 4"},
        {HEAD("ASCII") POINTS "POLYGONS 1 4\n-3 0 1 7\n", "number 0 of 'POLYGONS'"},
        {HEAD("ASCII") POINTS FACES "POINT_DATA 5\n", "'POINT_DATA' is 5; the surface has 4"},
        {HEAD("ASCII") "POINTS 99999999999 float\n0 0 0\n", "POINTS"},
        {HEAD("ASCII") POINTS "TETRAHEDRA 1\n", "starts nothing that is known"},
        {HEAD("BINARY") "POINTS 1000000 float\n1234", "POINTS"},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        cw_mesh mesh = {0};
        cw_error err = {0};
        put_file("a.vtk", cases[n].text, NULL, 0);
        const cw_status st = read_mesh("a.vtk", &mesh, NULL, &err);
        if (st == CW_OK || !strstr(err.message, cases[n].words))
            fail_msg("case %zu: %s", n, st == CW_OK ? "it was read" : err.message);
        assert_null(mesh.positions);
    }
}

/* Volumes and surfaces point to the right command, and not to each other. */
static void surfaces_are_no_volumes(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    put_file("a.vtk", HEAD("ASCII") POINTS FACES, NULL, 0);
    assert_fails(read_back("a.vtk", &v, &err), CW_ERR_FORMAT, "this is a mesh (vtk)", err);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(texts_of_both_generations_are_read),
        TEST(binary_numbers_are_big_endian),
        TEST(scalars_of_points_are_kept),
        TEST(damaged_files_are_told_where),
        TEST(surfaces_are_no_volumes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
