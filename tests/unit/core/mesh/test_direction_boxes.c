/* Boxes of directions hold the direction of every point of a triangle, and are not much larger. */
#include "support/support.h"

#include "core/geometry/vec3.h"
#include "core/mesh/wide_fans.h"

#include <math.h>
#include <stdlib.h>

enum { ROUNDS = 4000, POINTS = 60 };

static float between(double low, double high)
{
    return (float)(low + (high - low) * rand() / RAND_MAX);
}

static void set_point(float p[3], const float center[3], double size)
{
    for (int a = 0; a < 3; a++)
        p[a] = center[a] + between(-size, size);
}

/* Sets the box of the directions of random points of a triangle; corners count. */
static void sample_directions(const float hub[3], float corners[3][3], double box[6])
{
    for (int a = 0; a < 3; a++) {
        box[a] = 1;
        box[a + 3] = -1;
    }
    for (int n = 0; n < POINTS; n++) {
        double weight[3], d[3] = {0, 0, 0};
        const double s = sqrt(between(0, 1)), t = between(0, 1);
        weight[0] = n < 3 ? n == 0 : 1 - s;
        weight[1] = n < 3 ? n == 1 : s * (1 - t);
        weight[2] = n < 3 ? n == 2 : s * t;
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++)
                d[a] += weight[k] * ((double)corners[k][a] - (double)hub[a]);
        const double length = cwi_length(d);
        for (int a = 0; a < 3 && length > 1e-9; a++) {
            box[a] = fmin(box[a], d[a] / length);
            box[a + 3] = fmax(box[a + 3], d[a] / length);
        }
    }
}

static void check_triangle(const float hub[3], float corners[3][3], bool has_hub)
{
    const float *const at[3] = {corners[0], corners[1], corners[2]};
    float box[6];
    double sampled[6];
    cwi_direction_box(hub, at, has_hub, box);
    sample_directions(hub, corners, sampled);
    for (int a = 0; a < 3; a++) {
        assert_true((double)box[a] <= sampled[a]);
        assert_true((double)box[a + 3] >= sampled[a + 3]);
    }
}

static void boxes_hold_every_direction(void **state)
{
    (void)state;
    for (int round = 0; round < ROUNDS; round++) {
        const double sizes[4] = {0.01, 0.3, 1, 5};
        float hub[3] = {between(-1, 1), between(-1, 1), between(-1, 1)}, center[3];
        float corners[3][3];
        set_point(center, hub, round % 3 ? 1 : 20);
        for (int k = 0; k < 3; k++)
            set_point(corners[k], center, sizes[round % 4]);
        for (int a = 0; a < 3 && round % 5 == 0; a++)
            corners[round % 3][a] = hub[a];
        check_triangle(hub, corners, round % 5 == 0);
    }
}

/* Directions along axes: a coordinate is largest inside the triangle, or on a side of it. */
static void boxes_hold_the_axes(void **state)
{
    (void)state;
    const float hub[3] = {0, 0, 0};
    for (int a = 0; a < 6; a++) {
        const float high = a < 3 ? 2.f : -2.f;
        float around[3][3] = {{0}}, across[3][3] = {{0}}, box[6];
        for (int k = 0; k < 3; k++) {
            around[k][a % 3] = across[k][a % 3] = high;
            around[k][(a + 1) % 3] = cosf(2.1f * (float)k);
            around[k][(a + 2) % 3] = sinf(2.1f * (float)k);
            across[k][(a + 1) % 3] = (float)k - 1;
        }
        across[1][(a + 2) % 3] = 1;
        check_triangle(hub, around, false);
        check_triangle(hub, across, false);
        const float *const at[3] = {around[0], around[1], around[2]};
        cwi_direction_box(hub, at, false, box);
        assert_true(a < 3 ? box[a + 3] >= 1 : box[a - 3] <= -1);
        assert_true(a < 3 ? box[a] > 0.8f : box[a] < -0.8f);
    }
}

/* Needles side by side around a hub, seen from it: few boxes share a point. */
static void boxes_of_needles_are_thin(void **state)
{
    (void)state;
    const float hub[3] = {3, 4, 5};
    float boxes[1000][6];
    size_t meeting = 0;
    for (size_t n = 0; n < 1000; n++) {
        float corners[3][3];
        for (size_t k = 0; k < 3; k++) {
            const double angle = 6.283185307 * (double)(n + k) / 1000;
            corners[k][0] = k == 2 ? hub[0] : 3 + 40 * (float)cos(angle);
            corners[k][1] = k == 2 ? hub[1] : 4 + 40 * (float)sin(angle);
            corners[k][2] = k == 2 ? hub[2] : 1;
        }
        const float *const at[3] = {corners[0], corners[1], corners[2]};
        cwi_direction_box(hub, at, true, boxes[n]);
    }
    for (size_t n = 0; n < 1000; n++)
        for (size_t m = 0; m < n; m++) {
            bool meet = true;
            for (int a = 0; a < 3; a++)
                meet &= boxes[n][a] <= boxes[m][a + 3] && boxes[m][a] <= boxes[n][a + 3];
            meeting += meet;
        }
    assert_in_range(meeting, 1000, 1010);
}

/* Another vertex in the place of the hub touches all that is around it. */
static void a_vertex_in_the_same_place_sees_all(void **state)
{
    (void)state;
    const float hub[3] = {1, 1, 1}, far[3] = {2, 1, 1}, aside[3] = {2, 2, 1};
    const float *const at[3] = {hub, far, aside};
    float box[6];
    cwi_direction_box(hub, at, false, box);
    for (int a = 0; a < 3; a++)
        assert_true(box[a] == -1 && box[a + 3] == 1);
    cwi_direction_box(hub, at, true, box);
    assert_true(box[0] > 0.7f && box[5] < 0.01f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_hold_every_direction),
        cmocka_unit_test(boxes_hold_the_axes),
        cmocka_unit_test(boxes_of_needles_are_thin),
        cmocka_unit_test(a_vertex_in_the_same_place_sees_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
