/* Meshes compared both ways, in one piece and in parts; topology held to what it was. */
#include "support/surface.h"

#include <math.h>
#include <string.h>

static void move_cube(cw_mesh *m, double x, double scale)
{
    m->origin[0] += x;
    for (size_t n = 0; n < 3 * m->vertex_count; n++)
        m->positions[n] = (float)((double)m->positions[n] * scale);
}

static void both_ways_are_measured(void **state)
{
    (void)state;
    cw_mesh small, large;
    cw_mesh_comparison c = {0};
    cw_error err = {0};
    test_make_cube(&small);
    test_make_cube(&large);
    move_cube(&large, 0, 3); /* three faces lie in the same planes */
    assert_ok(cw_mesh_compare(&small, &large, NULL, &c, &err), err);
    assert_near(c.to_reference.max_mm, 1, 0.1); /* the small one's far faces, from the planes */
    assert_near(c.from_reference.max_mm, sqrt(12), 1e-6); /* between both far corners */
    assert_near(c.area_mm2, 6, 1e-6);
    assert_near(c.reference_area_mm2, 54, 1e-5);
    assert_true(cw_mesh_comparison_max(&c) == c.from_reference.max_mm);
    const double to = c.to_reference.rms_mm, from = c.from_reference.rms_mm;
    assert_near(cw_mesh_comparison_rms(&c), sqrt((to * to + from * from) / 2), 1e-12);
    cw_mesh_free(&small);
    cw_mesh_free(&large);
}

/* Parts far from each other, compared one by one, give what they give in one mesh. */
static void parts_add_up_to_the_whole(void **state)
{
    (void)state;
    const cw_mesh_distance_desc desc = {.step_mm = 0.05};
    cw_mesh_comparison parts = {0}, whole = {0};
    cw_mesh piece[2][2], all[2];
    float positions[2][48];
    uint32_t triangles[72];
    cw_error err = {0};
    for (int n = 0; n < 2; n++) /* n: the part */
        for (int of = 0; of < 2; of++) {
            test_make_cube(&piece[n][of]);
            move_cube(&piece[n][of], 0, (n ? 4 : 1) * (of ? 1.1 : 1));
            for (size_t v = 0; v < 8; v++)
                for (size_t a = 0; a < 3; a++)
                    positions[of][24 * n + 3 * (int)v + (int)a] =
                        piece[n][of].positions[3 * v + a] + (a == 0 && n ? 100 : 0);
            for (size_t c = 0; c < 36; c++)
                triangles[36 * n + (int)c] = piece[n][of].triangles[c] + (n ? 8 : 0);
        }
    for (int of = 0; of < 2; of++)
        all[of] = (cw_mesh){.vertex_count = 16,
                            .triangle_count = 24,
                            .positions = positions[of],
                            .triangles = triangles};
    for (int n = 0; n < 2; n++)
        assert_ok(cw_mesh_compare(&piece[n][0], &piece[n][1], &desc, &parts, &err), err);
    assert_ok(cw_mesh_compare(&all[0], &all[1], &desc, &whole, &err), err);
    assert_near(parts.area_mm2, 6 + 96, 1e-4);
    assert_near(parts.area_mm2, whole.area_mm2, 1e-3);
    assert_near(parts.to_reference.max_mm, whole.to_reference.max_mm, 0.02);
    assert_near(parts.from_reference.max_mm, whole.from_reference.max_mm, 1e-4);
    assert_within(parts.to_reference.rms_mm, whole.to_reference.rms_mm, 0.02);
    assert_within(parts.from_reference.mean_mm, whole.from_reference.mean_mm, 0.02);
    assert_true(parts.to_reference.p99_mm >= whole.to_reference.p99_mm * 0.99);
    assert_int_equal(parts.to_reference.triangles, 24);
    for (int n = 0; n < 2; n++)
        for (int of = 0; of < 2; of++)
            cw_mesh_free(&piece[n][of]);
}

static void failures_leave_the_sum_as_it_was(void **state)
{
    (void)state;
    cw_mesh cube;
    const cw_mesh none = {0};
    cw_error err = {0};
    test_make_cube(&cube);
    float worst[8];
    cw_mesh_comparison c = {.area_mm2 = 5};
    assert_fails(cw_mesh_compare(&cube, &none, NULL, &c, &err), CW_ERR_ARGUMENT, "triangle",
                 err);
    assert_fails(
        cw_mesh_compare(&cube, &cube, &(cw_mesh_distance_desc){.worst = worst}, &c, &err),
        CW_ERR_ARGUMENT, "worst", err);
    assert_true(c.area_mm2 == 5 && c.to_reference.samples == 0);
    cw_mesh_free(&cube);
}

static void topology_may_only_get_sounder(void **state)
{
    (void)state;
    const cw_quality before = {.components = 2,
                               .euler = 4,
                               .border_loops = 1,
                               .nonmanifold_edges = 3,
                               .nonmanifold_vertices = 2,
                               .degenerate = 7};
    cw_quality after = before;
    cw_error err = {0};
    assert_ok(cw_quality_compare(&before, &after, &err), err);
    after.degenerate = after.nonmanifold_edges = after.nonmanifold_vertices = 0;
    assert_ok(cw_quality_compare(&before, &after, &err), err);
    after.components = 1;
    assert_fails(cw_quality_compare(&before, &after, &err), CW_ERR_CHECK,
                 "components: 2 before, 1 after", err);
    after = before;
    after.euler = 2;
    assert_fails(cw_quality_compare(&before, &after, &err), CW_ERR_CHECK, "Euler number: 4",
                 err);
    after = before;
    after.border_loops = 0;
    assert_fails(cw_quality_compare(&before, &after, &err), CW_ERR_CHECK, "border loops", err);
    after = before;
    after.nonmanifold_edges++;
    assert_fails(cw_quality_compare(&before, &after, &err), CW_ERR_CHECK,
                 "non-manifold edges: 3 before, 4 after", err);
    after = before;
    after.nonmanifold_vertices++;
    assert_fails(cw_quality_compare(&before, &after, &err), CW_ERR_CHECK, "vertices", err);
    after = before;
    after.degenerate++;
    assert_fails(cw_quality_compare(&before, &after, &err), CW_ERR_CHECK, "without area", err);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_ways_are_measured),
        cmocka_unit_test(parts_add_up_to_the_whole),
        cmocka_unit_test(failures_leave_the_sum_as_it_was),
        cmocka_unit_test(topology_may_only_get_sounder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
