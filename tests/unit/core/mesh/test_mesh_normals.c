/* Normals of vertices from the triangles around them. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"

#include <math.h>
#include <string.h>

static double length_of(const float *n)
{
    return sqrt((double)n[0] * (double)n[0] + (double)n[1] * (double)n[1] +
                (double)n[2] * (double)n[2]);
}

static void normals_of_a_cube_point_along_its_diagonals(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    test_make_cube(&mesh);
    for (size_t v = 0; v < mesh.vertex_count; v++)
        mesh.normals[3 * v] = 7; /* replaced */
    for (size_t n = 0; n < 3 * mesh.vertex_count; n++)
        mesh.positions[n] *= 1e-4f; /* small units */
    assert_ok(cw_mesh_normals(&mesh, &err), err);
    for (size_t v = 0; v < mesh.vertex_count; v++)
        for (size_t a = 0; a < 3; a++) {
            const bool is_high = mesh.positions[3 * v + a] > 0.5e-4f;
            assert_near((double)mesh.normals[3 * v + a], (is_high ? 1 : -1) / sqrt(3), 1e-6);
        }
    cw_mesh_free(&mesh);
}

/* Triangles that share a corner on a sphere give its exact normal, whatever their angles. */
static void normals_on_a_sphere_are_exact(void **state)
{
    (void)state;
    enum { AROUND = 5 };
    static const double azimuth[AROUND] = {0, 0.4, 1.9, 3.5, 5};
    static const double polar[AROUND] = {0.3, 0.7, 0.2, 0.5, 0.4};
    float positions[3 * (AROUND + 1)] = {0, 0, 1e4f};
    uint32_t triangles[3 * AROUND];
    cw_error err = {0};
    cw_mesh mesh = {.vertex_count = AROUND + 1,
                    .triangle_count = AROUND,
                    .positions = positions,
                    .triangles = triangles};
    for (uint32_t n = 0; n < AROUND; n++) {
        float *p = positions + 3 * (n + 1);
        p[0] = (float)(1e4 * sin(polar[n]) * cos(azimuth[n]));
        p[1] = (float)(1e4 * sin(polar[n]) * sin(azimuth[n]));
        p[2] = (float)(1e4 * cos(polar[n]));
        memcpy(triangles + 3 * n, (uint32_t[3]){0, n + 1, (n + 1) % AROUND + 1},
               3 * sizeof *triangles);
    }
    assert_ok(cw_mesh_normals(&mesh, &err), err);
    assert_near((double)mesh.normals[0], 0, 1e-6);
    assert_near((double)mesh.normals[1], 0, 1e-6);
    assert_near((double)mesh.normals[2], 1, 1e-6);
    cwi_free(mesh.normals);
}

static void vertices_without_triangles_point_up(void **state)
{
    (void)state;
    float positions[12] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 5, 5, 5};
    uint32_t triangles[3] = {0, 1, 2};
    cw_error err = {0};
    cw_mesh mesh = {
        .vertex_count = 4, .triangle_count = 1, .positions = positions, .triangles = triangles};
    assert_ok(cw_mesh_normals(&mesh, &err), err);
    for (size_t v = 0; v < 4; v++) {
        assert_near(length_of(mesh.normals + 3 * v), 1, 0);
        assert_true(mesh.normals[3 * v + 2] == 1);
    }
    cwi_free(mesh.normals);
    mesh.normals = NULL;
    triangles[2] = 4;
    assert_fails(cw_mesh_normals(&mesh, &err), CW_ERR_ARGUMENT, "vertex 4", err);
    triangles[2] = 2;
    bool failed = true;
    for (long n = 0; failed; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_normals(&mesh, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_true(failed == (mesh.normals == NULL));
    }
    cwi_free(mesh.normals);
}

static const float *corner_normals(const cw_mesh *mesh)
{
    const cw_attribute *row = cw_mesh_attribute_find(mesh, CW_CORNER_NORMALS);
    return row ? row->data : NULL;
}

/* Each corner of a cube then has the normal of its side; the largest angle leaves them together. */
static void normals_part_at_the_edges_of_a_cube(void **state)
{
    (void)state;
    static const double units[] = {1e-4, 1, 1e4};
    for (size_t u = 0; u < sizeof units / sizeof *units; u++) {
        cw_mesh mesh;
        cw_error err = {0};
        size_t creases = 0;
        test_make_cube(&mesh);
        for (size_t n = 0; n < 3 * mesh.vertex_count; n++)
            mesh.positions[n] *= (float)units[u];
        assert_ok(cw_mesh_normals(&mesh, &err), err);
        assert_ok(cw_mesh_crease_normals(&mesh, 60, NULL, &creases, &err), err);
        assert_int_equal(creases, 12);
        for (size_t c = 0; c < 3 * mesh.triangle_count; c++) {
            double normal[3];
            cwi_mesh_normal(&mesh, c / 3, normal);
            assert_true(cwi_normalise(normal));
            for (size_t a = 0; a < 3; a++)
                assert_near((double)corner_normals(&mesh)[3 * c + a], normal[a], 1e-6);
        }
        assert_ok(cw_mesh_crease_normals(&mesh, 91, NULL, &creases, &err), err);
        assert_int_equal(creases, 0);
        assert_null(corner_normals(&mesh));
        cw_mesh_free(&mesh);
    }
}

/* One side is a region: its edges are the creases, and the other sides keep the normals of vertices. */
static void normals_part_between_regions(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    uint8_t regions[12] = {0};
    size_t creases = 0, own = 0;
    test_make_cube(&mesh);
    for (size_t t = 0; t < mesh.triangle_count; t++) {
        double normal[3];
        cwi_mesh_normal(&mesh, t, normal);
        regions[t] = normal[2] > 0.5;
    }
    assert_ok(cw_mesh_crease_normals(&mesh, 180, regions, &creases, &err), err);
    assert_int_equal(creases, 4);
    for (size_t c = 0; c < 3 * mesh.triangle_count; c++) {
        const float *n = corner_normals(&mesh) + 3 * c;
        assert_near(length_of(n), 1, 1e-6);
        own += regions[c / 3] && n[2] == 1;
        if (!regions[c / 3] && mesh.positions[3 * (size_t)mesh.triangles[c] + 2] > 0.5f)
            assert_near((double)n[2], 0, 1e-6); /* without the region's */
    }
    assert_int_equal(own, 6);
    cw_mesh_free(&mesh);
}

static void creases_are_refused_or_found_without_memory(void **state)
{
    (void)state;
    static const double wrong[] = {-1, 181, NAN};
    cw_mesh mesh;
    cw_error err = {0};
    test_make_cube(&mesh);
    for (size_t n = 0; n < 3; n++)
        assert_fails(cw_mesh_crease_normals(&mesh, wrong[n], NULL, NULL, &err), CW_ERR_ARGUMENT,
                     "0 to 180", err);
    bool failed = true;
    for (long n = 0; failed; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_crease_normals(&mesh, 30, NULL, NULL, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_true(failed == (corner_normals(&mesh) == NULL));
    }
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normals_of_a_cube_point_along_its_diagonals),
        cmocka_unit_test(normals_on_a_sphere_are_exact),
        cmocka_unit_test(vertices_without_triangles_point_up),
        cmocka_unit_test(normals_part_at_the_edges_of_a_cube),
        cmocka_unit_test(normals_part_between_regions),
        cmocka_unit_test(creases_are_refused_or_found_without_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
