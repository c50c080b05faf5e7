/* Tests ray casting: a constant box on paper, the end of rays, skipping, and the error of the
 * default steps. */
#include "support/pictures.h"

#include <math.h>

static const double cube[3] = {1, 1, 1};

/* The length of the ray through the middle of a pixel inside of a box that is seen from the
 * front, orthographically: the same everywhere. */
static cw_camera straight(double height_mm)
{
    return (cw_camera){.eye = {0, -500, 0}, .up = {0, 0, 1}, .height_mm = height_mm};
}

/* A box of one value is as opaque as Beer and Lambert say. */
static void constant_box_is_exact(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_volume box = {0};
    const cw_transfer flat = test_flat_transfer();
    test_field(&box, 24, 33, 20, cube, test_constant);
    for (int n = 0; n < 4; n++) {
        const cw_scene scene = {.mode = CW_MODE_COMPOSITE,
                                .volume = &box,
                                .transfer = &flat,
                                .camera = straight(10),
                                .width = 16,
                                .height = 16,
                                .sampling.step_vox = (double[]){1, 0.3, 2.7, 7}[n],
                                .sampling.cell_steps = n == 1,
                                .sampling.no_preintegration = n == 2};
        cw_picture picture = test_draw(r, &scene);
        const double alpha = 1 - pow(1 - 0.05, 32);
        for (size_t p = 0; p < 16 * 16; p++) {
            assert_true(fabs((double)picture.pixels[4 * p + 3] - alpha) < 1e-5);
            assert_true(fabs((double)picture.pixels[4 * p] - 0.8 * alpha) < 1e-5);
        }
        cw_picture_free(&picture);
    }
    cw_volume_free(&box);
}

/* By default where 0.9999 is covered: that each millimetre takes half of the light shows it. */
static void rays_end_where_hardly_any_light_is_left(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_volume box = {0};
    const cw_transfer half = {
        .opacity_count = 2, .opacities = {{-9, 0.5f}, {9, 0.5f}}, .unit_mm = 1};
    test_field(&box, 24, 33, 20, cube, test_constant);
    for (int n = 0; n < 3; n++) {
        const float asked = (float[]){0, 0.9999f, 0.9f}[n];
        const double dark = n < 2 ? 1e-4 : 0.1;
        const cw_scene scene = {.mode = CW_MODE_COMPOSITE,
                                .volume = &box,
                                .transfer = &half,
                                .camera = straight(10),
                                .width = 4,
                                .height = 4,
                                .sampling.stop_opacity = asked};
        cw_picture picture = test_draw(r, &scene);
        for (size_t p = 0; p < 4 * 4; p++) {
            const double light = 1 - (double)picture.pixels[4 * p + 3];
            assert_true(light < dark + 1e-6 && light > 0.4 * dark);
        }
        cw_picture_free(&picture);
    }
    cw_volume_free(&box);
}

/* Parts that are passed over are empty. */
static void skipping_changes_nothing(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_volume blobs = {0};
    const cw_transfer soft = test_soft_transfer();
    test_field(&blobs, 64, 64, 64, cube, test_blobs);
    cw_scene scene = {.mode = CW_MODE_COMPOSITE,
                      .volume = &blobs,
                      .transfer = &soft,
                      .width = 128,
                      .height = 128};
    cw_picture with = test_draw(r, &scene);
    scene.sampling.no_skipping = true;
    cw_picture without = test_draw(r, &scene);
    assert_true(test_compare(&with, &without).max < 0.02);
    cw_picture_free(&with);
    cw_picture_free(&without);
    cw_volume_free(&blobs);
}

/* Smooth blobs, with a step of its own in every voxel, as a scan's noise. */
static double rough(const double p[3], const double q[3])
{
    uint32_t n = (uint32_t)lround(p[0] + 97 * p[1] + 8191 * p[2]) * 2654435761u;
    n = (n ^ (n >> 15)) * 2246822519u;
    return test_blobs(p, q) + 0.15 * ((double)(n >> 8) / 0x1p24 - 0.5);
}

/* Returns how far a picture with steps of one voxel is from the integral. */
static test_gap measure_steps(const cw_volume *volume, const cw_transfer *transfer, bool lit,
                              bool no_preintegration)
{
    cw_renderer *cpu;
    cw_error err = {0};
    cw_scene scene = {.mode = CW_MODE_COMPOSITE,
                      .volume = volume,
                      .transfer = transfer,
                      .lit = lit,
                      .sampling.no_preintegration = no_preintegration,
                      .width = 96,
                      .height = 96};
    assert_ok(cw_renderer_new(CW_BACKEND_CPU, &cpu, &err), err);
    cw_picture drawn = test_draw(test_renderer(), &scene);
    scene.mode = CW_MODE_REFERENCE;
    cw_picture exact = test_draw(cpu, &scene);
    const test_gap gap = test_compare(&drawn, &exact);
    cw_picture_free(&drawn);
    cw_picture_free(&exact);
    cw_renderer_free(cpu);
    return gap;
}

/* In data that is rough a straight line between samples is dark: of a function that is smooth
 * the sample alone is taken, so that the default is not the less exact choice. Of narrow tents
 * samples miss some, and the line does not. */
static void default_steps_suit_the_transfer_function(void **state)
{
    (void)state;
    const cw_transfer soft = test_soft_transfer(), tent = test_tent_transfer();
    cw_volume volume = {0}, smooth = {0};
    test_renderer(); /* or skip */
    test_field(&volume, 48, 48, 48, cube, rough);
    test_field(&smooth, 48, 48, 48, cube, test_blobs);
    for (int lit = 0; lit < 2; lit++) {
        const test_gap chosen = measure_steps(&volume, &soft, lit, false);
        assert_true(chosen.rmse <= measure_steps(&volume, &soft, lit, true).rmse);
        assert_true(chosen.rmse < (lit ? 2.5 : 0.5));
        const test_gap narrow = measure_steps(&smooth, &tent, lit, false);
        const test_gap sampled = measure_steps(&smooth, &tent, lit, true);
        assert_true(narrow.rmse < 0.4 * sampled.rmse);
    }
    cw_volume_free(&volume);
    cw_volume_free(&smooth);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constant_box_is_exact),
        cmocka_unit_test(rays_end_where_hardly_any_light_is_left),
        cmocka_unit_test(skipping_changes_nothing),
        cmocka_unit_test(default_steps_suit_the_transfer_function),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
