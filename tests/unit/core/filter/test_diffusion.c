/* Diffusion along edges, held against steps of a whole volume one by one. */
#include "support/noise_volume.h"
#include "support/support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_VOXELS = 9 * 6 * 8 };

/* Numbers of a whole volume, on which steps are made one by one. */
typedef struct field {
    size_t dim[3];
    double per_voxel[3], u[MOST_VOXELS], smooth[MOST_VOXELS];
} field;

static size_t place_near(const field *f, const size_t at[3], const long by[3])
{
    size_t p[3];
    for (int a = 0; a < 3; a++)
        p[a] = clamp_index((long)at[a] + by[a], f->dim[a]);
    return (p[2] * f->dim[1] + p[1]) * f->dim[0] + p[0];
}

static void smooth_axis(const field *f, int axis, double *u)
{
    double from[MOST_VOXELS];
    memcpy(from, u, sizeof from);
    for (size_t n = 0; n < f->dim[0] * f->dim[1] * f->dim[2]; n++) {
        const size_t at[3] = {n % f->dim[0], n / f->dim[0] % f->dim[1],
                              n / f->dim[0] / f->dim[1]};
        for (long side = -1; side <= 1; side += 2) {
            long by[3] = {0, 0, 0};
            by[axis] = side;
            const double other = from[place_near(f, at, by)];
            u[n] += isnan(other) ? 0 : (other - from[n]) / 4;
        }
    }
}

/* The gradient at the face between a voxel and the next along an axis. */
static void find_gradient(const field *f, const double *u, const size_t at[3], int axis,
                          double g[3])
{
    for (int a = 0; a < 3; a++) {
        long low[4][3] = {{0}}; /* of the two voxels: before and behind */
        g[a] = 0;
        for (int n = 0; n < 4; n++) {
            low[n][axis] = n / 2;
            low[n][a] += n % 2 ? 1 : -1;
        }
        for (int n = 0; n < 4 && a != axis; n += 2) {
            const double d = u[place_near(f, at, low[n + 1])] - u[place_near(f, at, low[n])];
            g[a] += isnan(d) ? 0 : d / 4;
        }
        if (a == axis) {
            long next[3] = {0};
            next[axis] = 1;
            g[a] = u[place_near(f, at, next)] - u[place_near(f, at, (long[]){0, 0, 0})];
        }
        g[a] *= f->per_voxel[a];
    }
}

static double find_face_flow(const field *f, const size_t at[3], int axis)
{
    double g[3], s[3], dot = 0, steep_sq = 0;
    if (at[axis] + 1 >= f->dim[axis])
        return 0;
    find_gradient(f, f->u, at, axis, g);
    find_gradient(f, f->smooth, at, axis, s);
    for (int a = 0; a < 3; a++) {
        dot += g[a] * s[a];
        steep_sq += s[a] * s[a];
    }
    if (isnan(g[axis]))
        return 0;
    const double kept = steep_sq > 0 ? (1 - exp(-steep_sq)) / steep_sq : 0;
    return f->per_voxel[axis] * (g[axis] - kept * dot * s[axis]);
}

static void make_step(field *f)
{
    double made[MOST_VOXELS], sum = 0;
    memcpy(f->smooth, f->u, sizeof f->smooth);
    for (int a = 2; a >= 0; a--)
        smooth_axis(f, a, f->smooth);
    for (int a = 0; a < 3; a++)
        sum += f->dim[a] > 1 ? f->per_voxel[a] * f->per_voxel[a] : 0;
    for (size_t n = 0; n < f->dim[0] * f->dim[1] * f->dim[2]; n++) {
        const size_t at[3] = {n % f->dim[0], n / f->dim[0] % f->dim[1],
                              n / f->dim[0] / f->dim[1]};
        double change = 0;
        for (int a = 0; a < 3; a++) {
            size_t before[3] = {at[0], at[1], at[2]};
            change += find_face_flow(f, at, a);
            before[a]--;
            change -= at[a] ? find_face_flow(f, before, a) : 0;
        }
        made[n] = f->u[n] + change / (1 + 2 * sum);
    }
    memcpy(f->u, made, sizeof made);
}

static double diffused_at(const cw_volume *in, const size_t at[3], const void *context)
{
    const field *f = context;
    (void)in;
    return f->u[place_near(f, at, (long[]){0, 0, 0})];
}

static void diffusion_is_that_of_single_steps(void **state)
{
    (void)state;
    static const size_t dims[][3] = {{9, 6, 8}, {9, 1, 7}, {1, 1, 6}, {5, 6, 1}};
    srand(test_seed(9));
    for (size_t n = 0; n < NOISE_TYPES * 2; n++) {
        const size_t steps = 1 + n % 6, *dim = dims[n % 4];
        const double contrast = n % 3 ? 20 : 300;
        cw_volume v = make_noise_volume(noise_types[n % NOISE_TYPES], dim, n % 3 == 0), out;
        cw_error err = {0};
        field f = {.dim = {dim[0], dim[1], dim[2]},
                   .per_voxel = {dim[0] > 1 ? 1 : 0, dim[0] > 1 ? 0.25 : 0, 1}};
        f.per_voxel[2] = dim[0] > 1 ? 0.5 / 0.75 : 1;
        for (size_t i = 0; i < dim[0] * dim[1] * dim[2]; i++) {
            const double x =
                stored_at(&v, i % dim[0], i / dim[0] % dim[1], i / dim[0] / dim[1]);
            f.u[i] = is_gap(&v, x) ? (double)NAN : x / contrast;
        }
        for (size_t step = 0; step < steps; step++)
            make_step(&f);
        for (size_t i = 0; i < dim[0] * dim[1] * dim[2]; i++)
            f.u[i] *= contrast;
        assert_ok(cw_volume_aniso(&v, steps, contrast, NULL, &out, &err), err);
        assert_filtered(&v, &out, diffused_at, &f);
        cw_volume_free(&out);
        cw_volume_free(&v);
    }
}

/* Chunks of slices that threads take make no difference, and steps never leave the range much. */
static void long_diffusion_is_stable(void **state)
{
    (void)state;
    srand(test_seed(10));
    cw_volume v = make_noise_volume(CW_F32, (size_t[]){12, 9, 90}, true), out[2];
    for (int n = 0; n < 2; n++) {
        const cw_filter_desc d = {.threads = n ? 7 : 1};
        cw_error err = {0};
        assert_ok(cw_volume_aniso(&v, 100, 25, &d, out + n, &err), err);
    }
    const size_t count = (size_t)12 * 9 * 90;
    assert_memory_equal(out[0].data, out[1].data, count * sizeof(float));
    for (size_t i = 0; i < count; i++) {
        const double x = (double)((const float *)out[0].data)[i];
        assert_true(is_gap(&v, x) || (x > -1 && x < 121));
    }
    cw_volume_free(out);
    cw_volume_free(out + 1);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(diffusion_is_that_of_single_steps),
        cmocka_unit_test(long_diffusion_is_stable),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
