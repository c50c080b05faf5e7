/* Filters of volumes, held against sums and sorts over whole cubes of voxels. */
#include "support/noise_volume.h"
#include "support/support.h"

#include "core/volume/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- Gaussian -------------------------------------------------------------------------- */

/* Returns the weighted mean over all voxels within reach, or NaN. */
static double mean_around(const cw_volume *v, const size_t at[3], const double sigma[3])
{
    double sum = 0, weights = 0;
    long reach[3];
    for (int a = 0; a < 3; a++)
        reach[a] = (long)ceil(4 * sigma[a]);
    for (long z = -reach[2]; z <= reach[2]; z++)
        for (long y = -reach[1]; y <= reach[1]; y++)
            for (long x = -reach[0]; x <= reach[0]; x++) {
                const long by[3] = {x, y, z};
                double exponent = 0;
                size_t p[3];
                for (int a = 0; a < 3; a++) {
                    const double t = sigma[a] > 0 ? (double)by[a] / sigma[a] : 0;
                    p[a] = clamp_index((long)at[a] + by[a], v->dim[a]);
                    exponent += t * t / 2;
                }
                const double value = stored_at(v, p[0], p[1], p[2]), w = exp(-exponent);
                if (is_gap(v, value))
                    continue;
                sum += w * value;
                weights += w;
            }
    return is_gap(v, stored_at(v, at[0], at[1], at[2])) ? (double)NAN : sum / weights;
}

static void assert_smoothed(const cw_volume *v, const cw_volume *out, const double sigma[3])
{
    for (size_t k = 0; k < v->dim[2]; k++)
        for (size_t j = 0; j < v->dim[1]; j++)
            for (size_t i = 0; i < v->dim[0]; i++) {
                const double expected = mean_around(v, (size_t[]){i, j, k}, sigma),
                             got = stored_at(out, i, j, k);
                if (isnan(expected))
                    assert_true(is_gap(out, got));
                else
                    assert_true(fabs(got - expected) <= 1e-4);
                assert_true(isnan(expected) || !is_gap(out, got));
            }
}

static void gauss_is_the_mean_around(void **state)
{
    (void)state;
    const double sigmas[][3] = {{0.7, 0.7, 0.7}, {0, 1.3, 0.4}, {0, 0, 0}, {2, 0, 5}};
    srand(test_seed(3));
    for (size_t n = 0; n < NOISE_TYPES * 4; n++) {
        const double *sigma = sigmas[(n / 2) % 4];
        cw_volume v = make_noise_volume(noise_types[n % NOISE_TYPES], (size_t[]){7, 5, 6},
                                        n % 3 == 0),
                  out;
        cw_error err = {0};
        assert_ok(cw_volume_gauss(&v, sigma, NULL, &out, &err), err);
        assert_int_equal(out.type, cw_filter_type(&v));
        assert_memory_equal(out.affine, v.affine, sizeof v.affine);
        assert_smoothed(&v, &out, sigma);
        cw_volume_free(&out);
        cw_volume_free(&v);
    }
}

/* --- median ---------------------------------------------------------------------------- */

static int compare_numbers(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median_around(const cw_volume *v, const size_t at[3], long radius)
{
    double values[343];
    size_t count = 0;
    for (long z = -radius; z <= radius; z++)
        for (long y = -radius; y <= radius; y++)
            for (long x = -radius; x <= radius; x++) {
                const double value = stored_at(v, clamp_index((long)at[0] + x, v->dim[0]),
                                               clamp_index((long)at[1] + y, v->dim[1]),
                                               clamp_index((long)at[2] + z, v->dim[2]));
                if (!is_gap(v, value))
                    values[count++] = value;
            }
    qsort(values, count, sizeof *values, compare_numbers);
    return values[(count - 1) / 2];
}

static void median_is_in_the_middle(void **state)
{
    (void)state;
    srand(test_seed(4));
    for (size_t n = 0; n < 3 * NOISE_TYPES; n++) {
        const size_t radius = 1 + n / NOISE_TYPES;
        cw_volume v = make_noise_volume(noise_types[n % NOISE_TYPES], (size_t[]){19, 4, 5},
                                        n % 2 == 1),
                  out;
        cw_error err = {0};
        assert_ok(cw_volume_median(&v, radius, NULL, &out, &err), err);
        for (size_t k = 0; k < v.dim[2]; k++)
            for (size_t j = 0; j < v.dim[1]; j++)
                for (size_t i = 0; i < v.dim[0]; i++) {
                    const double got = stored_at(&out, i, j, k);
                    if (is_gap(&v, stored_at(&v, i, j, k)))
                        assert_true(is_gap(&out, got));
                    else
                        assert_true(got ==
                                    median_around(&v, (size_t[]){i, j, k}, (long)radius));
                }
        cw_volume_free(&out);
        cw_volume_free(&v);
    }
}

/* --- resampling ------------------------------------------------------------------------ */

/* A field that is linear in the world, with scaled integers or floats. */
static cw_volume make_slope(cw_type type, const size_t dim[3])
{
    cw_volume v = make_noise_volume(type, dim, false);
    char *p = cw_volume_voxels(&v);
    v.slope = 0.001;
    for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n++, p += cw_type_size(type)) {
        const size_t i = n % dim[0], j = n / dim[0] % dim[1], k = n / dim[0] / dim[1];
        cwi_voxel_put(type, p, 1000.0 * (double)(3 * i + 5 * j + 2 * k));
    }
    return v;
}

