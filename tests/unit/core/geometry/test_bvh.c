/* A tree keeps neighbours together. */
#include "support/support.h"

#include "core/geometry/bvh.h"

#include <math.h>

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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(order_leads_to_neighbours)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
