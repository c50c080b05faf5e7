/* Tests intensity projections on the CPU: extremes, means, local maxima, and skipped blocks. */
#include "support/pictures.h"
#include "support/rays.h"

#include "viewer/cpu/intensity_projection.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const cw_transfer grey = {.color_count = 2, .colors = {{0, {0, 0, 0}}, {1, {1, 1, 1}}}};

static cw_scene scene_of(cw_mode mode, const cw_volume *v, cw_camera camera)
{
    return (cw_scene){.mode = mode,
                      .volume = v,
                      .transfer = &grey,
                      .camera = camera,
                      .width = 8,
                      .height = 8};
}

static double value_of(const cw_scene *scene, double x, double y)
{
    const cwi_frame frame = test_frame(scene);
    return cwi_intensity_ray(&frame, NULL, x, y, INFINITY);
}

/* Samples come close to the extremes, and never beyond them; their mean to the mean. */
static void extremes_and_mean_are_exact(void **state)
{
    (void)state;
    static const cw_camera cameras[] = {
        {.eye = {0, -90, 0}, .up = {0, 0, 1}, .height_mm = 12},
        {.eye = {15, -20, 13}, .up = {0.1, 0, 1}, .fov_deg = 40},
    };
    cw_volume v = {0};
    test_field(&v, 13, 14, 15, (const double[3]){1, 1.3, 0.9}, test_blobs);
    float *voxels = cw_volume_voxels(&v); /* rough, so that cubics turn inside of cells */
    for (size_t n = 0; n < 13 * 14 * 15; n++)
        voxels[n] += (float)(n * 7919 % 101) / 200;
    v.affine[1][0] = 0.2;
    for (int n = 0; n < 2; n++)
        for (int p = 0; p < 6; p++) {
            const double x = 3.3 + 0.27 * p, y = 4.6 - 0.21 * p;
            cw_scene scene = scene_of(CW_MODE_MIP, &v, cameras[n]);
            const cwi_frame frame = test_frame(&scene);
            double sampled[3];
            test_ray_values(&frame, x, y, 20000, sampled);
            const double highest = value_of(&scene, x, y);
            scene.mode = CW_MODE_MINIP;
            const double lowest = value_of(&scene, x, y);
            scene.mode = CW_MODE_AVERAGE;
            assert_near(value_of(&scene, x, y), sampled[2], 1e-7);
            assert_true(highest >= sampled[1] - 1e-12 && highest < sampled[1] + 1e-3);
            assert_true(lowest <= sampled[0] + 1e-12 && lowest > sampled[0] - 1e-3);
            scene.mode = CW_MODE_LOCAL_MIP;
            scene.intensity.threshold = 1e9; /* none gets there */
            assert_near(value_of(&scene, x, y), highest, 1e-12);
        }
    cw_volume_free(&v);
}

/* Maxima in a row, seen from both ends, with a gap. */
static void first_maximum_above_the_threshold_counts(void **state)
{
    (void)state;
    static const float row[] = {0.1f, 0.5f, 0.2f, 0.9f, 0.3f, 0.6f, 0.6f, 0.7f, 0.1f, 0.8f};
    static const struct {
        bool from_behind;
        double threshold, value;
        int gap; /* of values: from here to the next; -1: none */
    } cases[] = {{false, 0.1, 0.5, -1}, {false, 0.55, 0.9, -1}, {false, 2, 0.9, -1},
                 {true, 0.1, 0.8, -1},  {true, 0.85, 0.9, -1},  {false, 0.1, 0.9, 1},
                 {false, 0.25, 0.9, 1}, {false, 0.55, 0.7, 3},  {true, 0.1, 0.7, 8}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        cw_volume v = {0};
        test_field(&v, 4, 10, 4, (const double[3]){1, 1, 1}, test_constant);
        float *voxels = cw_volume_voxels(&v);
        for (size_t p = 0; p < 160; p++)
            voxels[p] = (int)(p / 4 % 10) == cases[n].gap ? NAN : row[p / 4 % 10];
        cw_scene scene = scene_of(CW_MODE_LOCAL_MIP, &v,
                                  (cw_camera){.eye = {0, cases[n].from_behind ? 50 : -50, 0},
                                              .up = {0, 0, 1},
                                              .height_mm = 2});
        scene.intensity.threshold = cases[n].threshold;
        if (cases[n].gap == 1) /* what is before the gap is cut off */
            scene.clips[scene.clip_count++] = (cw_clip){{0, 1, 0}, -3.5};
        assert_near(value_of(&scene, 3.5, 4.2), cases[n].value, 1e-7);
        cw_volume_free(&v);
    }
}

