/* The distance that simplification keeps, measured both ways by other means than its own. */
#include "support/meshes.h"
#include "support/surface.h"

#include <cubewright/distance.h>

#include <math.h>
#include <string.h>

/* Noise above the field's range leaves flaps, needles and thin sheets. */
static cw_mesh gyroid_under_noise(size_t n, double noise, bool open)
{
    const cw_field_desc field = {
        .field = CW_FIELD_GYROID, .dim = {n, n, n}, .type = CW_F32, .noise = noise};
    cw_volume volume;
    cw_error err = {0};
    assert_ok(cw_field_sample(&field, &volume, &err), err);
    const cw_mesh mesh = test_extract(&volume, &(cw_extract_desc){.leave_open = open}, NULL);
    cw_volume_free(&volume);
    return mesh;
}

static double voxel_of(const cw_mesh *mesh, size_t n)
{
    double low[3], high[3];
    assert_true(cw_mesh_bounds(mesh, low, high));
    return (high[0] - low[0]) / (double)n;
}

static void stretch(cw_mesh *mesh, const double by[3])
{
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        mesh->positions[i] = (float)(by[i % 3] * (double)mesh->positions[i]);
    for (int k = 0; k < 3; k++)
        mesh->origin[k] *= by[k];
}

/* All points of both are within the error, and threads change nothing. Returns the triangles. */
static size_t check_error(const cw_mesh *mesh, double error)
{
    cw_simplify_desc desc = {.error_mm = error, .threads = 1};
    const cw_mesh_distance_desc how = {.tolerance_mm = 0.01 * error};
    cw_mesh_comparison both = {0};
    cw_mesh one, three;
    cw_error err = {0};
    assert_ok(cw_simplify(mesh, &desc, &one, NULL, &err), err);
    desc.threads = 3;
    assert_ok(cw_simplify(mesh, &desc, &three, NULL, &err), err);
    test_assert_same_mesh(&one, &three);
    assert_ok(cw_mesh_compare(&one, mesh, &how, &both, &err), err);
    if (both.to_reference.max_mm > error || both.from_reference.max_mm > error)
        fail_msg("%g and %g mm where %g are promised", both.to_reference.max_mm,
                 both.from_reference.max_mm, error);
    test_assert_sound(mesh, &one);
    const size_t left = one.triangle_count;
    cw_mesh_free(&one);
    cw_mesh_free(&three);
    return left;
}

/* From far below the edges' length to far above it. */
static void check_errors(const cw_mesh *mesh, double voxel)
{
    static const double errors[] = {0.02, 0.2, 0.5, 4};
    size_t before = mesh->triangle_count;
    for (size_t n = 0; n < sizeof errors / sizeof *errors; n++) {
        const size_t left = check_error(mesh, errors[n] * voxel);
        assert_true(left <= before);
        before = left;
    }
    assert_true(before < mesh->triangle_count);
}

static void rough_surfaces_keep_the_error(void **state)
{
    (void)state;
    static const double noise[] = {0.05, 0.4, 1.5};
    for (size_t n = 0; n < 6; n++) {
        cw_mesh mesh = gyroid_under_noise(12, noise[n / 2], n % 2);
        check_errors(&mesh, voxel_of(&mesh, 12));
        cw_mesh_free(&mesh);
    }
}

/* In metres, in micrometres, and with triangles 40 times as long as they are wide. */
static void the_error_has_the_unit_of_the_mesh(void **state)
{
    (void)state;
    static const double by[][3] = {
        {1e-4, 1e-4, 1e-4}, {1e4, 1e4, 1e4}, {40, 1, 1}, {1, 1, 1e-2}};
    for (size_t n = 0; n < sizeof by / sizeof *by; n++) {
        cw_mesh mesh = gyroid_under_noise(12, 0.2, n % 2);
        const double voxel = voxel_of(&mesh, 12) * fmin(by[n][0], by[n][2]);
        stretch(&mesh, by[n]);
        check_errors(&mesh, voxel);
        cw_mesh_free(&mesh);
    }
}

/* Several blocks, whose proofs the last pass uses again where it changes nothing. */
static void many_blocks_keep_the_error(void **state)
{
    (void)state;
    static const double errors[] = {0.2, 0.5};
    cw_mesh mesh = gyroid_under_noise(44, 0.2, true);
    const double voxel = voxel_of(&mesh, 44);
    assert_true(mesh.triangle_count > 1 << 15);
    for (size_t n = test_is_short() ? 1 : 0; n < 2; n++)
        check_error(&mesh, errors[n] * voxel);
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rough_surfaces_keep_the_error),
        cmocka_unit_test(the_error_has_the_unit_of_the_mesh),
        cmocka_unit_test(many_blocks_keep_the_error),
    };
    if (!cw_simplify_available())
        return 0;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
