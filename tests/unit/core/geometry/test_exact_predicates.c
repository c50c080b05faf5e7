/* Exact predicates: signs of determinants that doubles alone would get wrong. */
#include "core/geometry/exact_predicates.h"
#include "support/support.h"

#include <math.h>
#include <stdlib.h>

static uint32_t next_number(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

static int sign_of(long long x)
{
    return (x > 0) - (x < 0);
}

/* Whole numbers up to 2^20 have exact determinants in 64 bits; adding one far away point's
 * multiples makes near ties. */
static void signs_are_exact(void **state)
{
    (void)state;
    uint32_t seed = 1;
    size_t ties = 0;
    for (int round = 0; round < 200000; round++) {
        long long p[4][3], u[3][3];
        float f[4][3];
        const uint32_t range = round % 2 ? 1u << 20 : 4;
        for (int n = 0; n < 4; n++)
            for (int a = 0; a < 3; a++)
                p[n][a] = next_number(&seed) % range;
        if (round % 4 == 1) /* nearly in the plane of the others */
            for (int a = 0; a < 3; a++)
                p[3][a] = (p[1][a] + p[2][a]) / 2 + next_number(&seed) % 2;
        for (int n = 0; n < 4; n++)
            for (int a = 0; a < 3; a++) {
                f[n][a] = (float)p[n][a];
                if (n)
                    u[n - 1][a] = p[n][a] - p[0][a];
            }
        const long long det = u[0][0] * (u[1][1] * u[2][2] - u[1][2] * u[2][1]) +
                              u[0][1] * (u[1][2] * u[2][0] - u[1][0] * u[2][2]) +
                              u[0][2] * (u[1][0] * u[2][1] - u[1][1] * u[2][0]);
        ties += det == 0;
        assert_int_equal(cwi_orient3d(f[0], f[1], f[2], f[3]), sign_of(det));
        assert_int_equal(cwi_orient3d(f[1], f[0], f[2], f[3]), -sign_of(det));
        assert_int_equal(cwi_orient2d(f[0], f[1], f[2], 2),
                         sign_of(u[0][0] * u[1][1] - u[0][1] * u[1][0]));
        assert_int_equal(cwi_orient2d(f[0], f[1], f[2], 0),
                         sign_of(u[0][1] * u[1][2] - u[0][2] * u[1][1]));
        assert_int_equal(cwi_orient2d(f[0], f[1], f[2], 1),
                         sign_of(u[0][2] * u[1][0] - u[0][0] * u[1][2]));
    }
    assert_true(ties > 1000);
}

/* Where doubles lose all of it: a step of the smallest float beside the largest ones. */
static void signs_are_exact_at_the_limits(void **state)
{
    (void)state;
    const float tiny = 1e-45f, huge = 3e38f;
    const float a[3] = {0, 0, 0}, b[3] = {huge, huge, 0}, c[3] = {-huge, -huge, tiny};
    const float d[3] = {huge, huge, tiny}, e[3] = {huge, 0, 0};
    assert_int_equal(cwi_orient3d(a, b, c, d), 0);
    assert_int_equal(cwi_orient3d(a, b, e, c), -1);
    assert_int_equal(cwi_orient3d(a, e, b, c), 1);
    assert_int_equal(cwi_seen_along(a, b, c), 0);
    assert_int_equal(cwi_seen_along(a, a, b), -1);
    const float f[3] = {tiny, 0, 0}, g[3] = {0, tiny, 0}, h[3] = {0, 0, tiny};
    assert_int_equal(cwi_orient3d(a, f, g, h), 1);
}

/* Adds multiples of rows to other rows, which leaves the determinant as it is, while numbers stay below
 * 2^20. */
static void shear_rows(long long u[3][3], int rows, uint32_t *seed)
{
    for (int turn = 0; turn < 60; turn++) {
        const int i = (int)next_number(seed) % rows,
                  j = (i + 1 + (int)next_number(seed) % (rows - 1)) % rows;
        const long long times = (long long)(next_number(seed) % 7) - 3;
        bool fits = true;
        for (int a = 0; a < rows; a++)
            fits = fits && llabs(u[i][a] + times * u[j][a]) < 1 << 20;
        for (int a = 0; a < rows && fits; a++)
            u[i][a] += times * u[j][a];
    }
}

/* Adds three directions to a point, and multiplies each axis by a power of two of its own. With
 * powers that differ much, coordinates are no whole numbers of one unit. */
static void place_points(long long u[3][3], int power, uint32_t *seed, float f[4][3])
{
    const uint32_t turn = next_number(seed);
    for (uint32_t a = 0; a < 3; a++) {
        const long long start = next_number(seed) % (1 << 20);
        const int exponent = power * ((int)((a + turn) % 3) - 1);
        f[0][a] = ldexpf((float)start, exponent);
        for (int n = 0; n < 3; n++)
            f[n + 1][a] = ldexpf((float)(start + u[n][a]), exponent);
    }
}

/* Sheared unit cells, flat ones and mirrored ones: determinants of 1, 0 and -1, whose terms have up to
 * 60 bits. */
static void sheared_cells_keep_their_sign(void **state)
{
    (void)state;
    uint32_t seed = 1;
    for (int round = 0; round < 3000; round++) {
        const int side = round % 3 - 1, power = 15 * (round / 3 % 3), axis = round / 9 % 3;
        long long u[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, side}};
        float f[4][3];
        shear_rows(u, 3, &seed);
        place_points(u, power, &seed, f);
        assert_int_equal(cwi_orient3d(f[0], f[1], f[2], f[3]), side);
        assert_int_equal(cwi_orient3d(f[1], f[0], f[2], f[3]), -side);
        assert_int_equal(cwi_orient3d(f[2], f[3], f[0], f[1]), side);

        long long v[3][3] = {{1, 0, 0}, {0, side, 0}}, turned[3][3] = {{0}};
        shear_rows(v, 2, &seed);
        for (int n = 0; n < 2; n++)
            for (int a = 0; a < 2; a++)
                turned[n][(axis + 1 + a) % 3] = v[n][a];
        place_points(turned, power, &seed, f);
        assert_int_equal(cwi_orient2d(f[0], f[1], f[2], axis), side);
        assert_int_equal(cwi_orient2d(f[2], f[0], f[1], axis), side);
        assert_int_equal(cwi_orient2d(f[1], f[0], f[2], axis), -side);
        assert_int_equal(cwi_seen_along(f[0], f[1], f[2]), side == 0 ? -1 : axis);
    }
}