static void slopes_stay_what_they_are(void **state)
{
    (void)state;
    const double spacings[][3] = {{0.5, 2, 0.75}, {0.2, 2.7, 0}, {1.7, 0.3, 0.9}, {9, 40, 10}};
    for (int kernel = 0; kernel < CW_KERNEL_COUNT; kernel++)
        for (size_t n = 0; n < 4; n++) {
            cw_volume v = make_slope(CW_I32, (size_t[]){20, 23, 21}), out;
            cw_error err = {0};
            assert_ok(cw_volume_resample(&v, spacings[n], (cw_kernel)kernel, NULL, &out, &err),
                      err);
            for (int a = 0; a < 3; a++) {
                const double old = (double)(v.dim[a] - 1) * v.affine[a][a],
                             made = (double)(out.dim[a] - 1) * out.affine[a][a];
                assert_true(made <= old + 1e-9 && made > old - out.affine[a][a]);
                assert_true(out.affine[a][3] == v.affine[a][3]);
                assert_true(spacings[n][a] == 0 ||
                            fabs(out.affine[a][a] - spacings[n][a]) < 1e-12);
            }
            const size_t reach =
                3 + (size_t)(3 * 3.4); /* from the border, where values go on */
            for (size_t k = 0; k < out.dim[2]; k++)
                for (size_t j = 0; j < out.dim[1]; j++)
                    for (size_t i = 0; i < out.dim[0]; i++) {
                        double at[3] = {(double)i, (double)j, (double)k}, sum = 0;
                        bool inner = true;
                        for (int a = 0; a < 3; a++) {
                            at[a] *= out.affine[a][a] / v.affine[a][a];
                            inner = inner && at[a] >= (double)reach - 3 &&
                                    at[a] <= (double)(v.dim[a] - 1 - reach + 3);
                        }
                        sum = 3 * at[0] + 5 * at[1] + 2 * at[2];
                        if (inner) /* Lanczos' kernel is exact at samples only */
                            assert_true(fabs(stored_at(&out, i, j, k) * 0.001 - sum) <
                                        (kernel == CW_KERNEL_LANCZOS ? 0.2 : 0.06));
                    }
            cw_volume_free(&out);
            cw_volume_free(&v);
        }
}

static void the_same_spacing_is_the_same_volume(void **state)
{
    (void)state;
    srand(test_seed(5));
    for (int kernel = 0; kernel < CW_KERNEL_COUNT; kernel++)
        for (size_t n = 0; n < NOISE_TYPES; n++) {
            cw_volume v = make_noise_volume(noise_types[n], (size_t[]){6, 7, 1}, true), out;
            const double same[3] = {0.5, 0, 0.75};
            cw_error err = {0};
            assert_ok(cw_volume_resample(&v, same, (cw_kernel)kernel, NULL, &out, &err), err);
            assert_memory_equal(out.dim, v.dim, sizeof v.dim);
            for (size_t j = 0; j < 7; j++)
                for (size_t i = 0; i < 6; i++) {
                    const double a = stored_at(&v, i, j, 0), b = stored_at(&out, i, j, 0);
                    assert_true(is_gap(&v, a) ? is_gap(&out, b) : fabs(a - b) < 1e-5);
                }
            cw_volume_free(&out);
            cw_volume_free(&v);
        }
}

