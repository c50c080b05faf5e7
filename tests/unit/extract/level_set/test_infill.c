/* Lattices inside of hollow solids: walls as thick as asked, one solid, and no closed channel. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/mesh/mesh_attributes.h"

#include <cubewright/level_set.h>

#include <math.h>
#include <string.h>

/* A box with its corner at `place`; one side is 1, 3/4 and 1/2 of the size. */
static cw_mesh make_box(double size, float place)
{
    static const float parts[3] = {1, 0.75F, 0.5F};
    cw_mesh box;
    test_make_cube(&box);
    for (size_t i = 0; i < 3 * box.vertex_count; i++)
        box.positions[i] = (float)size * parts[i % 3] * box.positions[i] + place;
    return box;
}

static cw_mesh make_ball(void)
{
    cw_volume volume = test_sample(CW_FIELD_SPHERE, 24, CW_F32);
    cw_mesh ball = test_extract(&volume, &(cw_extract_desc){.no_normals = true}, NULL);
    cw_volume_free(&volume);
    return ball;
}

static cw_mesh make_torus(void)
{
    cw_volume volume = test_sample(CW_FIELD_TORUS, 40, CW_F32);
    cw_mesh torus = test_extract(&volume, &(cw_extract_desc){.no_normals = true}, NULL);
    cw_volume_free(&volume);
    return torus;
}

static cw_quality measure_shells(const cw_mesh *mesh)
{
    const cw_quality_desc desc = {.shells = true};
    cw_quality q;
    cw_error err = {0};
    assert_ok(cw_quality_measure(mesh, &desc, &q, &err), err);
    return q;
}

/* One solid, closed, a manifold without crossings, and without a closed cavity. */
static void check_print(const cw_mesh *mesh)
{
    const cw_quality q = measure_shells(mesh);
    assert_int_equal(q.components, 1);
    assert_int_equal(q.cavities, 0);
    assert_true(!q.open_edges && !q.nonmanifold_edges && !q.misoriented_edges);
    assert_int_equal(test_count_crossings(mesh), 0);
}

static void walls_are_as_thick_as_asked_and_channels_are_open(void **state)
{
    (void)state;
    cw_mesh solids[] = {make_box(40, 0), make_ball(), make_torus()}, out;
    const cw_drain down = {5, {0, 0, -1}};
    for (size_t n = 0; n < 3; n++)
        for (int kind = 0; kind < CW_INFILL_COUNT; kind++) {
            const double wall = n ? 2.6 : 1.6; /* the box is smaller */
            const cw_infill_desc infill = {
                .kind = (cw_infill_kind)kind, .cell_mm = 7.5 * wall, .wall_mm = wall};
            const cw_hollow_desc desc = {
                .wall_mm = 2, .drains = &down, .drain_count = 1, .infill = &infill};
            cw_hollow_facts facts;
            cw_error err = {0};
            if ((n || test_is_short()) && (int)n != kind)
                continue;
            assert_ok(cw_mesh_hollow(&solids[n], &desc, &out, &facts, &err), err);
            check_print(&out);
            assert_true(facts.cavities >= 1 && facts.sealed == 0 && facts.drains >= 1);
            assert_true(facts.infill_samples > 100);
            assert_within(facts.infill_median_mm, wall, 0.03);
            assert_true(facts.infill_min_mm > 0.93 * wall && facts.infill_max_mm < 1.07 * wall);
            assert_within(facts.wall_min_mm, 2, 0.02);
            assert_true(facts.wall_max_mm < 2.6);
            cw_mesh_free(&out);
        }
    for (size_t n = 0; n < 3; n++)
        cw_mesh_free(&solids[n]);
}

static void without_drains_the_outside_is_the_input(void **state)
{
    (void)state;
    cw_mesh box = make_box(40, 0), out;
    const cw_infill_desc infill = {.cell_mm = 12, .wall_mm = 1.6};
    const cw_hollow_desc desc = {.wall_mm = 2, .infill = &infill};
    cw_hollow_facts facts;
    cw_error err = {0};
    assert_ok(cw_mesh_hollow(&box, &desc, &out, &facts, &err), err);
    assert_memory_equal(out.positions, box.positions,
                        3 * box.vertex_count * sizeof *box.positions);
    assert_memory_equal(out.triangles, box.triangles,
                        3 * box.triangle_count * sizeof *box.triangles);
    assert_true(facts.cavities == facts.sealed && facts.sealed >= 2 && facts.drains == 0);
    assert_int_equal(measure_shells(&out).cavities, facts.sealed);
    assert_int_equal(test_count_crossings(&out), 0);
    cw_mesh_free(&out);
    cw_mesh_free(&box);
}

