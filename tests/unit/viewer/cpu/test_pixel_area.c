/* Tests pixels with an area, in the mode vbuffer: against many samples a pixel, against plain
 * rays where cells are wider than pixels, at borders, and for threads. */
#include "support/pictures.h"

#include <math.h>
#include <string.h>

static const double cube[3] = {1, 1, 1};

/* Shells of a gyroid, 12 cells apart. */
static double gyroid(const double p[3], const double q[3])
{
    static const double k = 6.2831853 / 12;
    (void)q;
    return 0.5 + sin(k * p[0]) * cos(k * p[1]) + sin(k * p[1]) * cos(k * p[2]) +
           sin(k * p[2]) * cos(k * p[0]);
}

static double even(const double p[3], const double q[3])
{
    (void)p;
    (void)q;
    return 1;
}

static cw_picture draw(const cw_scene *scene)
{
    cw_error err = {0};
    cw_renderer *r;
    assert_ok(cw_renderer_new(CW_BACKEND_CPU, &r, &err), err);
    cw_picture picture = test_draw(r, scene);
    cw_renderer_free(r);
    return picture;
}

/* Draws the mean of 8 x 8 samples a pixel. */
static cw_picture draw_truth(cw_scene scene)
{
    enum { MORE = 2 };
    cw_error err = {0};
    cw_picture truth = {0};
    const size_t width = scene.width;
    assert_ok(cw_picture_alloc(&truth, width, scene.height, &err), err);
    scene.width *= MORE;
    scene.height *= MORE;
    scene.samples = 4;
    scene.vbuffer.pixel_area = false;
    cw_picture fine = draw(&scene);
    for (size_t p = 0; p < fine.width * fine.height * 4; p++) {
        const size_t x = p / 4 % fine.width / MORE, y = p / 4 / fine.width / MORE;
        truth.pixels[4 * (y * width + x) + p % 4] += fine.pixels[p] / (MORE * MORE);
    }
    cw_picture_free(&fine);
    return truth;
}

static double rmse_of(const cw_scene *scene, const cw_picture *truth)
{
    static const float black[2][3];
    cw_error err = {0};
    cw_comparison gap;
    cw_picture drawn = draw(scene);
    assert_ok(cw_picture_compare(&drawn, truth, black, &gap, &err), err);
    cw_picture_free(&drawn);
    return gap.rmse;
}

/* Expects the area's error to be at most a part of that of one sample a pixel. */
static void expect_part(cw_scene scene, double part)
{
    cw_picture truth = draw_truth(scene);
    scene.vbuffer.pixel_area = false;
    const double plain = rmse_of(&scene, &truth);
    scene.vbuffer.pixel_area = true;
    const double area = rmse_of(&scene, &truth);
    if (!(plain > 1 && area <= part * plain))
        fail_msg("rmse %g with areas, %g without; at most %g of it was expected", area, plain,
                 part);
    cw_picture_free(&truth);
}

/* Cells of a quarter of a pixel, and of a twentieth, where mean cells are taken. */
static void an_area_is_near_many_samples(void **state)
{
    (void)state;
    cw_volume v = {0};
    const cw_transfer soft = test_soft_transfer();
    test_field(&v, 96, 96, 96, cube, gyroid);
    cw_scene scene = {
        .mode = CW_MODE_VBUFFER, .volume = &v, .transfer = &soft, .width = 32, .height = 32};
    expect_part(scene, 0.12);
    scene.lit = true;
    expect_part(scene, 0.25);
    scene.camera = (cw_camera){.eye = {40, -300, 90}, .up = {0, 0, 1}, .height_mm = 180};
    scene.clip_count = 1;
    scene.clips[0] = (cw_clip){{1, 1, 0.5}, 2};
    expect_part(scene, 0.25);
    scene.cut_away = true;
    expect_part(scene, 0.25);
    scene.lit = false;
    scene.clip_count = 0;
    scene.cut_away = false;
    scene.width = scene.height = 9;
    expect_part(scene, 0.4);
    cw_volume_free(&v);
}

/* A box of constant values that covers parts of the pixels at its border. */
static void a_border_fills_its_share_of_a_pixel(void **state)
{
    (void)state;
    cw_volume v = {0};
    const cw_transfer solid = {
        .opacity_count = 2, .opacities = {{0, 0.9f}, {2, 0.9f}}, .unit_mm = 1};
    test_field(&v, 41, 41, 41, cube, even);
    const cw_scene scene = {.mode = CW_MODE_VBUFFER,
                            .volume = &v,
                            .transfer = &solid,
                            .camera = {.eye = {0, -200, 0}, .up = {0, 0, 1}, .height_mm = 60},
                            .width = 13,
                            .height = 13,
                            .vbuffer.pixel_area = true};
    cw_picture picture = draw(&scene);
    double area = 0;
    for (size_t p = 0; p < picture.width * picture.height; p++)
        area += (double)picture.pixels[4 * p + 3] * (60.0 / 13) * (60.0 / 13);
    assert_near(area, 40 * 40, 2);
    cw_picture_free(&picture);
    cw_volume_free(&v);
}

static void cells_wider_than_pixels_are_drawn_as_ever(void **state)
{
    (void)state;
    cw_volume v = {0};
    const cw_transfer soft = test_soft_transfer();
    test_field(&v, 16, 16, 16, cube, gyroid);
    cw_scene scene = {.mode = CW_MODE_VBUFFER,
                      .volume = &v,
                      .transfer = &soft,
                      .width = 64,
                      .height = 64,
                      .lit = true};
    cw_picture plain = draw(&scene);
    scene.vbuffer.pixel_area = true;
    cw_picture area = draw(&scene);
    assert_memory_equal(area.pixels, plain.pixels, 64 * 64 * 4 * sizeof(float));
    cw_picture_free(&area);
    cw_picture_free(&plain);
    cw_volume_free(&v);
}

static void threads_do_not_show(void **state)
{
    (void)state;
    cw_volume v = {0};
    const cw_transfer soft = test_soft_transfer();
    test_field(&v, 96, 96, 96, cube, gyroid);
    for (size_t size = 6; size <= 24; size += 18) {
        cw_scene scene = {.mode = CW_MODE_VBUFFER,
                          .volume = &v,
                          .transfer = &soft,
                          .width = size,
                          .height = size,
                          .lit = true,
                          .vbuffer.pixel_area = true,
                          .threads = 1};
        cw_picture one = draw(&scene);
        scene.threads = 3;
        cw_picture three = draw(&scene);
        assert_memory_equal(one.pixels, three.pixels, size * size * 4 * sizeof(float));
        cw_picture_free(&one);
        cw_picture_free(&three);
    }
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_area_is_near_many_samples),
        cmocka_unit_test(a_border_fills_its_share_of_a_pixel),
        cmocka_unit_test(cells_wider_than_pixels_are_drawn_as_ever),
        cmocka_unit_test(threads_do_not_show),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
