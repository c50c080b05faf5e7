/* Polygons of files become triangles that do not overlap, whatever their shape. */
#include "support/files/reading.h"
#include "support/surface.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Writes one polygon as OBJ; corner n is a vertex of its own. */
static void write_polygon(const char *name, const double (*points)[3], size_t count)
{
    char *text = malloc(120 * count + 40), *at = text;
    assert_non_null(text);
    for (size_t n = 0; n < count; n++)
        at += sprintf(at, "v %.9g %.9g %.9g\n", points[n][0], points[n][1], points[n][2]);
    at += sprintf(at, "f");
    for (size_t n = 0; n < count; n++)
        at += sprintf(at, " %zu", n + 1);
    at += sprintf(at, "\n");
    test_file_write(test_path(name), text, (size_t)(at - text));
    free(text);
}

static cw_mesh read_mesh(const char *name, cw_mesh_file *file)
{
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(cw_mesh_read(test_path(name), NULL, &mesh, file, &err), err);
    return mesh;
}

/* Sums the areas of triangles, and those seen along z with their signs: alike where none overlap. */
static void sum_areas(const cw_mesh *m, double *area, double *along_z)
{
    *area = *along_z = 0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        double d[2][3];
        const uint32_t *v = m->triangles + 3 * t;
        for (int k = 0; k < 2; k++)
            for (int a = 0; a < 3; a++)
                d[k][a] =
                    (double)m->positions[3 * v[k + 1] + a] - (double)m->positions[3 * v[0] + a];
        const double z = d[0][0] * d[1][1] - d[0][1] * d[1][0];
        const double x = d[0][1] * d[1][2] - d[0][2] * d[1][1];
        const double y = d[0][2] * d[1][0] - d[0][0] * d[1][2];
        *area += sqrt(x * x + y * y + z * z) / 2;
        *along_z += z / 2;
    }
}

static void check_flat(const double (*points)[3], size_t count, double expected)
{
    cw_mesh_file file;
    double area, along_z;
    write_polygon("p.obj", points, count);
    cw_mesh m = read_mesh("p.obj", &file);
    sum_areas(&m, &area, &along_z);
    assert_int_equal(m.triangle_count, count - 2);
    assert_near(area, expected, 1e-5 * expected);
    assert_near(fabs(along_z), expected, 1e-5 * expected);
    assert_true(file.polygons == 1 && file.crossing == 0);
    cw_mesh_free(&m);
}

static void convex_polygons_stay_fans(void **state)
{
    (void)state;
    static const double hexagon[6][3] = {{2, 0, 0}, {4, 1, 1},  {4, 3, 1},
                                         {2, 4, 0}, {0, 3, -1}, {0, 1, -1}};
    write_polygon("p.obj", hexagon, 6);
    cw_mesh m = read_mesh("p.obj", NULL);
    for (uint32_t t = 0; t < 4; t++) {
        const uint32_t fan[3] = {0, t + 1, t + 2};
        assert_memory_equal(m.triangles + 3 * t, fan, sizeof fan);
    }
    cw_mesh_free(&m);
}

static void notches_are_left_out_from_either_side(void **state)
{
    (void)state;
    static const double arrow[5][3] = {{4, 0, 0}, {4, 4, 0}, {2, 1, 0}, {0, 4, 0}, {0, 0, 0}};
    static const double letter[8][3] = {{0, 0, 5}, {5, 0, 5}, {5, 1, 5}, {1, 1, 5},
                                        {1, 4, 5}, {5, 4, 5}, {5, 5, 5}, {0, 5, 5}};
    double turned[8][3];
    check_flat(arrow, 5, 10);
    check_flat(letter, 8, 5 + 3 + 5);
    for (size_t first = 0; first < 8; first++) { /* from each corner, and backwards */
        for (size_t n = 0; n < 8; n++)
            memcpy(turned[n], letter[(first + 8 - n) % 8], sizeof turned[n]);
        check_flat((const double(*)[3])turned, 8, 13);
    }
}

/* A comb of many teeth, of other units as well. */
static void large_polygons_take_no_longer_than_they_should(void **state)
{
    (void)state;
    enum { TEETH = 16384, COUNT = 4 * TEETH + 2 }; /* floats hold its corners exactly */
    static double comb[COUNT][3];
    for (int unit = -13; unit <= 13; unit += 13) {
        const double s = ldexp(1, unit);
        size_t n = 0;
        for (int t = 0; t < TEETH; t++) {
            const double x[4] = {t, t + 0.25, t + 0.5, t + 0.75}, y[4] = {1, 9, 9, 1};
            for (int k = 0; k < 4; k++, n++) {
                comb[n][0] = s * x[k];
                comb[n][1] = s * y[k];
                comb[n][2] = 0;
            }
        }
        comb[n][0] = s * (TEETH - 0.25), comb[n++][1] = 0;
        comb[n][0] = 0, comb[n++][1] = 0;
        assert_int_equal(n, COUNT);
        check_flat((const double(*)[3])comb, COUNT, s * s * (TEETH - 0.25 + TEETH * 0.5 * 8));
    }
}