/* A ramp along x over the box. */
static cw_volume make_ramp(void)
{
    cw_volume v = test_sample(CW_FIELD_SPHERE, 8, CW_F32);
    float *data = v.owned;
    for (size_t n = 0; n < 512; n++)
        data[n] = (float)(n % 8);
    for (int a = 0; a < 3; a++) {
        memset(v.affine[a], 0, sizeof v.affine[a]);
        v.affine[a][a] = 40.0 / 7;
    }
    return v;
}

static void walls_change_by_a_depth_or_by_a_volume(void **state)
{
    (void)state;
    cw_mesh box = make_box(40, 0), out;
    cw_volume ramp = make_ramp();
    const cw_infill_desc graded[] = {
        {.cell_mm = 12, .wall_mm = 1.6, .end_wall_mm = 3, .depth_mm = 6},
        {.cell_mm = 12, .wall_mm = 3, .end_wall_mm = 1.6, .depth_mm = 6},
        {.cell_mm = 12, .wall_mm = 1.6, .end_wall_mm = 3, .by = &ramp}};
    for (size_t n = 0; n < 3; n++) {
        const cw_hollow_desc desc = {.wall_mm = 2, .infill = &graded[n]};
        cw_hollow_facts facts;
        cw_error err = {0};
        assert_ok(cw_mesh_hollow(&box, &desc, &out, &facts, &err), err);
        assert_true(facts.infill_min_mm > 1.5 && facts.infill_max_mm < 3.2);
        assert_true(facts.infill_max_mm - facts.infill_min_mm > 0.5);
        assert_int_equal(test_count_crossings(&out), 0);
        cw_mesh_free(&out);
    }
    cw_volume_free(&ramp);
    cw_mesh_free(&box);
}

static void units_and_places_do_not_matter(void **state)
{
    (void)state;
    static const double scales[] = {1e-4, 1, 1e4};
    size_t triangles = 0;
    for (size_t n = 0; n < 3; n++) {
        const double s = scales[n];
        cw_mesh box = make_box(40 * s, (float)(25 * s)), out;
        const cw_drain drain = {5 * s, {0, 1, 0}};
        const cw_infill_desc infill = {.cell_mm = 14 * s, .wall_mm = 2 * s};
        const cw_hollow_desc desc = {
            .wall_mm = 2 * s, .drains = &drain, .drain_count = 1, .infill = &infill};
        cw_hollow_facts facts;
        cw_error err = {0};
        assert_ok(cw_mesh_hollow(&box, &desc, &out, &facts, &err), err);
        check_print(&out);
        assert_within(facts.infill_median_mm, 2 * s, 0.03);
        if (n)
            assert_within((double)out.triangle_count, (double)triangles, 0.02);
        triangles = out.triangle_count;
        cw_mesh_free(&out);
        cw_mesh_free(&box);
    }
}

/* A plate leaves room for a lattice in which most channels are cut off from each other. */
static void channels_without_a_drain_are_filled(void **state)
{
    (void)state;
    cw_mesh plate, out;
    test_make_cube(&plate);
    for (size_t i = 0; i < 3 * plate.vertex_count; i++)
        plate.positions[i] *= i % 3 == 2 ? 6.0F : 50.0F;
    const cw_drain down = {4, {0, 0, -1}};
    const cw_infill_desc infill = {.kind = CW_INFILL_SCHWARZ_P, .cell_mm = 12, .wall_mm = 2};
    const cw_hollow_desc desc = {
        .wall_mm = 2, .drains = &down, .drain_count = 1, .infill = &infill};
    cw_hollow_facts facts;
    cw_error err = {0};
    assert_ok(cw_mesh_hollow(&plate, &desc, &out, &facts, &err), err);
    check_print(&out);
    assert_int_equal(facts.sealed, 0);
    cw_mesh_free(&out);
    cw_mesh_free(&plate);
}

static void threads_do_not_matter(void **state)
{
    (void)state;
    cw_mesh box = make_box(30, 3), one, four;
    const cw_drain drain = {5, {1, 0, 0}};
    const cw_infill_desc infill = {.kind = CW_INFILL_DIAMOND, .cell_mm = 14, .wall_mm = 2};
    cw_hollow_desc desc = {
        .wall_mm = 2, .drains = &drain, .drain_count = 1, .infill = &infill, .threads = 1};
    cw_hollow_facts facts[2];
    cw_error err = {0};
    assert_ok(cw_mesh_hollow(&box, &desc, &one, &facts[0], &err), err);
    desc.threads = 4;
    assert_ok(cw_mesh_hollow(&box, &desc, &four, &facts[1], &err), err);
    test_assert_same_mesh(&one, &four);
    assert_true(facts[0].infill_median_mm == facts[1].infill_median_mm);
    cw_mesh_free(&one);
    cw_mesh_free(&four);
    cw_mesh_free(&box);
}

