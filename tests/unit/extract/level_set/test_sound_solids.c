/* Solids that touch or overlap, and dust: offsets and shells of them pass what files are checked for. */
#include "support/surface.h"

#include "core/mesh/mesh_attributes.h"

#include <math.h>

/* A cube: its side, and its lowest corner. */
typedef struct cube {
    float side, corner[3];
} cube;

static cw_mesh make_cubes(const cube *cubes, size_t count)
{
    cw_mesh all = {0};
    cw_error err = {0};
    for (size_t n = 0; n < count; n++) {
        cw_mesh one;
        test_make_cube(&one);
        for (size_t i = 0; i < 3 * one.vertex_count; i++)
            one.positions[i] = cubes[n].side * one.positions[i] + cubes[n].corner[i % 3];
        assert_ok(cwi_mesh_append(&all, &one, &err), err);
        cw_mesh_free(&one);
    }
    assert_ok(cw_mesh_weld(&all, NULL, &err), err);
    return all;
}

/* Counts pairs of triangles that cross once positions are rounded to those of a file. */
static size_t count_crossings_in_files(const cw_mesh *mesh)
{
    const cw_crossings_desc desc = {.weld = CW_WELD_WORLD};
    cw_crossings found;
    cw_error err = {0};
    assert_ok(cw_self_intersections(mesh, &desc, &found, &err), err);
    const size_t count = found.count;
    cw_crossings_free(&found);
    return count;
}

/* Restored edges are tested where a file has them: these crossed in files. */
static void an_offset_does_not_cross_itself_in_a_file(void **state)
{
    (void)state;
    cw_mesh pair = make_cubes((const cube[]){{10, {0, 0, 0}}, {10, {5, 4, 3}}}, 2), out;
    const cw_offset_desc desc = {.offset_mm = -0.3, .voxel_mm = 0.25};
    cw_error err = {0};
    assert_ok(cw_mesh_offset(&pair, &desc, &out, NULL, &err), err);
    assert_int_equal(count_crossings_in_files(&out), 0);
    for (int a = 0; a < 3; a++)
        assert_true(out.origin[a] == pair.origin[a]);
    cw_mesh_free(&out);
    cw_mesh_free(&pair);
}

static void solids_that_touch_in_an_edge_are_offset_and_hollowed(void **state)
{
    (void)state;
    cw_mesh pair = make_cubes((const cube[]){{10, {0, 0, 0}}, {10, {10, 10, 0}}}, 2), out;
    const cw_offset_desc in = {.offset_mm = -1, .voxel_mm = 0.25};
    cw_hollow_facts facts;
    cw_error err = {0};
    assert_int_equal(test_measure(&pair).contact_edges, 1);
    assert_ok(cw_mesh_offset(&pair, &in, &out, NULL, &err), err);
    assert_int_equal(test_measure(&out).components, 2);
    assert_within(test_measure(&out).volume_mm3, 2 * 512, 0.001);
    cw_mesh_free(&out);
    assert_ok(cw_mesh_hollow(&pair, &(cw_hollow_desc){.wall_mm = 1, .voxel_mm = 0.4}, &out,
                             &facts, &err),
              err);
    assert_true(facts.cavities == 2 && facts.sealed == 2 && facts.filled == 0);
    assert_within(facts.removed_mm3, 2 * 512, 0.02);
    assert_int_equal(test_measure(&out).contact_edges, 1);
    assert_int_equal(count_crossings_in_files(&out), 0);
    cw_mesh_free(&out);
    cw_mesh_free(&pair);
}

/* Beside a large cube, three whose cavities would be smaller than a ball as wide as the wall. */
static void dust_is_filled(void **state)
{
    (void)state;
    const cube cubes[] = {
        {10, {0, 0, 0}}, {2.5F, {30, 0, 0}}, {2.7F, {35, 0, 0}}, {2.6F, {40, 0, 0}}};
    cw_mesh solids = make_cubes(cubes, 4), out;
    cw_hollow_facts facts;
    cw_error err = {0};
    const cw_hollow_desc desc = {.wall_mm = 1};
    assert_ok(cw_mesh_hollow(&solids, &desc, &out, &facts, &err), err);
    assert_true(facts.cavities == 1 && facts.sealed == 1 && facts.filled == 3);
    /* voxels cut corners off cubes of 0.125, 0.343 and 0.216 mm3 */
    assert_true(facts.filled_mm3 > 0.4 && facts.filled_mm3 < 0.684);
    assert_within(facts.removed_mm3, 512, 0.01);
    assert_int_equal(test_measure(&out).components, 5);
    cw_mesh_free(&out);
    cw_mesh_free(&solids);
    solids = make_cubes(cubes + 1, 3);
    assert_fails(cw_mesh_hollow(&solids, &desc, &out, &facts, &err), CW_ERR_EMPTY,
                 "3 smaller ones", err);
    cw_mesh_free(&solids);
}

/* The void of a hollow mesh counts, too, as it does for checks. */
static void cavities_are_counted_as_checks_count_them(void **state)
{
    (void)state;
    cw_mesh ball = make_cubes((const cube[]){{12, {0, 0, 0}}}, 1), shell, out;
    const cw_quality_desc shells = {.shells = true};
    const cw_drain drain = {2, {0, 0, -1}};
    const cw_hollow_desc whole = {.wall_mm = 1, .voxel_mm = 0.4},
                         drained = {
                             .wall_mm = 1, .voxel_mm = 0.4, .drains = &drain, .drain_count = 1};
    cw_hollow_facts facts;
    cw_quality q;
    cw_error err = {0};
    assert_ok(cw_mesh_hollow(&ball, &(cw_hollow_desc){.wall_mm = 4}, &shell, NULL, &err), err);
    assert_ok(cw_mesh_hollow(&shell, &whole, &out, &facts, &err), err);
    assert_ok(cw_quality_measure(&out, &shells, &q, &err), err);
    assert_true(q.cavities == 2 && facts.cavities == 2 && facts.sealed == 2);
    cw_mesh_free(&out);
    assert_ok(cw_mesh_hollow(&shell, &drained, &out, &facts, &err), err);
    assert_ok(cw_quality_measure(&out, &shells, &q, &err), err);
    assert_true(q.cavities == 1 && facts.cavities == 2 && facts.sealed == 1);
    cw_mesh_free(&out);
    cw_mesh_free(&shell);
    cw_mesh_free(&ball);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_offset_does_not_cross_itself_in_a_file),
        cmocka_unit_test(solids_that_touch_in_an_edge_are_offset_and_hollowed),
        cmocka_unit_test(dust_is_filled),
        cmocka_unit_test(cavities_are_counted_as_checks_count_them),
    };
    return cw_level_set_available() ? cmocka_run_group_tests(tests, NULL, NULL) : 0;
}