/* Bent faces, as of a saddle, and keyholes, where a hole is joined by two edges along one line. */
static void bent_faces_and_keyholes_are_cut_right(void **state)
{
    (void)state;
    static const double saddle[4][3] = {{0, 0, 0}, {1, 0, 0.2}, {1, 1, 0}, {0, 1, 0.2}};
    static const double dart[4][3] = {{1, 0.2, 0.1}, {0, 2, 0}, {1, 1, 0}, {2, 2, 0.1}};
    static const double keyhole[10][3] = {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0},
                                          {0, 0, 0}, {1, 1, 0}, {1, 2, 0}, {2, 2, 0},
                                          {2, 1, 0}, {1, 1, 0}};
    cw_mesh_file file;
    double area, along_z;
    write_polygon("p.obj", saddle, 4);
    cw_mesh m = read_mesh("p.obj", &file);
    sum_areas(&m, &area, &along_z);
    assert_near(along_z, 1, 1e-6);
    cw_mesh_free(&m);
    write_polygon("p.obj", dart, 4);
    m = read_mesh("p.obj", &file);
    sum_areas(&m, &area, &along_z);
    assert_near(fabs(along_z), 0.8, 1e-6);
    assert_true(m.triangles[3] != 0 || m.triangles[4] != 2 || area < 0.85);
    cw_mesh_free(&m);
    check_flat(keyhole, 10, 8);
}

static void polygons_that_cross_themselves_are_counted(void **state)
{
    (void)state;
    static const double bow[4][3] = {{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 3, 0}};
    double star[5][3];
    for (int n = 0; n < 5; n++) {
        star[n][0] = cos(n * 4 * acos(-1) / 5);
        star[n][1] = sin(n * 4 * acos(-1) / 5);
        star[n][2] = 0;
    }
    const struct {
        const double (*points)[3];
        size_t count;
    } cases[] = {{bow, 4}, {(const double(*)[3])star, 5}};
    for (size_t n = 0; n < 2; n++) {
        cw_mesh_file file;
        write_polygon("p.obj", cases[n].points, cases[n].count);
        cw_mesh m = read_mesh("p.obj", &file);
        assert_int_equal(m.triangle_count, cases[n].count - 2);
        assert_int_equal(file.crossing, 1);
        cw_mesh_free(&m);
    }
    static const double spot[4][3] = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
    static const double line[4][3] = {{0, 0, 0}, {1, 1, 1}, {3, 3, 3}, {2, 2, 2}};
    write_polygon("p.obj", spot, 4);
    cw_mesh m = read_mesh("p.obj", NULL);
    cw_mesh_free(&m);
    write_polygon("p.obj", line, 4);
    m = read_mesh("p.obj", NULL);
    assert_int_equal(m.triangle_count, 2);
    cw_mesh_free(&m);
}

static void every_format_cuts_them(void **state)
{
    (void)state;
    static const char off[] = "OFF\n5 1 0\n4 0 0\n4 4 0\n2 1 0\n0 4 0\n0 0 0\n5 0 1 2 3 4\n";
    static const char ply[] =
        "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "4 0 0\n4 4 0\n2 1 0\n0 4 0\n0 0 0\n5 0 1 2 3 4\n";
    static const char vtp[] =
        "<VTKFile type='PolyData'><PolyData><Piece NumberOfPoints='5' NumberOfPolys='1'>"
        "<Points><DataArray type='Float32' NumberOfComponents='3' format='ascii'>"
        "4 0 0 4 4 0 2 1 0 0 4 0 0 0 0</DataArray></Points><Polys>"
        "<DataArray type='Int32' Name='connectivity' format='ascii'>0 1 2 3 4</DataArray>"
        "<DataArray type='Int32' Name='offsets' format='ascii'>5</DataArray></Polys></Piece>"
        "</PolyData></VTKFile>";
    const struct {
        const char *name, *text;
    } files[] = {{"a.off", off}, {"a.ply", ply}, {"a.vtp", vtp}};
    for (size_t n = 0; n < 3; n++) {
        double area, along_z;
        put_file(files[n].name, files[n].text, NULL, 0);
        cw_mesh m = read_mesh(files[n].name, NULL);
        sum_areas(&m, &area, &along_z);
        assert_near(area, 10, 1e-6);
        cw_mesh_free(&m);
    }
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(convex_polygons_stay_fans),
        TEST(notches_are_left_out_from_either_side),
        TEST(large_polygons_take_no_longer_than_they_should),
        TEST(bent_faces_and_keyholes_are_cut_right),
        TEST(polygons_that_cross_themselves_are_counted),
        TEST(every_format_cuts_them),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
