/* Filters that keep edges, held against sums over whole neighbourhoods. */
#include "support/noise_volume.h"
#include "support/support.h"

#include "core/base/memory.h"
#include "core/filter/fast_exp.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void exponentials_are_close(void **state)
{
    (void)state;
    for (int n = 0; n < 80000; n++) {
        const double t = n / 1000.0, right = exp(-t);
        assert_true(fabs((double)cwi_fast_exp((float)t) - right) <= 1e-5 * right);
    }
    assert_true(cwi_fast_exp(0) == 1 && cwi_fast_exp(81) == 0 && cwi_fast_exp(1e30f) == 0);
    assert_true(cwi_fast_exp(NAN) == 0 && cwi_fast_exp(INFINITY) == 0);
}

/* --- bilateral ------------------------------------------------------------------------- */

typedef struct widths {
    double space[3], value;
} widths;

static double mean_of_similar(const cw_volume *v, const size_t at[3], const void *context)
{
    const widths *w = context;
    const double middle = value_near(v, at, 0, 0, 0);
    double sum = 0, weights = 0;
    if (is_gap(v, middle))
        return (double)NAN;
    for (long z = -10; z <= 10; z++)
        for (long y = -10; y <= 10; y++)
            for (long x = -10; x <= 10; x++) {
                const double by[3] = {(double)x, (double)y, (double)z};
                double distance_sq = 0;
                for (int a = 0; a < 3; a++)
                    distance_sq += w->space[a] > 0 ? pow(by[a] / w->space[a], 2)
                                   : by[a] != 0    ? 1e9
                                                   : 0;
                const double value = value_near(v, at, x, y, z),
                             d = (value - middle) * v->slope / w->value;
                if (distance_sq > 2.5 * 2.5 || is_gap(v, value))
                    continue;
                const double weight = exp(-0.5 * (distance_sq + d * d));
                sum += weight * value;
                weights += weight;
            }
    return sum / weights;
}

static void bilateral_is_the_mean_of_similar_values(void **state)
{
    (void)state;
    const widths cases[] = {
        {{1, 1, 1}, 30}, {{0.5, 1.3, 0}, 8}, {{2, 0.3, 1.1}, 1000}, {{4, 0, 0}, 50}};
    srand(test_seed(7));
    for (size_t n = 0; n < NOISE_TYPES * 4; n++) {
        const widths *w = cases + n / 2 % 4;
        cw_volume v = make_noise_volume(noise_types[n % NOISE_TYPES], (size_t[]){7, 5, 6},
                                        n % 3 == 0),
                  out;
        cw_error err = {0};
        v.slope = n % 5 == 0 ? -2 : 1;
        v.intercept = 5;
        assert_ok(cw_volume_bilateral(&v, w->space, w->value, NULL, &out, &err), err);
        assert_int_equal(out.type, cw_filter_type(&v));
        assert_memory_equal(out.affine, v.affine, sizeof v.affine);
        assert_filtered(&v, &out, mean_of_similar, w);
        cw_volume_free(&out);
        cw_volume_free(&v);
    }
}

/* --- non-local means ------------------------------------------------------------------- */

/* Returns the mean squared difference of two cubes; one with a missing value counts as noise. */
static double compare_cubes(const cw_volume *v, const size_t at[3], const long by[3],
                            double noise)
{
    double sum = 0;
    for (long z = -1; z <= 1; z++)
        for (long y = -1; y <= 1; y++)
            for (long x = -1; x <= 1; x++) {
                const double a = value_near(v, at, x, y, z),
                             b = value_near(v, at, x + by[0], y + by[1], z + by[2]);
                sum += is_gap(v, a) || is_gap(v, b) ? 2 * noise * noise : (a - b) * (a - b);
            }
    return sum / 27;
}

typedef struct nlm_case {
    double noise;
    long radius[3];
} nlm_case;

static double mean_of_alike(const cw_volume *v, const size_t at[3], const void *context)
{
    const nlm_case *c = context;
    const double middle = value_near(v, at, 0, 0, 0), h_sq = 0.36 * c->noise * c->noise;
    double sum = 0, weights = 0, best = 0;
    if (is_gap(v, middle))
        return (double)NAN;
    for (long z = -c->radius[2]; z <= c->radius[2]; z++)
        for (long y = -c->radius[1]; y <= c->radius[1]; y++)
            for (long x = -c->radius[0]; x <= c->radius[0]; x++) {
                const double value = value_near(v, at, x, y, z);
                if (is_gap(v, value) || (!x && !y && !z))
                    continue;
                const double rest =
                    compare_cubes(v, at, (long[]){x, y, z}, c->noise) - 2 * c->noise * c->noise;
                const double weight = exp(-fmax(rest, 0) / h_sq);
                sum += weight * value;
                weights += weight;
                best = fmax(best, weight);
            }
    return best > 0 ? (sum + best * middle) / (weights + best) : middle;
}