/* Points on a line through zero, some 2^60 times as far as others: doubles round their differences.
 * Then one of them moves by its last digit. */
static void points_far_from_each_other_keep_their_line(void **state)
{
    (void)state;
    uint32_t seed = 1;
    for (int round = 0; round < 3000; round++) {
        const int axis = round % 3, x = (axis + 1) % 3, y = (axis + 2) % 3;
        const float along[2] = {(float)(1 + next_number(&seed)),
                                (float)(1 + next_number(&seed))};
        float p[3][3] = {{0}};
        for (int n = 0; n < 3; n++) {
            const int exponent = (int)(next_number(&seed) % 61) - 30;
            p[n][x] = ldexpf(along[0], exponent);
            p[n][y] = ldexpf(along[1], exponent);
        }
        assert_int_equal(cwi_orient2d(p[0], p[1], p[2], axis), 0);
        assert_int_equal(cwi_seen_along(p[0], p[1], p[2]), -1);
        const int side = (p[1][x] > p[0][x]) - (p[1][x] < p[0][x]);
        p[2][y] = nextafterf(p[2][y], INFINITY);
        assert_int_equal(cwi_orient2d(p[0], p[1], p[2], axis), side);
        assert_int_equal(cwi_orient2d(p[1], p[0], p[2], axis), -side);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(signs_are_exact),
        cmocka_unit_test(signs_are_exact_at_the_limits),
        cmocka_unit_test(sheared_cells_keep_their_sign),
        cmocka_unit_test(points_far_from_each_other_keep_their_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
