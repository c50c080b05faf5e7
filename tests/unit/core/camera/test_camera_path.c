/* Tests paths of cameras: through their keys, smooth, without overshoot, and wrong arguments. */
#include "support/support.h"

#include "core/geometry/monotone_curve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double distance(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* Cameras around a target, at rising times, nearer and nearer. */
static void make_keys(cw_camera *keys, double *times, size_t count, double scale)
{
    cw_error err = {0};
    for (size_t n = 0; n < count; n++) {
        keys[n] = (cw_camera){.eye = {0, -100 * scale / (1.0 + (double)n), 10 * scale},
                              .target = {(double)n * scale, 0, 0},
                              .up = {0, 0, 1},
                              .fov_deg = 30};
        assert_ok(cw_camera_orbit(&keys[n], 50 * (double)n, 10, &err), err);
        times[n] = (double)(n * n) + 1;
    }
}

static cw_camera camera_at(const cw_camera *keys, const double *times, size_t count,
                           double time)
{
    cw_camera c = {0};
    cw_error err = {0};
    assert_ok(cw_camera_path(keys, times, count, time, &c, &err), err);
    return c;
}

static void a_path_goes_through_its_keys(void **state)
{
    enum { COUNT = 5 };
    (void)state;
    cw_camera keys[COUNT];
    double times[COUNT];
    make_keys(keys, times, COUNT, 1);
    for (size_t n = 0; n < COUNT; n++) {
        const cw_camera at = camera_at(keys, times, COUNT, times[n]);
        assert_memory_equal(&at, &keys[n], sizeof at);
        for (int side = -1; side <= 1; side += 2) {
            const cw_camera near = camera_at(keys, times, COUNT, times[n] + 1e-7 * side);
            assert_true(distance(near.eye, keys[n].eye) < 1e-4);
        }
    }
    const cw_camera before = camera_at(keys, times, COUNT, -100),
                    after = camera_at(keys, times, COUNT, 1e6);
    assert_memory_equal(&before, &keys[0], sizeof before);
    assert_memory_equal(&after, &keys[COUNT - 1], sizeof after);
}

/* The eye's velocity has no jump, in units of 1e-4 and 1e4 as well. */
static void a_path_is_smooth(void **state)
{
    enum { COUNT = 5, STEPS = 4000 };
    (void)state;
    for (double scale = 1e-4; scale < 1e5; scale *= 1e4) {
        cw_camera keys[COUNT];
        double times[COUNT], last[3] = {0}, last_speed[3] = {0}, jump = 0;
        make_keys(keys, times, COUNT, scale);
        for (int n = 0; n <= STEPS; n++) {
            const cw_camera c =
                camera_at(keys, times, COUNT, 1 + 16 * (double)n / (double)STEPS);
            double speed[3];
            for (int a = 0; a < 3; a++)
                speed[a] = (c.eye[a] - last[a]) / scale;
            if (n > 1)
                jump = fmax(jump, distance(speed, last_speed));
            memcpy(last, c.eye, sizeof last);
            memcpy(last_speed, speed, sizeof last_speed);
        }
        assert_true(jump < 0.02); /* a kink would be as large as a step: about 0.3 */
    }
}

static void a_path_stays_between_its_keys(void **state)
{
    enum { COUNT = 4 };
    (void)state;
    cw_camera keys[COUNT];
    const double times[COUNT] = {0, 1, 2, 3};
    for (size_t n = 0; n < COUNT; n++)
        keys[n] = (cw_camera){
            .eye = {0, n < 2 ? -100 : -10, 0}, .up = {0, 0, 1}, .height_mm = n < 2 ? 50 : 5};
    for (double t = 0; t <= 3; t += 0.01) {
        const cw_camera c = camera_at(keys, times, COUNT, t);
        assert_true(c.eye[1] >= -100 - 1e-9 && c.eye[1] <= -10 + 1e-9);
        assert_true(c.height_mm >= 5 - 1e-9 && c.height_mm <= 50 + 1e-9);
        assert_near(c.fov_deg, 0, 0);
        assert_near(c.up[2], 1, 1e-12);
    }
}

/* Half of a turn between two cameras is the camera between them, whatever the sign of the
 * quaternions. */
static void turns_take_the_short_way(void **state)
{
    (void)state;
    cw_error err = {0};
    const double times[2] = {0, 1};
    for (int deg = -170; deg <= 170; deg += 20) {
        cw_camera keys[2] = {{.eye = {0, -10, 0}, .up = {0, 0, 1}, .fov_deg = 30}};
        keys[1] = keys[0];
        assert_ok(cw_camera_turn(&keys[1], (double[3]){0, 0, 1}, deg, &err), err);
        cw_camera half = keys[0];
        assert_ok(cw_camera_turn(&half, (double[3]){0, 0, 1}, 0.5 * deg, &err), err);
        const cw_camera c = camera_at(keys, times, 2, 0.5);
        assert_true(distance(c.eye, half.eye) < 1e-9);
    }
}

static void curves_never_overshoot(void **state)
{
    enum { COUNT = 12 };
    (void)state;
    double times[COUNT], values[COUNT];
    srand(test_seed(1));
    for (int round = 0; round < 200; round++) {
        for (size_t n = 0; n < COUNT; n++) {
            times[n] = (n ? times[n - 1] : 0) + 0.01 + rand() / (double)RAND_MAX;
            values[n] = rand() % 5 - 2;
        }
        for (size_t n = 0; n + 1 < COUNT; n++)
            for (double t = 0; t <= 1; t += 0.1) {
                const double v = cwi_monotone_curve(times, values, COUNT,
                                                    times[n] + t * (times[n + 1] - times[n]));
                assert_true(v >= fmin(values[n], values[n + 1]) - 1e-12);
                assert_true(v <= fmax(values[n], values[n + 1]) + 1e-12);
            }
    }
}

static void bad_arguments_are_named(void **state)
{
    (void)state;
    cw_camera keys[2] = {{.eye = {0, -10, 0}, .up = {0, 0, 1}, .fov_deg = 30},
                         {.eye = {0, -10, 5}, .up = {0, 0, 1}, .height_mm = 30}},
              c;
    const double times[2] = {0, 1}, equal[2] = {1, 1};
    cw_error err = {0};
    assert_fails(cw_camera_path(keys, times, 2, 0.5, &c, &err), CW_ERR_ARGUMENT,
                 "camera 1 has a perspective", err);
    keys[1] = keys[0];
    assert_fails(cw_camera_path(keys, equal, 2, 0.5, &c, &err), CW_ERR_ARGUMENT,
                 "time 1 is 1: rising", err);
    assert_fails(cw_camera_path(keys, times, 0, 0.5, &c, &err), CW_ERR_ARGUMENT,
                 "at least one camera", err);
    assert_fails(cw_camera_path(keys, times, 2, NAN, &c, &err), CW_ERR_ARGUMENT,
                 "is not finite", err);
    keys[1].up[2] = 0;
    assert_fails(cw_camera_path(keys, times, 2, 0.5, &c, &err), CW_ERR_ARGUMENT, "up", err);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_path_goes_through_its_keys),
        cmocka_unit_test(a_path_is_smooth),
        cmocka_unit_test(a_path_stays_between_its_keys),
        cmocka_unit_test(turns_take_the_short_way),
        cmocka_unit_test(curves_never_overshoot),
        cmocka_unit_test(bad_arguments_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