static void wrong_lattices_are_refused(void **state)
{
    (void)state;
    cw_volume flat = make_ramp();
    memset(flat.owned, 0, 512 * sizeof(float));
    const struct {
        cw_infill_desc infill;
        double voxel_mm;
        size_t max_bytes;
        cw_status status;
        const char *words;
    } rows[] = {
        {{.kind = CW_INFILL_COUNT, .cell_mm = 8, .wall_mm = 1},
         0,
         0,
         CW_ERR_ARGUMENT,
         "not a kind"},
        {{.cell_mm = 0, .wall_mm = 1}, 0, 0, CW_ERR_ARGUMENT, "cells of 0 mm"},
        {{.cell_mm = 8, .wall_mm = NAN}, 0, 0, CW_ERR_ARGUMENT, "walls of nan"},
        {{.cell_mm = 2, .wall_mm = 3}, 0, 0, CW_ERR_ARGUMENT, "cells of at least 9 mm"},
        {{.kind = CW_INFILL_DIAMOND, .cell_mm = 8, .wall_mm = 2},
         0,
         0,
         CW_ERR_ARGUMENT,
         "at most 1.92 mm"},
        {{.cell_mm = 8, .wall_mm = 1, .end_wall_mm = 2},
         0,
         0,
         CW_ERR_ARGUMENT,
         "by a depth or"},
        {{.cell_mm = 8, .wall_mm = 1, .depth_mm = 2}, 0, 0, CW_ERR_ARGUMENT, "by a depth or"},
        {{.cell_mm = 8, .wall_mm = 1}, 0.5, 0, CW_ERR_ARGUMENT, "quarter of that, 0.25 mm"},
        {{.cell_mm = 8, .wall_mm = 0.1}, 0, 100000000, CW_ERR_LIMIT, "would do"},
        {{.cell_mm = 8, .wall_mm = 1, .end_wall_mm = 2, .by = &flat},
         0,
         0,
         CW_ERR_EMPTY,
         "no range of values"},
        {{.version = 7, .cell_mm = 8, .wall_mm = 1}, 0, 0, CW_ERR_ARGUMENT, "version is 7"},
    };
    cw_mesh box = make_box(40, 0), out;
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        const cw_hollow_desc desc = {.wall_mm = 2,
                                     .voxel_mm = rows[n].voxel_mm,
                                     .max_bytes = rows[n].max_bytes,
                                     .infill = &rows[n].infill};
        cw_error err = {0};
        assert_fails(cw_mesh_hollow(&box, &desc, &out, NULL, &err), rows[n].status,
                     rows[n].words, err);
        assert_null(out.positions);
    }
    assert_null(cw_infill_name(CW_INFILL_COUNT));
    assert_string_equal(cw_infill_name(CW_INFILL_DIAMOND), "diamond");
    cw_volume_free(&flat);
    cw_mesh_free(&box);
}

static void running_out_of_memory_is_told(void **state)
{
    (void)state;
    cw_mesh box = make_box(16, 0), out;
    const cw_drain down = {4, {0, 0, -1}};
    const cw_infill_desc infill = {.cell_mm = 8, .wall_mm = 2.6};
    const cw_hollow_desc desc = {.wall_mm = 1.5,
                                 .voxel_mm = 0.65,
                                 .drains = &down,
                                 .drain_count = 1,
                                 .infill = &infill,
                                 .threads = 1};
    for (long n = 0;; n += 1 + n / 8) {
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_hollow(&box, &desc, &out, NULL, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_ok(st, err);
            cw_mesh_free(&out);
            break;
        }
        if (st == CW_OK) /* memory that was given back could stay */
            cw_mesh_free(&out);
        else
            assert_fails(st, CW_ERR_NO_MEMORY, "no memory", err);
        assert_null(out.positions);
    }
    cw_mesh_free(&box);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(walls_are_as_thick_as_asked_and_channels_are_open),
        cmocka_unit_test(without_drains_the_outside_is_the_input),
        cmocka_unit_test(walls_change_by_a_depth_or_by_a_volume),
        cmocka_unit_test(units_and_places_do_not_matter),
        cmocka_unit_test(channels_without_a_drain_are_filled),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(wrong_lattices_are_refused),
        cmocka_unit_test(running_out_of_memory_is_told),
    };
    return cw_level_set_available() ? cmocka_run_group_tests(tests, NULL, NULL) : 0;
}