static void nlm_is_the_mean_of_what_looks_alike(void **state)
{
    (void)state;
    srand(test_seed(8));
    for (size_t n = 0; n < NOISE_TYPES * 2; n++) {
        /* 0.5 x 2 x 0.75 mm: as far along each axis, and at least one voxel */
        const nlm_case c = {.noise = n % 3 ? 40 : 15,
                            .radius = {n % 2 ? 3 : 2, 1, n % 2 ? 2 : 1}};
        cw_volume v = make_noise_volume(noise_types[n % NOISE_TYPES], (size_t[]){9, 5, 7},
                                        n % 3 == 0),
                  out;
        cw_error err = {0};
        assert_ok(cw_volume_nlm(&v, c.noise, n % 2 ? 0 : 2, NULL, &out, &err), err);
        assert_filtered(&v, &out, mean_of_alike, &c);
        cw_volume_free(&out);
        cw_volume_free(&v);
    }
}

/* --- noise ----------------------------------------------------------------------------- */

static double draw_normal(void)
{
    double sum = 0;
    for (int n = 0; n < 12; n++)
        sum += (double)rand() / (double)RAND_MAX;
    return sum - 6;
}

/* Slopes, an edge, a background without noise and missing values leave the estimate alone. */
static void noise_is_found_beside_edges(void **state)
{
    (void)state;
    srand(test_seed(11));
    for (size_t n = 0; n < NOISE_TYPES; n++) {
        const size_t dim[3] = {40, 40, 40};
        cw_volume v = make_noise_volume(noise_types[n], dim, n % 2 == 0);
        char *p = cw_volume_voxels(&v);
        double sigma;
        cw_error err = {0};
        v.slope = -0.5;
        for (size_t i = 0; i < 64000; i++, p += cw_type_size(v.type)) {
            const double x = (double)(i % 40);
            const bool gap = v.has_nodata && rand() % 9 == 0,
                       background = i < 40000 && v.type != CW_I8;
            cwi_voxel_put(v.type, p,
                          gap          ? 7
                          : background ? 20
                                       : rint(40 + x + (x > 20 ? 30 : 0) + 5 * draw_normal()));
        }
        assert_ok(cw_volume_noise(&v, 0, &sigma, &err), err);
        assert_true(sigma > 2.5 * 0.92 && sigma < 2.5 * 1.2);
        cw_volume_free(&v);
    }
}

static void without_noise_nothing_changes(void **state)
{
    (void)state;
    cw_volume v, out;
    cw_error err = {0};
    double sigma = 1;
    assert_ok(cw_volume_alloc(&v, CW_I16, (size_t[]){70, 20, 3}, 1, 1, &err), err);
    for (int i = 0; i < 70 * 20 * 3; i++)
        ((int16_t *)cw_volume_voxels(&v))[i] = 300;
    assert_ok(cw_volume_noise(&v, 1, &sigma, &err), err);
    assert_true(sigma == 0);
    for (int filter = 0; filter < 4; filter++) {
        cw_status st = filter == 0   ? cw_volume_aniso(&v, 5, 0, NULL, &out, &err)
                       : filter == 1 ? cw_volume_nlm(&v, 0, 0, NULL, &out, &err)
                       : filter == 2 ? cw_volume_nlm(&v, 7, 0, NULL, &out, &err)
                                     : cw_volume_aniso(&v, 5, 7, NULL, &out, &err);
        assert_ok(st, err);
        for (int i = 0; i < 70 * 20 * 3; i++)
            assert_true(((const float *)cw_volume_voxels(&out))[i] == 300.0f);
        cw_volume_free(&out);
    }
    cw_volume_free(&v);
}

/* --- all of them ----------------------------------------------------------------------- */

static cw_status run_filter(int filter, const cw_volume *v, const cw_filter_desc *d,
                            cw_volume *out, cw_error *err)
{
    const double one[3] = {1, 1, 0.5};
    return filter == 0   ? cw_volume_bilateral(v, one, 30, d, out, err)
           : filter == 1 ? cw_volume_nlm(v, 30, 1, d, out, err)
           : filter == 2 ? cw_volume_aniso(v, 3, 0, d, out, err)
                         : cw_volume_nlm(v, 0, 1, d, out, err);
}

static void results_do_not_depend_on_threads(void **state)
{
    (void)state;
    srand(test_seed(12));
    cw_volume v = make_noise_volume(CW_F32, (size_t[]){70, 35, 40}, true);
    for (int filter = 0; filter < 4; filter++) {
        cw_volume out[2];
        for (int n = 0; n < 2; n++) {
            const cw_filter_desc d = {.threads = n ? 5 : 1};
            cw_error err = {0};
            assert_ok(run_filter(filter, &v, &d, out + n, &err), err);
        }
        assert_memory_equal(out[0].data, out[1].data, (size_t)70 * 35 * 40 * sizeof(float));
        cw_volume_free(out);
        cw_volume_free(out + 1);
    }
    cw_volume_free(&v);
}

