/* Voids of solids are filled: shells inside others go, whatever is in them. */
#include "support/surface.h"

#include <math.h>
#include <string.h>

/* Balls in balls: solid between radii 7 and 10, and 2 and 4; and a solid ball beside them. */
static cw_mesh make_onion(bool open)
{
    const size_t dim[3] = {40, 24, open ? 12 : 24};
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, CW_F32, dim, 1, 1, &err), err);
    float *p = cw_volume_voxels(&v);
    for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n++) {
        const double y = (double)(n / 40 % 24) - 11.5, z = (double)(n / 40 / 24) - 11.5,
                     x = (double)(n % 40);
        const double r = sqrt((x - 11.3) * (x - 11.3) + y * y + z * z),
                     beside = sqrt((x - 31.2) * (x - 31.2) + y * y + z * z);
        p[n] = (float)fmax((10 - r) * (r - 7) * (r - 4) * (r - 2), 30 * (6 - beside));
    }
    cw_mesh mesh = test_extract(&v, &(cw_extract_desc){.leave_open = open}, NULL);
    cw_volume_free(&v);
    return mesh;
}

static cw_quality measure_shells(const cw_mesh *mesh)
{
    cw_quality q;
    cw_error err = {0};
    assert_ok(cw_quality_measure(mesh, &(cw_quality_desc){.shells = true}, &q, &err), err);
    return q;
}

static void only_outer_shells_stay(void **state)
{
    (void)state;
    cw_mesh mesh = make_onion(false);
    cw_drop_counts counts;
    cw_error err = {0};
    const cw_quality before = measure_shells(&mesh);
    const size_t triangles = mesh.triangle_count;
    assert_int_equal(before.components, 5);
    assert_ok(cw_mesh_fill_voids(&mesh, 0, &counts, &err), err);
    const cw_quality after = measure_shells(&mesh);
    assert_int_equal(after.components, 2);
    assert_true(after.cavities == 0 && after.nested == 0 && after.inside_out == 0);
    assert_int_equal(after.unused_vertices, 0);
    assert_int_equal(counts.dropped, 3);
    assert_int_equal(counts.kept, 2);
    assert_int_equal(counts.triangles, triangles - mesh.triangle_count);
    const double filled = 4 * PI / 3 * (7 * 7 * 7 - 4 * 4 * 4 + 2 * 2 * 2);
    assert_true(fabs(counts.dropped_mm3 - (after.volume_mm3 - before.volume_mm3)) < 1e-3);
    assert_true(fabs(counts.dropped_mm3 - filled) < 0.02 * filled);
    assert_true(fabs(counts.largest_mm3 - 4 * PI / 3 * 343) < 30);
    const size_t left = mesh.triangle_count;
    assert_ok(cw_mesh_fill_voids(&mesh, 1, NULL, &err), err);
    assert_int_equal(mesh.triangle_count, left);
    cw_mesh_free(&mesh);
}

/* Bowls enclose nothing for certain. */
static void open_shells_stay(void **state)
{
    (void)state;
    cw_mesh mesh = make_onion(true);
    cw_drop_counts counts;
    cw_error err = {0};
    const size_t triangles = mesh.triangle_count;
    assert_ok(cw_mesh_fill_voids(&mesh, 0, &counts, &err), err);
    assert_int_equal(mesh.triangle_count, triangles);
    assert_true(counts.dropped == 0 && counts.dropped_mm3 == 0);
    cw_mesh_free(&mesh);
}

static void nothing_is_left_as_it_is(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    cw_error err = {0};
    assert_ok(cw_mesh_fill_voids(&mesh, 0, NULL, &err), err);
    assert_int_equal(cw_mesh_fill_voids(NULL, 0, NULL, &err), CW_ERR_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_outer_shells_stay),
        cmocka_unit_test(open_shells_stay),
        cmocka_unit_test(nothing_is_left_as_it_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
