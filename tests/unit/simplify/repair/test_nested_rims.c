/* Holes with several rims: what lies between the walls of a vessel is filled. */
#include "support/solids.h"

#include "core/base/memory.h"
#include "core/mesh/mesh.h"

#include <math.h>

enum { MAX_BOXES = 5 };

static const double TOP = 10;

/* Boxes that end at the top and have lost their lids there. */
typedef struct vessel_row {
    const char *name;
    struct {
        double low[3], high[2]; /* the latter in x and y */
        bool inward;
    } boxes[MAX_BOXES];
    size_t count, holes;
    double volume_mm3;
    bool flat;
} vessel_row;

static const vessel_row vessel_rows[] = {
    {"cup", {{{0, 0, 0}, {10, 10}, false}, {{1, 1, 1}, {9, 9}, true}}, 2, 1, 1000 - 576, false},
    {"thin cup",
     {{{0, 0, 0}, {10, 10}, false}, {{0.125, 0.125, 0.125}, {9.875, 9.875}, true}},
     2,
     1,
     1000 - 9.75 * 9.75 * 9.875,
     false},
    {"two wells",
     {{{0, 0, 0}, {10, 10}, false}, {{1, 1, 1}, {4, 9}, true}, {{5, 1, 1}, {9, 9}, true}},
     3,
     1,
     1000 - 24 * 9 - 32 * 9,
     false},
    {"pillar in a well",
     {{{0, 0, 0}, {10, 10}, false}, {{1, 1, 1}, {9, 9}, true}, {{4, 4, 2}, {6, 6}, false}},
     3,
     2,
     1000 - 576 + 4 * 8,
     true},
    {"cut off: no dome", {{{0, 0, 0}, {10, 10}, false}}, 1, 1, 1000, false},
    {"side by side",
     {{{0, 0, 0}, {4, 10}, false}, {{5, 0, 0}, {9, 10}, false}},
     2,
     2,
     800,
     true},
    {"one in the other, both solid",
     {{{0, 0, 0}, {10, 10}, false}, {{1, 1, 1}, {9, 9}, false}},
     2,
     2,
     1000,
     true},
};

static cw_mesh make_vessel(const vessel_row *row, double scale)
{
    cw_error err = {0};
    cw_mesh m = test_make_boxes(MAX_BOXES);
    bool gone[12 * MAX_BOXES] = {false};
    for (size_t n = 0; n < row->count; n++) {
        const double high[3] = {row->boxes[n].high[0], row->boxes[n].high[1], TOP};
        test_add_box(&m, row->boxes[n].low, high, row->boxes[n].inward);
    }
    for (size_t t = 0; t < m.triangle_count; t++) {
        gone[t] = true;
        for (int k = 0; k < 3; k++)
            gone[t] &= (double)m.positions[3 * (size_t)m.triangles[3 * t + k] + 2] == TOP;
    }
    assert_ok(cwi_mesh_drop_marked(&m, gone, &err), err);
    const double by[3] = {0.25, -0.5, 1};
    test_move_mesh(&m, 0.4, scale, by);
    return m;
}

static void check_vessel(const vessel_row *row, double scale)
{
    cw_mesh m = make_vessel(row, scale), out;
    const cw_repair_desc desc = {.flat_holes = row->flat};
    cw_repair_facts facts;
    cw_error err = {0};
    assert_ok(cw_mesh_repair(&m, &desc, &out, &facts, &err), err);
    test_check_solid(&out);
    const double volume = test_measure(&out).volume_mm3 / pow(scale, 3);
    if (facts.holes_filled != row->holes ||
        !(fabs(volume - row->volume_mm3) <= 1e-5 * row->volume_mm3) ||
        !(fabs(facts.volume_before_mm3 / pow(scale, 3) - volume) <= 0.03 * volume))
        fail_msg("%s by %g: %zu holes, expected %zu; volume %.9g, before %.5g, expected %.9g",
                 row->name, scale, facts.holes_filled, row->holes, volume,
                 facts.volume_before_mm3 / pow(scale, 3), row->volume_mm3);
    cw_mesh_free(&m);
    cw_mesh_free(&out);
}

static void what_lies_between_rims_is_filled(void **state)
{
    (void)state;
    static const double scales[] = {1, 1e-4, 1e4};
    for (size_t n = 0; n < sizeof vessel_rows / sizeof *vessel_rows; n++)
        for (int k = 0; k < 3; k++)
            check_vessel(&vessel_rows[n], scales[k]);
}

/* A limit counts across the hole, and so across the outer rim. */
static void large_holes_with_small_rims_stay(void **state)
{
    (void)state;
    cw_mesh m = make_vessel(&vessel_rows[2], 1), out;
    const cw_repair_desc desc = {.max_hole_mm = 10};
    cw_repair_facts facts;
    cw_error err = {0};
    assert_ok(cw_mesh_repair(&m, &desc, &out, &facts, &err), err);
    assert_int_equal(facts.holes_filled, 0);
    assert_int_equal(facts.holes_left, 1);
    assert_int_equal(out.triangle_count, m.triangle_count);
    cw_mesh_free(&m);
    cw_mesh_free(&out);
}

static void failures_leave_nothing(void **state)
{
    (void)state;
    cw_mesh m = make_vessel(&vessel_rows[2], 1);
    test_repair_without_memory(&m, &(cw_repair_desc){.threads = 1}, 40);
    cw_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_lies_between_rims_is_filled),
        cmocka_unit_test(large_holes_with_small_rims_stay),
        cmocka_unit_test(failures_leave_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
