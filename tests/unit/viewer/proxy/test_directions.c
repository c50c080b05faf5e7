/* Tests the map of quantised directions: the nearest one is found, and angles are bounded. */
#include "support/support.h"

#include "viewer/proxy/quantized_normals.h"

#include "core/geometry/vec3.h"

#include <math.h>
#include <stdlib.h>

static const size_t counts[] = {1, 2, 3, 16, 100, 1024, 5000};
enum { COUNTS = sizeof counts / sizeof *counts };

/* Evenly enough, and with zeros: the map's seams. */
static void vector_of(int n, double v[3])
{
    for (int a = 0; a < 3; a++)
        v[a] = n < 27 ? (double)(n / (int)pow(3, a) % 3 - 1) : rand() / (RAND_MAX / 2.0) - 1;
}

static double share(const cwi_directions *d, size_t n, const double v[3])
{
    return fabs(cwi_dot(d->all[n], v)) / sqrt(cwi_dot(v, v));
}

static void nearest_is_nearest(void **state)
{
    (void)state;
    cw_error err = {0};
    cwi_directions d;
    test_seed(1);
    for (int c = 0; c < COUNTS; c++) {
        assert_ok(cwi_directions_make(counts[c], &d, &err), err);
        for (int n = 0; n < test_some(3000); n++) {
            double v[3], most = 0;
            vector_of(n, v);
            if (n == 13) /* 0, 0, 0 */
                continue;
            for (size_t i = 0; i < d.count; i++)
                most = fmax(most, share(&d, i, v));
            const size_t best = cwi_directions_nearest(&d, v);
            assert_true(best < d.count);
            assert_true(share(&d, best, v) > most - 1e-12);
        }
        cwi_directions_free(&d);
        cwi_directions_free(&d);
    }
}

/* Every line is near to a direction, the nearer the more there are. */
static void angles_are_bounded(void **state)
{
    (void)state;
    cw_error err = {0};
    cwi_directions d;
    test_seed(2);
    for (int c = 3; c < COUNTS; c++) {
        double most = 0;
        assert_ok(cwi_directions_make(counts[c], &d, &err), err);
        for (size_t i = 0; i < d.count; i++)
            assert_true(fabs(cwi_dot(d.all[i], d.all[i]) - 1) < 1e-12 && d.all[i][2] > 0);
        for (int n = 0; n < 100000; n++) {
            double v[3];
            vector_of(n + 27, v);
            v[2] *= n % 2 ? 1 : 0.02; /* most at the half sphere's rim */
            most = fmax(most, acos(fmin(share(&d, cwi_directions_nearest(&d, v), v), 1)));
        }
        if (!(most * sqrt((double)counts[c]) < 2.2))
            print_message("%zu directions: %g / sqrt\n", counts[c],
                          most * sqrt((double)counts[c]));
        assert_true(most * sqrt((double)counts[c]) < 2.2);
        assert_true(most * sqrt((double)counts[c]) > 1.5); /* hexagons: 1.555 */
        cwi_directions_free(&d);
    }
}

static void what_has_no_direction_gets_none(void **state)
{
    (void)state;
    cw_error err = {0};
    cwi_directions d;
    assert_ok(cwi_directions_make(40, &d, &err), err);
    assert_int_equal(cwi_directions_nearest(&d, (double[]){0, 0, 0}), 40);
    assert_int_equal(cwi_directions_nearest(&d, (double[]){0, NAN, 1}), 40);
    assert_int_equal(cwi_directions_nearest(&d, (double[]){INFINITY, 0, 1}), 40);
    assert_int_not_equal(cwi_directions_nearest(&d, (double[]){0, 1e-300, 0}), 40);
    cwi_directions_free(&d);
    assert_int_equal(cwi_directions_make(0, &d, &err), CW_ERR_ARGUMENT);
    assert_int_equal(cwi_directions_make(8193, &d, &err), CW_ERR_ARGUMENT);
    assert_null(d.all);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nearest_is_nearest),
        cmocka_unit_test(angles_are_bounded),
        cmocka_unit_test(what_has_no_direction_gets_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
