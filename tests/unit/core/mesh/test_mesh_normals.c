/* Normals of vertices from the triangles around them. */
#include "support/surface.h"

#include "core/base/memory.h"

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normals_of_a_cube_point_along_its_diagonals),
        cmocka_unit_test(normals_on_a_sphere_are_exact),
        cmocka_unit_test(vertices_without_triangles_point_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