/* Details finer than the new voxels fade: stripes of one voxel become their mean. */
static void stripes_fade(void **state)
{
    (void)state;
    for (int kernel = 0; kernel < CW_KERNEL_COUNT; kernel++) {
        cw_volume v, out;
        cw_error err = {0};
        assert_ok(cw_volume_alloc(&v, CW_F32, (size_t[]){64, 1, 1}, 1, 1, &err), err);
        for (int i = 0; i < 64; i++)
            ((float *)cw_volume_voxels(&v))[i] = i % 2 ? 10 : -10;
        const double spacing[3] = {4, 0, 0};
        assert_ok(cw_volume_resample(&v, spacing, (cw_kernel)kernel, NULL, &out, &err), err);
        assert_int_equal(out.dim[0], 16);
        for (size_t i = 4; i < 12; i++)
            assert_true(fabs(stored_at(&out, i, 0, 0)) < 0.3);
        cw_volume_free(&out);
        cw_volume_free(&v);
    }
}

/* Distances that leave a single sample, or more than fit, are refused before any work. */
static void senseless_distances_are_refused(void **state)
{
    (void)state;
    cw_volume v = make_noise_volume(CW_U8, (size_t[]){5, 3, 4}, false), out;
    const cw_filter_desc desc = {.max_bytes = 1 << 20};
    cw_error err = {0};
    double mm[3];
    cw_volume_spacing(&v, mm);
    const double far[] = {4.5 * mm[0], 1e9, 1e20, 1e300};
    for (size_t n = 0; n < sizeof far / sizeof *far; n++) {
        const double spacing[3] = {far[n], 0, 0};
        assert_fails(cw_volume_resample(&v, spacing, CW_KERNEL_LANCZOS, &desc, &out, &err),
                     CW_ERR_ARGUMENT, "at least two samples", err);
        assert_null(out.data);
    }
    const double fine[3] = {1e-7 * mm[0], 1e-7 * mm[1], 1e-7 * mm[2]},
                 end[3] = {4 * mm[0], 0, 0};
    assert_fails(cw_volume_resample(&v, fine, CW_KERNEL_CUBIC, &desc, &out, &err), CW_ERR_LIMIT,
                 "exceed the limit of 1048576 bytes", err);
    assert_ok(cw_volume_resample(&v, end, CW_KERNEL_LINEAR, &desc, &out, &err), err);
    assert_int_equal(out.dim[0], 2);
    cw_volume_free(&out);
    cw_volume_free(&v);
}

static void rectilinear_grids_become_even(void **state)
{
    (void)state;
    cw_volume v = make_noise_volume(CW_F64, (size_t[]){5, 3, 4}, false), out;
    const double x[] = {0, 1, 3, 3.5, 6}, y[] = {-1, 0, 2}, z[] = {2, 3, 4, 9};
    double *p = cw_volume_voxels(&v);
    cw_error err = {0};
    v.coordinates[0] = x;
    v.coordinates[1] = y;
    v.coordinates[2] = z;
    for (size_t n = 0; n < 60; n++)
        p[n] = 2 * x[n % 5] - 7 * y[n / 5 % 3] + z[n / 15];
    const double spacing[3] = {0.25, 1, 0.5}; /* of axes of 0.5, 2 and 0.75 mm a unit */
    assert_ok(cw_volume_resample(&v, spacing, CW_KERNEL_LINEAR, NULL, &out, &err), err);
    assert_null(out.coordinates[0]);
    assert_memory_equal(out.dim, ((size_t[]){13, 7, 11}), sizeof out.dim);
    for (size_t k = 0; k < 11; k++)
        for (size_t j = 0; j < 7; j++)
            for (size_t i = 0; i < 13; i++) {
                const double at[3] = {0.5 * (double)i, -1 + 0.5 * (double)j,
                                      2 + (double)k * 0.5 / 0.75};
                assert_true(fabs(out.affine[2][3] - (v.affine[2][3] + 1.5)) < 1e-12);
                assert_true(fabs(stored_at(&out, i, j, k) - (2 * at[0] - 7 * at[1] + at[2])) <
                            1e-9);
            }
    cw_volume_free(&out);
    assert_int_equal(cw_volume_resample(&v, spacing, CW_KERNEL_CUBIC, NULL, &out, &err),
                     CW_ERR_UNSUPPORTED);
    assert_int_equal(cw_volume_gauss(&v, spacing, NULL, &out, &err), CW_ERR_UNSUPPORTED);
    assert_int_equal(cw_volume_median(&v, 1, NULL, &out, &err), CW_ERR_UNSUPPORTED);
    cw_volume_free(&v);
}

/* --- all of them ----------------------------------------------------------------------- */