/* Refuses from the second report on, or from the first. */
static bool refuse_progress(void *user, const char *step, double share)
{
    size_t *calls = user;
    (void)step;
    (void)share;
    return calls && ++*calls == 1;
}

static void limits_are_kept(void **state)
{
    (void)state;
    cw_volume v = make_noise_volume(CW_U8, (size_t[]){9, 9, 9}, true), out;
    cw_error err = {0};
    for (int filter = 0; filter < 4; filter++) {
        const cw_filter_desc stopped = {.threads = 1, .progress = {.report = refuse_progress}},
                             small = {.max_bytes = 1000};
        assert_int_equal(run_filter(filter, &v, &stopped, &out, &err), CW_ERR_CANCELLED);
        assert_null(out.data);
        size_t calls = 0;
        const cw_filter_desc later = {.threads = 1, .progress = {refuse_progress, &calls}};
        if (filter == 2) { /* polls in each slice */
            assert_int_equal(run_filter(filter, &v, &later, &out, &err), CW_ERR_CANCELLED);
            assert_null(out.data);
        }
        assert_int_equal(run_filter(filter, &v, &small, &out, &err), CW_ERR_LIMIT);
        assert_null(out.data);
        long n = 0;
        for (; n < 20; n++) {
            const cw_filter_desc one = {.threads = 1};
            cwi_alloc_fail_after(n);
            const cw_status st = run_filter(filter, &v, &one, &out, &err);
            cwi_alloc_fail_after(-1);
            if (st == CW_OK)
                break;
            assert_int_equal(st, CW_ERR_NO_MEMORY);
            assert_null(out.data);
        }
        assert_true(n >= 2 && n < 20);
        cw_volume_free(&out);
    }
    cw_volume_free(&v);
}

static void bad_arguments_are_named(void **state)
{
    (void)state;
    cw_volume v = make_noise_volume(CW_U8, (size_t[]){9, 9, 9}, false), out;
    const double one[3] = {1, 1, 1}, nan = (double)NAN;
    double sigma;
    cw_error err = {0};
#define FAILS(call, words)                                                                     \
    do {                                                                                       \
        assert_fails(call, CW_ERR_ARGUMENT, words, err);                                       \
        assert_null(out.data);                                                                 \
    } while (0)
    FAILS(cw_volume_bilateral(&v, (double[]){1, -1, 1}, 1, NULL, &out, &err),
          "sigma_voxels[1]");
    FAILS(cw_volume_bilateral(&v, (double[]){1, 1, 4.5}, 1, NULL, &out, &err), "0 to 4");
    FAILS(cw_volume_bilateral(&v, one, -1, NULL, &out, &err), "sigma_value is -1; 0 or more");
    FAILS(cw_volume_bilateral(&v, one, nan, NULL, &out, &err), "sigma_value is");
    FAILS(cw_volume_aniso(&v, 0, 1, NULL, &out, &err), "steps is 0; 1 to 100");
    FAILS(cw_volume_aniso(&v, 101, 1, NULL, &out, &err), "steps is 101");
    FAILS(cw_volume_aniso(&v, 1, -1, NULL, &out, &err), "contrast is -1");
    FAILS(cw_volume_aniso(&v, 1, nan, NULL, &out, &err), "contrast is");
    FAILS(cw_volume_nlm(&v, -2, 1, NULL, &out, &err), "noise is -2");
    FAILS(cw_volume_nlm(&v, 1, 6, NULL, &out, &err), "radius is 6; 0 to 5");
    FAILS(cw_volume_nlm(NULL, 1, 1, NULL, &out, &err), "volume");
    assert_fails(cw_volume_noise(&v, 1, NULL, &err), CW_ERR_ARGUMENT, "sigma", err);
    const double x[] = {0, 1, 2, 3, 4, 5, 6, 7, 9};
    for (int a = 0; a < 3; a++)
        v.coordinates[a] = x;
    for (int filter = 0; filter < 4; filter++)
        assert_int_equal(run_filter(filter, &v, NULL, &out, &err), CW_ERR_UNSUPPORTED);
    assert_int_equal(cw_volume_noise(&v, 1, &sigma, &err), CW_ERR_UNSUPPORTED);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exponentials_are_close),
        cmocka_unit_test(bilateral_is_the_mean_of_similar_values),
        cmocka_unit_test(nlm_is_the_mean_of_what_looks_alike),
        cmocka_unit_test(noise_is_found_beside_edges),
        cmocka_unit_test(without_noise_nothing_changes),
        cmocka_unit_test(results_do_not_depend_on_threads),
        cmocka_unit_test(limits_are_kept),
        cmocka_unit_test(bad_arguments_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
