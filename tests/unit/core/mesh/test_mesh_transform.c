/* Meshes moved by affine maps: points, normals and the outside. */
#include "support/solids.h"
#include "support/surface.h"

#include "core/mesh/mesh.h"

#include <math.h>
#include <string.h>

static const double LOW[3] = {1, 2, 3}, HIGH[3] = {2, 4, 6};

static cw_mesh make_box(void)
{
    cw_mesh box = test_make_boxes(1);
    cw_error err = {0};
    test_add_box(&box, LOW, HIGH, false);
    assert_ok(cw_mesh_normals(&box, &err), err);
    box.origin[0] = 100;
    return box;
}

static double volume_of(const cw_mesh *mesh)
{
    cw_quality q;
    cw_error err = {0};
    assert_ok(cw_quality_measure(mesh, NULL, &q, &err), err);
    assert_true(cw_quality_is_closed_manifold(&q) && q.inside_out == 0);
    return q.volume_mm3;
}

static void points_move_and_the_outside_stays_outside(void **state)
{
    (void)state;
    static const struct {
        double matrix[12];
        double volume, low[3], high[3];
    } cases[] = {
        {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 6, {101, 2, 3}, {102, 4, 6}},
        {{2, 0, 0, 1, 0, 3, 0, 0, 0, 0, 4, 0}, 144, {203, 6, 12}, {205, 12, 24}},
        {{-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 6, {-102, 2, 3}, {-101, 4, 6}},
        {{0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0}, 6, {-4, 101, 3}, {-2, 102, 6}},
        {{1e-6, 0, 0, 0, 0, 1e-6, 0, 0, 0, 0, 1e-6, 0},
         6e-18,
         {101e-6, 2e-6, 3e-6},
         {102e-6, 4e-6, 6e-6}},
        {{1, 1, 0, 0, 0, 1, 0, 0, 0, 0, -1, 5}, 6, {103, 2, -1}, {106, 4, 2}}, /* a shear */
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        cw_mesh box = make_box();
        cw_error err = {0};
        double low[3], high[3];
        assert_ok(cw_mesh_transform(&box, cases[n].matrix, &err), err);
        assert_true(cw_mesh_bounds(&box, low, high));
        for (int a = 0; a < 3; a++) {
            assert_near(low[a], cases[n].low[a], 1e-6 * fabs(cases[n].high[0]));
            assert_near(high[a], cases[n].high[a], 1e-6 * fabs(cases[n].high[0]));
        }
        assert_near(volume_of(&box) / cases[n].volume, 1, 1e-5);
        cw_mesh_free(&box);
    }
}

/* A stretched slope gets a steeper normal: the normal of its triangles, not the stretched one. */
static void normals_stay_upright_on_the_surface(void **state)
{
    (void)state;
    static const float corners[3][3] = {
        {0, 0, 0}, {1, 0, 1}, {0, 1, 0}}; /* normal (-1, 0, 1) */
    const double mirror_and_stretch[12] = {-3, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(cwi_mesh_alloc(&mesh, 3, 1, false, &err), err);
    memcpy(mesh.positions, corners, sizeof corners);
    memcpy(mesh.triangles, (uint32_t[]){0, 1, 2}, 3 * sizeof(uint32_t));
    assert_ok(cw_mesh_normals(&mesh, &err), err);
    assert_ok(cw_mesh_transform(&mesh, mirror_and_stretch, &err), err);
    cw_mesh again;
    assert_ok(cwi_mesh_copy(&mesh, &again, &err), err);
    assert_ok(cw_mesh_normals(&again, &err), err);
    for (size_t i = 0; i < 9; i++)
        assert_near(mesh.normals[i], again.normals[i], 1e-6);
    assert_near(mesh.normals[0], 1 / sqrt(10), 1e-6);
    cw_mesh_free(&again);
    cw_mesh_free(&mesh);
}

static void the_affine_and_directions_move_along(void **state)
{
    (void)state;
    const double map[12] = {0, -2, 0, 5, 2, 0, 0, 0, 0, 0, 2, 1};
    cw_mesh box = make_box();
    cw_error err = {0};
    cw_attribute *row;
    const cw_attribute like = {"flow", CW_ON_TRIANGLES,          CW_F32,
                               3,      CW_INTERPOLATE_DIRECTION, NULL};
    assert_ok(cw_mesh_attribute_add(&box, &like, &row, &err), err);
    ((float *)row->data)[0] = 1;
    for (int a = 0; a < 3; a++)
        box.affine[a][a] = 0.5;
    box.affine[0][3] = 7;
    assert_ok(cw_mesh_transform(&box, map, &err), err);
    row = cw_mesh_attribute_find(&box, "flow");
    assert_near(((float *)row->data)[1], 1, 1e-7); /* x became y, and is of length 1 again */
    static const double affine[3][4] = {{0, -1, 0, 5}, {1, 0, 0, 14}, {0, 0, 1, 1}};
    for (int n = 0; n < 12; n++)
        assert_near(box.affine[n / 4][n % 4], affine[n / 4][n % 4], 1e-12);
    cw_mesh_free(&box);
}

static void maps_that_flatten_are_refused(void **state)
{
    (void)state;
    static const double maps[][12] = {
        {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0},
        {1, 0, 0, 0, 0, NAN, 0, 0, 0, 0, 1, 0},
        {1, 0, 0, INFINITY, 0, 1, 0, 0, 0, 0, 1, 0},
        {1e38, 0, 0, 0, 0, 1e38, 0, 0, 0, 0, 1e38, 0},
    };
    cw_mesh box = make_box(), before;
    cw_error err = {0};
    assert_ok(cwi_mesh_copy(&box, &before, &err), err);
    for (size_t n = 0; n < sizeof maps / sizeof *maps; n++) {
        assert_int_equal(cw_mesh_transform(&box, maps[n], &err), CW_ERR_ARGUMENT);
        assert_non_null(strstr(err.message, "matrix"));
        test_assert_same_mesh(&box, &before);
    }
    assert_int_equal(cw_mesh_transform(NULL, maps[0], &err), CW_ERR_ARGUMENT);
    cw_mesh none = {0};
    assert_ok(cw_mesh_transform(&none, (double[12]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, &err),
              err);
    cw_mesh_free(&before);
    cw_mesh_free(&box);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_move_and_the_outside_stays_outside),
        cmocka_unit_test(normals_stay_upright_on_the_surface),
        cmocka_unit_test(the_affine_and_directions_move_along),
        cmocka_unit_test(maps_that_flatten_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