/* Air around a row of values does not count, seen from both ends; a gap inside does not end the
 * object, and a ray that only touches values below the threshold shows nothing. */
static void minimum_inside_leaves_out_the_air_around(void **state)
{
    (void)state;
    static const float row[] = {0.1f, 0, 0.2f, 0.9f, 0.4f, 0.8f, 0.3f, 0.7f, 0.05f, 0.1f};
    static const struct {
        double threshold, value;
        int gap;    /* of values; -1: none */
        double cut; /* of the row's beginning, in voxels; 0: none */
    } cases[] = {
        {0.6, 0.3, -1, 0},     {0.75, 0.4, -1, 0}, {0.85, 0.85, -1, 0}, {0.05, 0, -1, 0},
        {0.25, 0.25, -1, 0},   {0.6, 0.4, 6, 0},   {0.6, 0.3, 4, 0},    {2, NAN, -1, 0},
        {0.38, 0.38, -1, 6.9}, {0.6, 0.6, -1, 7},  {0, 0, -1, 0},       {-1, 0, -1, 0},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++)
        for (int behind = 0; behind < 2; behind++) {
            cw_volume v = {0};
            test_field(&v, 4, 10, 4, (const double[3]){1, 1, 1}, test_constant);
            float *voxels = cw_volume_voxels(&v);
            for (size_t p = 0; p < 160; p++)
                voxels[p] = (int)(p / 4 % 10) == cases[n].gap ? NAN : row[p / 4 % 10];
            cw_scene scene = scene_of(
                CW_MODE_MINIP, &v,
                (cw_camera){.eye = {0, behind ? 50 : -50, 0}, .up = {0, 0, 1}, .height_mm = 2});
            scene.intensity.minip_inside = true;
            scene.intensity.threshold = cases[n].threshold;
            scene.clip_count = cases[n].cut > 0;
            scene.clips[0] = (cw_clip){{0, 1, 0}, cases[n].cut - 4.5};
            const double value = value_of(&scene, 3.5, 4.2);
            if (isnan(cases[n].value))
                assert_true(isnan(value));
            else
                assert_near(value, cases[n].value, 1e-7);
            scene.intensity.minip_inside = false; /* the threshold does nothing */
            if (cases[n].cut == 0 && cases[n].gap < 0)
                assert_near(value_of(&scene, 3.5, 4.2), 0, 1e-7);
            cw_volume_free(&v);
        }
}

/* Greys as they are, opaque wherever there is a value, and nothing elsewhere. */
static void pictures_show_the_value(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_renderer *r;
    cw_volume ramp = {0};
    assert_ok(cw_renderer_new(CW_BACKEND_CPU, &r, &err), err);
    test_field(&ramp, 16, 20, 16, (const double[3]){1, 1, 1}, test_ramp);
    static const cw_mode modes[] = {CW_MODE_MIP, CW_MODE_MINIP, CW_MODE_AVERAGE,
                                    CW_MODE_LOCAL_MIP};
    for (size_t n = 0; n < 4; n++) {
        cw_scene scene = scene_of(
            modes[n], &ramp, (cw_camera){.eye = {0, -90, 0}, .up = {0, 0, 1}, .height_mm = 30});
        scene.width = scene.height = 30;
        scene.threads = 1;
        cw_picture one = test_draw(r, &scene);
        scene.threads = 3;
        cw_picture three = test_draw(r, &scene);
        assert_memory_equal(one.pixels, three.pixels, 30 * 30 * 4 * sizeof(float));
        for (size_t p = 0; p < 900; p++) {
            const double x = (double)(p % 30) - 14.5, z = 14.5 - (double)(p / 30);
            const bool inside = fabs(x) < 7.5 && fabs(z) < 7.5;
            const float *pixel = one.pixels + 4 * p;
            if (fabs(fabs(x) - 7.5) < 1e-9 || fabs(fabs(z) - 7.5) < 1e-9)
                continue; /* rays along a face */
            assert_true(pixel[3] == (inside ? 1 : 0));
            assert_near((double)pixel[1], inside ? (x + 7.5) / 15 : 0, 1e-6);
        }
        cw_picture_free(&one);
        cw_picture_free(&three);
    }
    cw_volume_free(&ramp);
    cw_renderer_free(r);
}

