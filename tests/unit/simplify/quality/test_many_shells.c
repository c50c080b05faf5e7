/* Hundreds of shells in each other: which of them face the wrong way is known from how they are made. */
#include "support/solids.h"

#include <stdlib.h>

enum { SHELLS = 700 };

/* Makes boxes in each other, in random order of the file. Box n has n boxes around it, and faces
 * inward if that number is odd, but for some. Returns how many face the wrong way. */
static size_t make_nest(cw_mesh *mesh, const double stretch[3], int turned_of_ten)
{
    size_t order[SHELLS], wrong = 0;
    *mesh = test_make_boxes(SHELLS);
    for (size_t n = 0; n < SHELLS; n++)
        order[n] = n;
    for (size_t n = SHELLS; n-- > 1;) {
        const size_t other = (size_t)rand() % (n + 1), kept = order[n];
        order[n] = order[other];
        order[other] = kept;
    }
    for (size_t n = 0; n < SHELLS; n++) {
        double low[3], high[3];
        const bool turned = rand() % 10 < turned_of_ten;
        for (int a = 0; a < 3; a++) {
            high[a] = stretch[a] * (double)(2 * SHELLS - order[n]);
            low[a] = a == 1 ? -high[a] / 3 : -high[a];
        }
        test_add_box(mesh, low, high, (order[n] % 2 == 1) != turned);
        wrong += turned;
    }
    return wrong;
}

static void check_nest(double x, double y, double z, double angle, int turned_of_ten)
{
    const double stretch[3] = {x, y, z}, by[3] = {3, -2, 1};
    cw_mesh mesh;
    cw_quality q;
    cw_error err = {0};
    const size_t wrong = make_nest(&mesh, stretch, turned_of_ten);
    test_move_mesh(&mesh, angle, 1, by);
    assert_ok(cw_quality_measure(&mesh, &(cw_quality_desc){.shells = true}, &q, &err), err);
    assert_int_equal(q.components, SHELLS);
    assert_int_equal(q.to_turn, wrong);
    cw_mesh_free(&mesh);
}

static void shells_in_each_other_are_counted(void **state)
{
    (void)state;
    test_seed(5);
    check_nest(1, 1, 1, 0, 0);
    check_nest(1, 1, 1, 0, 3);
    check_nest(1, 0.2, 3, 0.4, 5);
    check_nest(2, 1, 0.1, 1.3, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shells_in_each_other_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
