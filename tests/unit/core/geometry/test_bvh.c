/* A tree keeps neighbours together. */
#include "support/support.h"

#include "core/geometry/bvh.h"

#include <math.h>
#include <stdlib.h>

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

/* One box more than those that are sorted by comparing them. */
static void few_boxes_are_sorted_as_many_are(void **state)
{
    (void)state;
    static float boxes[COUNT + 1][6];
    cwi_boxes few, many;
    cw_error err = {0};
    test_seed(3);
    for (int n = 0; n < COUNT; n++)
        for (int a = 0; a < 3; a++)
            boxes[n][a] = boxes[n][a + 3] = (float)(rand() % 9);
    for (int a = 0; a < 6; a++)
        boxes[COUNT][a] = boxes[0][a];
    assert_ok(cwi_boxes_build(&few, (const float(*)[6])boxes, COUNT, &err), err);
    assert_ok(cwi_boxes_build(&many, (const float(*)[6])boxes, COUNT + 1, &err), err);
    for (size_t s = 0, n = 0; s <= COUNT; s++)
        if (many.order[s] != COUNT)
            assert_int_equal(few.order[n++], many.order[s]);
    cwi_boxes_free(&few);
    cwi_boxes_free(&many);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(order_leads_to_neighbours),
                                       cmocka_unit_test(few_boxes_are_sorted_as_many_are)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