/* Blocks that are passed over would not have changed the picture; values in their blocks or
 * not. */
static void passing_over_blocks_changes_nothing(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_volume v = {0};
    cwi_ranges ranges;
    test_field(&v, 37, 41, 33, (const double[3]){1, 1.3, 0.9}, test_blobs);
    float *voxels = cw_volume_voxels(&v);
    for (size_t n = 0; n < 37 * 41 * 33; n++)
        if (n / 37 % 41 / 12 == 1 && n % 37 > 8) /* whole blocks of it */
            voxels[n] = NAN;
    assert_ok(cwi_ranges_make(&v, 1, &(cw_progress){0}, &ranges, &err), err);
    for (int mode = CW_MODE_MIP; mode <= CW_MODE_LOCAL_MIP; mode++)
        for (size_t p = 0; p < 800; p++) {
            cw_scene scene = scene_of((cw_mode)mode, &v, (cw_camera){0});
            scene.intensity.minip_inside = p >= 400;
            scene.camera = (cw_camera){.eye = {35, -60, 20}, .up = {0, 0, 1}, .fov_deg = 30};
            scene.intensity.threshold = (double[]){0.2, 0.5, 0.8}[p % 3];
            const cwi_frame frame = test_frame(&scene);
            const double x = 0.4 * (double)(p % 20), y = 0.4 * (double)(p / 20 % 20);
            const double all = cwi_intensity_ray(&frame, NULL, x, y, INFINITY),
                         some = cwi_intensity_ray(&frame, &ranges, x, y, INFINITY);
            assert_true(all == some || (isnan(all) && isnan(some)));
        }
    cwi_ranges_free(&ranges);
    cw_volume_free(&v);
}

/* Doubles that no float is: their blocks' ranges are floats, and hold them all. */
static void ranges_of_blocks_are_rounded_outward(void **state)
{
    (void)state;
    enum { EDGE = 8, SIDE = EDGE + 1 };
    static double voxels[SIDE * SIDE * SIDE];
    cw_error err = {0};
    test_seed(5);
    for (int round = 0; round < 8; round++) {
        cw_volume v = {.data = voxels, .type = CW_F64, .dim = {SIDE, SIDE, SIDE}}, whole;
        const double sign = round & 1 ? -1 : 1;
        cwi_ranges ranges;
        for (size_t n = 0; n < SIDE * SIDE * SIDE; n++)
            voxels[n] = sign * (1000 + rand() / (double)RAND_MAX);
        v.slope = round & 2 ? -0.3 : 1;
        v.intercept = round & 4 ? -v.slope * sign * 1000.5 : 0; /* small differences */
        assert_ok(cw_volume_resolve(&v, &whole, &err), err);
        assert_ok(cwi_ranges_make(&whole, 1, &(cw_progress){0}, &ranges, &err), err);
        for (size_t b = 0; b < 8; b++)
            for (size_t n = 0; n < 125; n++) {
                const double value =
                    cw_volume_value(&v, 4 * (b & 1) + n % 5, 4 * (b >> 1 & 1) + n / 5 % 5,
                                    4 * (b >> 2) + n / 25);
                assert_true((double)ranges.blocks[b][0] <= value);
                assert_true((double)ranges.blocks[b][1] >= value);
            }
        cwi_ranges_free(&ranges);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(extremes_and_mean_are_exact),
        cmocka_unit_test(ranges_of_blocks_are_rounded_outward),
        cmocka_unit_test(first_maximum_above_the_threshold_counts),
        cmocka_unit_test(minimum_inside_leaves_out_the_air_around),
        cmocka_unit_test(pictures_show_the_value),
        cmocka_unit_test(passing_over_blocks_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
