/* A tree keeps neighbours together. */
#include "support/support.h"

#include "core/geometry/bvh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 16, COUNT = SIDE * SIDE * SIDE };

/* The curve leads through a lattice of points from neighbour to neighbour, and nowhere twice. */
static void order_leads_to_neighbours(void **state)
{
    (void)state;
    static float boxes[COUNT][6];
    static bool seen[COUNT];
    for (int n = 0; n < COUNT; n++)
        for (int a = 0; a < 6; a++)
            boxes[n][a] = (float)((n >> 4 * (a % 3)) % SIDE);
    cwi_boxes tree;
    cw_error err = {0};
    assert_ok(cwi_boxes_build(&tree, (const float(*)[6])boxes, COUNT, &err), err);
    for (size_t s = 0; s < COUNT; s++) {
        float way = 0;
        assert_false(seen[tree.order[s]]);
        seen[tree.order[s]] = true;
        for (int a = 0; a < 3 && s; a++)
            way += fabsf(boxes[tree.order[s]][a] - boxes[tree.order[s - 1]][a]);
        assert_true(s == 0 || way == 1);
    }
    cwi_boxes_free(&tree);
}

enum { MANY = 200000, APART = 100 };

/* Points of a lattice, many of them in one place, most in a corner of the cube. */
static void scatter_boxes(float (*boxes)[6])
{
    test_seed(3);
    for (int n = 0; n < MANY; n++)
        for (int a = 0; a < 3; a++)
            boxes[n][a] = boxes[n][a + 3] =
                (float)(n < 2 ? 255 * n : rand() % 9 * (rand() % 5));
}

static cwi_boxes build(const float (*boxes)[6], size_t count, int threads)
{
    cwi_boxes tree;
    cw_error err = {0};
    assert_ok(cwi_boxes_build_by(&tree, boxes, count, threads, &err), err);
    return tree;
}

/* Few boxes are sorted by comparing them, many by digits: the order is the same, and equal boxes keep
 * theirs. */
static void few_boxes_are_sorted_as_many_are(void **state)
{
    (void)state;
    static float boxes[MANY][6], some[MANY / APART + 1][6];
    scatter_boxes(boxes);
    memcpy(some[0], boxes[1], sizeof *some); /* so that the cube is the same */
    for (int n = 0; n < MANY / APART; n++)
        memcpy(some[n + 1], boxes[n * APART], sizeof *some);
    cwi_boxes few = build((const float(*)[6])some, MANY / APART + 1, 1),
              many = build((const float(*)[6])boxes, MANY, 1);
    size_t n = 0;
    for (size_t s = 0; s < MANY; s++) {
        const uint32_t item = many.order[s], before = s ? many.order[s - 1] : 0;
        assert_true(s == 0 || item > before ||
                    memcmp(boxes[item], boxes[before], sizeof *boxes) != 0);
        if (item % APART)
            continue;
        while (few.order[n] == 0)
            n++;
        assert_int_equal(few.order[n++], item / APART + 1);
    }
    cwi_boxes_free(&few);
    cwi_boxes_free(&many);
}

static void threads_build_the_same_tree(void **state)
{
    (void)state;
    static float boxes[MANY][6];
    scatter_boxes(boxes);
    cwi_boxes one = build((const float(*)[6])boxes, MANY, 1),
              three = build((const float(*)[6])boxes, MANY, 3);
    const size_t nodes = one.first[one.levels - 1] + 1;
    assert_int_equal(one.levels, three.levels);
    assert_memory_equal(one.order, three.order, MANY * sizeof *one.order);
    assert_memory_equal(one.nodes, three.nodes, nodes * sizeof *one.nodes);
    assert_true(one.max == 255 && three.max == 255);
    cwi_boxes_free(&one);
    cwi_boxes_free(&three);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(order_leads_to_neighbours),
                                       cmocka_unit_test(few_boxes_are_sorted_as_many_are),
                                       cmocka_unit_test(threads_build_the_same_tree)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
