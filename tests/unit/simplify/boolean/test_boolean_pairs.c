/* Booleans of random pairs of solids: volumes add up, and results are sound after rounding. */
#include "support/solids.h"

#include <cubewright/boolean.h>

#include <math.h>
#include <stdio.h>

/* Kinds whose surfaces may be closer than floats can tell apart: vertices of inputs may move. */
static const unsigned CLOSE = 1u << PAIR_FACES | 1u << PAIR_SCANS | 1u << PAIR_COPIES;

/* A pair, and how far its volumes may be off because vertices moved. */
typedef struct pair_test {
    test_pair_kind kind;
    unsigned seed;
    cw_mesh pair[2];
    double area, slack; /* of both */
} pair_test;

static void fail_pair(const pair_test *t, const char *what)
{
    fail_msg("%s, seed %u: %s", test_pair_names[t->kind], t->seed, what);
}

/* Runs an operation on both, or on one of them alone, and checks results. */
static void run_boolean(pair_test *t, int first, size_t count, cw_boolean_op op,
                        double volumes[2])
{
    const cw_mesh *const meshes[2] = {&t->pair[first], &t->pair[1 - first]};
    cw_error err = {0};
    cw_mesh out[2] = {{0}, {0}};
    cw_boolean_facts f = {0};
    char text[600];
    const cw_status st =
        cw_mesh_boolean(meshes, count, &(cw_boolean_desc){.op = op}, out, &f, &err);
    snprintf(text, sizeof text, "operation %d: %s", (int)op, err.message);
    if (st != CW_OK)
        fail_pair(t, text);
    for (int n = 0; n < 2; n++) {
        const bool some = out[n].triangle_count > 0;
        const double volume = some ? test_measure(&out[n]).volume_mm3 : 0;
        const char *fault = some ? test_solid_fault(&out[n]) : NULL;
        snprintf(text, sizeof text, "operation %d: %s", (int)op, fault ? fault : "");
        if (fault)
            fail_pair(t, text);
        snprintf(text, sizeof text, "operation %d: the volume is %.12g, and was %.12g", (int)op,
                 volume, f.volume_mm3[n]);
        if (fabs(volume - f.volume_mm3[n]) > 1e-6 * f.volume_mm3[n] + f.moved_mm * t->area)
            fail_pair(t, text);
        volumes[n] = f.volume_mm3[n];
        cw_mesh_free(&out[n]);
    }
    if (CLOSE & 1u << t->kind)
        t->slack += f.moved_mm * t->area;
}

/* The volumes of union and intersection add up to those of both solids, whatever they are; so do those of the parts. */
static void check_pair(test_pair_kind kind, unsigned seed)
{
    pair_test t = {.kind = kind, .seed = seed};
    test_make_pair(kind, seed, t.pair);
    t.area = test_measure(&t.pair[0]).area_mm2 + test_measure(&t.pair[1]).area_mm2;
    t.slack = 1e-14 * pow(t.area, 1.5); /* of doubles: needles have little volume */
    double a[2], b[2], one[2], both[2], right[2], odd[2], split[2];
    run_boolean(&t, 0, 1, CW_BOOLEAN_UNION, a);
    run_boolean(&t, 1, 1, CW_BOOLEAN_UNION, b);
    run_boolean(&t, 0, 2, CW_BOOLEAN_UNION, one);
    run_boolean(&t, 0, 2, CW_BOOLEAN_INTERSECTION, both);
    run_boolean(&t, 1, 2, CW_BOOLEAN_DIFFERENCE, right);
    run_boolean(&t, 0, 2, CW_BOOLEAN_XOR, odd);
    run_boolean(&t, 0, 2, CW_BOOLEAN_SPLIT, split);
    const double rests[] = {
        one[0] + both[0] - a[0] - b[0],
        odd[0] + both[0] - one[0],
        split[0] + right[0] - odd[0],
        split[1] - both[0],
    };
    char text[160];
    if (kind == PAIR_COPIES && odd[0] > 1e-4 * t.area * cbrt(a[0] + b[0]))
        fail_pair(&t, "nearly equal copies differ");
    for (int n = 0; n < 4; n++) {
        snprintf(text, sizeof text, "volumes %.12g and %.12g: sum %d is off by %.3g", a[0],
                 b[0], n, rests[n]);
        if (fabs(rests[n]) > 1e-9 * (a[0] + b[0]) + t.slack)
            fail_pair(&t, text);
    }
    cw_mesh_free(&t.pair[0]);
    cw_mesh_free(&t.pair[1]);
}

static void check_kind(test_pair_kind kind, int count)
{
    const unsigned first = test_seed(1000 * (unsigned)kind);
    for (int n = 0; n < test_some(count); n++)
        check_pair(kind, first + (unsigned)n);
}

static void extracted_fields_add_up(void **state)
{
    (void)state;
    check_kind(PAIR_FIELDS, 160);
}

static void noise_of_few_values_adds_up(void **state)
{
    (void)state;
    check_kind(PAIR_SCANS, 200);
}

static void boxes_that_touch_add_up(void **state)
{
    (void)state;
    check_kind(PAIR_BOXES, 600);
}

static void copies_nearly_equal_add_up(void **state)
{
    (void)state;
    check_kind(PAIR_COPIES, 400);
}

static void needles_add_up(void **state)
{
    (void)state;
    check_kind(PAIR_NEEDLES, 400);
}

static void shells_in_shells_add_up(void **state)
{
    (void)state;
    check_kind(PAIR_SHELLS, 300);
}

static void spheres_that_overlap_add_up(void **state)
{
    (void)state;
    check_kind(PAIR_SPHERES, 240);
}

static void stars_add_up(void **state)
{
    (void)state;
    check_kind(PAIR_STARS, 400);
}

static void turned_boxes_that_share_faces_add_up(void **state)
{
    (void)state;
    check_kind(PAIR_FACES, 400);
}

static void blocks_of_a_scan_add_up(void **state)
{
    (void)state;
    if (!test_has_scan()) {
        skip();
        return;
    }
    check_kind(PAIR_CROPS, 300);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(extracted_fields_add_up),
        cmocka_unit_test(noise_of_few_values_adds_up),
        cmocka_unit_test(boxes_that_touch_add_up),
        cmocka_unit_test(copies_nearly_equal_add_up),
        cmocka_unit_test(needles_add_up),
        cmocka_unit_test(shells_in_shells_add_up),
        cmocka_unit_test(spheres_that_overlap_add_up),
        cmocka_unit_test(stars_add_up),
        cmocka_unit_test(turned_boxes_that_share_faces_add_up),
        cmocka_unit_test(blocks_of_a_scan_add_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
