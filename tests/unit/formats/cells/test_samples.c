/* Samples that stand twice. */
#include "formats/cells/merge_samples.h"
#include "support/support.h"

#include <stdlib.h>
#include <string.h>

static void the_first_of_equal_samples_stays(void **state)
{
    (void)state;
    double points[15] = {1, 2, 3, 0, 0, 0, 1, 2, 3, 1, 2, 3, 0, 0, 0};
    uint16_t values[5] = {7, 8, 9, 7, 8};
    uint32_t map[5];
    size_t same;
    assert_true(cwi_samples_map(points, values, sizeof *values, 5, map, &same));
    assert_int_equal(same, 2);
    assert_memory_equal(map, ((uint32_t[]){0, 1, 2, 0, 1}), sizeof map);
    cwi_samples_drop(points, values, sizeof *values, 5, map);
    assert_memory_equal(map, ((uint32_t[]){0, 1, 2, 0, 1}), sizeof map);
    assert_memory_equal(points, ((double[]){1, 2, 3, 0, 0, 0, 1, 2, 3}), 9 * sizeof *points);
    assert_memory_equal(values, ((uint16_t[]){7, 8, 9}), 3 * sizeof *values);

    double again[12] = {5, 5, 5, 5, 5, 5, 6, 6, 6, 5, 5, 5};
    assert_true(cwi_samples_map(again, again, 0, 4, map, &same));
    assert_int_equal(same, 2);
    cwi_samples_drop(again, again, 0, 4, map);
    assert_memory_equal(map, ((uint32_t[]){0, 0, 1, 0}), 4 * sizeof *map);
    assert_memory_equal(again, ((double[]){5, 5, 5, 6, 6, 6}), 6 * sizeof *again);
}

/* All at one place, or in a row, none the same as another; then each twice. */
static void many_samples_are_told_apart(void **state)
{
    (void)state;
    enum { COUNT = 200000 };
    double *points = calloc(3 * COUNT, sizeof *points);
    double *values = calloc(COUNT, sizeof *values);
    uint32_t *map = calloc(COUNT, sizeof *map);
    size_t same;
    assert_true(points && values && map);
    for (int row = 0; row < 2; row++) {
        for (size_t n = 0; n < COUNT; n++) {
            values[n] = row ? 1 : (double)n;
            points[3 * n] = row ? (double)n : 1;
        }
        assert_true(cwi_samples_map(points, values, sizeof *values, COUNT, map, &same));
        assert_int_equal(same, 0);
    }
    for (size_t n = 0; n < COUNT; n++)
        points[3 * n] = (double)(n / 2);
    assert_true(cwi_samples_map(points, values, sizeof *values, COUNT, map, &same));
    assert_int_equal(same, COUNT / 2);
    cwi_samples_drop(points, values, sizeof *values, COUNT, map);
    for (size_t n = 0; n < COUNT; n++)
        assert_int_equal(map[n], n / 2);
    free(points);
    free(values);
    free(map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_of_equal_samples_stays),
        cmocka_unit_test(many_samples_are_told_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
