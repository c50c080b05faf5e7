/* The front of cost against error: what nothing else beats. */
#include "cli/study/study.h"
#include "support/support.h"

#include <math.h>

static void what_nothing_beats_is_on_the_front(void **state)
{
    (void)state;
    const double cost[] = {1, 2, 3, 4, 2.5}, error[] = {9, 5, 6, 1, 5};
    bool front[5];
    cli_pareto(cost, error, 5, front);
    assert_true(front[0] && front[1] && front[3]);
    assert_false(front[2]); /* dearer and farther than the second */
    assert_false(front[4]); /* dearer, and as far */
}

static void equals_do_not_beat_each_other(void **state)
{
    (void)state;
    const double cost[] = {2, 2, 2}, error[] = {3, 3, 4};
    bool front[3];
    cli_pareto(cost, error, 3, front);
    assert_true(front[0] && front[1]);
    assert_false(front[2]);
}

static void what_was_not_measured_neither_beats_nor_stays(void **state)
{
    (void)state;
    const double cost[] = {NAN, 1, 5, 0}, error[] = {0, NAN, 5, INFINITY};
    bool front[4];
    cli_pareto(cost, error, 4, front);
    assert_false(front[0] || front[1] || front[3]);
    assert_true(front[2]);
}

/* By the definition, on points without any order: on the front if and only if not beaten. */
static void random_points_agree_with_the_definition(void **state)
{
    enum { COUNT = 200 };
    (void)state;
    double cost[COUNT], error[COUNT];
    bool front[COUNT];
    unsigned seed = 7;
    for (size_t n = 0; n < COUNT; n++) {
        seed = seed * 1664525u + 1013904223u;
        cost[n] = (double)(seed >> 26);
        seed = seed * 1664525u + 1013904223u;
        error[n] = (double)(seed >> 26);
    }
    cli_pareto(cost, error, COUNT, front);
    for (size_t n = 0; n < COUNT; n++) {
        bool beaten = false;
        for (size_t m = 0; m < COUNT; m++)
            beaten = beaten || (cost[m] < cost[n] && error[m] <= error[n]) ||
                     (cost[m] <= cost[n] && error[m] < error[n]);
        assert_int_equal(front[n], !beaten);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_nothing_beats_is_on_the_front),
        cmocka_unit_test(equals_do_not_beat_each_other),
        cmocka_unit_test(what_was_not_measured_neither_beats_nor_stays),
        cmocka_unit_test(random_points_agree_with_the_definition),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
