/* The stage of the pipeline that lets normals part: where caps close a surface, and by the angle. */
#include "support/surface.h"

#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"

#include <cubewright/pipeline.h>

#include <math.h>

enum { SIDE = 20 };

/* A slope that crosses 0 in the middle along x, or mirrored or turned: its surface is a box of five caps and a
 * flat end. */
static cw_volume make_slope(const double affine[12])
{
    static float values[SIDE * SIDE * SIDE];
    cw_volume v = {.data = values, .type = CW_F32, .dim = {SIDE, SIDE, SIDE}};
    for (size_t n = 0; n < SIDE * SIDE * SIDE; n++)
        values[n] = (float)(n % SIDE) - 7.3f;
    for (int i = 0; affine && i < 12; i++)
        v.affine[i / 4][i % 4] = affine[i];
    return v;
}

/* Checks that corners have the normal of their triangle, but for the slivers between caps. */
static void check_sides(const cw_mesh *mesh)
{
    const cw_attribute *row = cw_mesh_attribute_find(mesh, CW_CORNER_NORMALS);
    double largest = 0;
    size_t checked = 0;
    assert_non_null(row);
    for (size_t t = 0; t < mesh->triangle_count; t++)
        largest = fmax(largest, cwi_mesh_area(mesh, t));
    for (size_t c = 0; c < 3 * mesh->triangle_count; c++) {
        const float *own = (const float *)row->data + 3 * c;
        double normal[3];
        if (cwi_mesh_area(mesh, c / 3) < 0.1 * largest)
            continue;
        cwi_mesh_normal(mesh, c / 3, normal);
        assert_true(cwi_normalise(normal));
        for (size_t a = 0; a < 3; a++)
            assert_near((double)own[a], normal[a], 0.01);
        checked++;
    }
    assert_true(checked > mesh->triangle_count);
}

static void normals_part_at_caps(void **state)
{
    (void)state;
    static const double affines[3][12] = {
        {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
        {-1e-4, 0, 0, 7, 0, 1e-4, 0, 0, 0, 0, 2e-4, 0},     /* mirrored, small */
        {0, 0, 1e4, 0, 8e3, 6e3, 0, 0, -6e3, 8e3, 0, 1e6}}; /* turned, large, far away */
    for (size_t n = 0; n < 3; n++)
        for (int by_angle = 0; by_angle < 2; by_angle++) {
            const cw_volume volume = make_slope(affines[n]);
            const cw_pipeline_desc desc = {.crease_degrees = by_angle ? 20 : 0,
                                           .crease_caps = !by_angle};
            cw_pipeline_facts facts = {0};
            cw_mesh mesh = {0};
            cw_error err = {0};
            assert_ok(cw_pipeline_mesh(&volume, NULL, &desc, &mesh, &facts, &err), err);
            assert_true(facts.ran >> CW_STAGE_CREASES & 1);
            assert_true(facts.creases > 0);
            check_sides(&mesh);
            cw_mesh_free(&mesh);
        }
}

static void open_surfaces_have_no_caps(void **state)
{
    (void)state;
    const cw_volume volume = make_slope(NULL);
    cw_pipeline_desc desc = {.crease_caps = true, .extract.leave_open = true};
    cw_pipeline_facts facts = {0};
    cw_mesh mesh = {0};
    cw_error err = {0};
    assert_ok(cw_pipeline_mesh(&volume, NULL, &desc, &mesh, &facts, &err), err);
    assert_int_equal(facts.creases, 0);
    assert_null(cw_mesh_attribute_find(&mesh, CW_CORNER_NORMALS));
    cw_mesh_free(&mesh);
    desc.crease_degrees = NAN;
    assert_fails(cw_pipeline_mesh(&volume, NULL, &desc, &mesh, &facts, &err), CW_ERR_ARGUMENT,
                 "crease_degrees", err);
    desc = (cw_pipeline_desc){.crease_caps = true, .extract.no_normals = true};
    assert_false(cw_pipeline_stages(&desc) >> CW_STAGE_CREASES & 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normals_part_at_caps),
        cmocka_unit_test(open_surfaces_have_no_caps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
