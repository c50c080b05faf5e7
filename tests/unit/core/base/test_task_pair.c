/* Tests work beside work: both run once, and the second sees what the first has found. */
#include "support/support.h"

#include "core/base/task_pair.h"

typedef struct errand {
    cwi_task_pair pair;
    int found, seen, turns;
} errand;

static void find_answer(void *context)
{
    errand *e = context;
    for (volatile int n = 0; n < 100000; n++)
        ;
    e->found = 42;
    e->turns++;
}

static void await_answer(void *context)
{
    errand *e = context;
    cwi_task_pair_wait(&e->pair);
    e->seen = e->found;
    e->turns++;
}

static void the_second_waits_for_what_the_first_finds(void **state)
{
    (void)state;
    for (int n = 0; n < 200; n++) {
        errand e = {0};
        cwi_task_pair_run(&e.pair, find_answer, await_answer, &e);
        assert_int_equal(e.seen, 42);
        assert_int_equal(e.turns, 2);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_second_waits_for_what_the_first_finds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