static void results_do_not_depend_on_threads(void **state)
{
    (void)state;
    srand(test_seed(6));
    cw_volume v = make_noise_volume(CW_F32, (size_t[]){40, 30, 70}, true);
    for (int filter = 0; filter < 3; filter++) {
        cw_volume out[2];
        for (int n = 0; n < 2; n++) {
            const cw_filter_desc d = {.threads = n ? 5 : 1};
            const double three[3] = {0.9, 1.1, 0.3};
            cw_error err = {0};
            cw_status st = filter == 0   ? cw_volume_gauss(&v, three, &d, out + n, &err)
                           : filter == 1 ? cw_volume_median(&v, 1, &d, out + n, &err)
                                         : cw_volume_resample(&v, three, CW_KERNEL_LANCZOS, &d,
                                                              out + n, &err);
            assert_ok(st, err);
        }
        assert_memory_equal(out[0].dim, out[1].dim, sizeof out[0].dim);
        assert_memory_equal(out[0].data, out[1].data,
                            out[0].dim[0] * out[0].dim[1] * out[0].dim[2] * sizeof(float));
        cw_volume_free(out);
        cw_volume_free(out + 1);
    }
    cw_volume_free(&v);
}

static bool refuse_progress(void *user, const char *step, double share)
{
    (void)user;
    (void)step;
    (void)share;
    return false;
}

static void bad_arguments_are_named(void **state)
{
    (void)state;
    cw_volume v = make_noise_volume(CW_U8, (size_t[]){9, 9, 9}, false), out;
    const double one[3] = {1, 1, 1};
    cw_error err = {0};
#define FAILS(call, status, words)                                                             \
    do {                                                                                       \
        assert_int_equal(call, status);                                                        \
        assert_non_null(strstr(err.message, words));                                           \
        assert_null(out.data);                                                                 \
    } while (0)
    FAILS(cw_volume_gauss(&v, (double[]){1, -1, 1}, NULL, &out, &err), CW_ERR_ARGUMENT,
          "sigma_voxels[1] is -1");
    FAILS(cw_volume_gauss(&v, (double[]){1, 1, (double)NAN}, NULL, &out, &err), CW_ERR_ARGUMENT,
          "sigma_voxels[2]");
    FAILS(cw_volume_median(&v, 0, NULL, &out, &err), CW_ERR_ARGUMENT, "radius is 0");
    FAILS(cw_volume_median(&v, 4, NULL, &out, &err), CW_ERR_ARGUMENT, "radius is 4");
    FAILS(cw_volume_resample(&v, (double[]){1, 1, -2}, CW_KERNEL_LINEAR, NULL, &out, &err),
          CW_ERR_ARGUMENT, "spacing_mm[2] is -2");
    FAILS(cw_volume_resample(&v, (double[]){1e-12, 1, 1}, CW_KERNEL_LINEAR, NULL, &out, &err),
          CW_ERR_LIMIT, "spacing_mm[0]");
    FAILS(cw_volume_resample(&v, one, (cw_kernel)9, NULL, &out, &err), CW_ERR_ARGUMENT,
          "kernel is 9");
    FAILS(cw_volume_median(&v, 1, &(cw_filter_desc){.max_bytes = 100}, &out, &err),
          CW_ERR_LIMIT, "100 bytes");
    FAILS(cw_volume_gauss(&v, one, &(cw_filter_desc){.max_bytes = 1000}, &out, &err),
          CW_ERR_LIMIT, "1000 bytes");
    const cw_filter_desc stopped = {.progress = {.report = refuse_progress}};
    assert_int_equal(cw_volume_gauss(&v, one, &stopped, &out, &err), CW_ERR_CANCELLED);
    assert_null(out.data);
    assert_int_equal(cw_volume_median(&v, 1, &stopped, &out, &err), CW_ERR_CANCELLED);
    assert_null(out.data);
    assert_int_equal(cw_volume_gauss(NULL, one, NULL, &out, &err), CW_ERR_ARGUMENT);
    assert_null(cw_kernel_name(CW_KERNEL_COUNT));
    assert_string_equal(cw_kernel_name(CW_KERNEL_LANCZOS), "lanczos");
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gauss_is_the_mean_around),
        cmocka_unit_test(median_is_in_the_middle),
        cmocka_unit_test(slopes_stay_what_they_are),
        cmocka_unit_test(the_same_spacing_is_the_same_volume),
        cmocka_unit_test(stripes_fade),
        cmocka_unit_test(senseless_distances_are_refused),
        cmocka_unit_test(rectilinear_grids_become_even),
        cmocka_unit_test(results_do_not_depend_on_threads),
        cmocka_unit_test(bad_arguments_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
