/* Pictures on surfaces: what a sample is, known on paper. */
#include "support/support.h"

#include "viewer/appearance/look_texture.h"

#include <math.h>
#include <stdlib.h>

/* A picture whose red is a function of its texel. */
static cw_image make_picture(size_t width, size_t height, uint8_t (*red)(size_t, size_t))
{
    cw_error err = {0};
    cw_image image;
    assert_ok(cw_image_alloc(&image, width, height, &err), err);
    for (size_t i = 0; i < width * height; i++) {
        image.pixels[4 * i] = red(i % width, i / width);
        image.pixels[4 * i + 1] = 77;
    }
    return image;
}

static uint8_t ramp(size_t x, size_t y)
{
    return (uint8_t)(3 * x + 5 * y);
}

static uint8_t checks(size_t x, size_t y)
{
    return (x + y) % 2 ? 255 : 0;
}

static uint8_t stripes(size_t x, size_t y)
{
    (void)y;
    return x % 2 ? 255 : 0;
}

static cwi_look_texture make_texture(const cw_image *image, bool is_color, bool repeats)
{
    cw_error err = {0};
    cwi_look_texture t;
    assert_ok(cwi_look_texture_make(image, is_color, repeats, &t, &err), err);
    return t;
}

static void a_ramp_is_interpolated_between_texels(void **state)
{
    (void)state;
    cw_image image = make_picture(32, 16, ramp);
    cwi_look_texture t = make_texture(&image, false, false);
    for (int n = 0; n < 200; n++) {
        const double x = 0.5 + 31.0 * (n * 37 % 200) / 200,
                     y = 0.5 + 15.0 * (n * 71 % 200) / 200;
        const cwi_look_place place = {
            .uv = {x / 32, y / 16}, .dx = {0.1 / 32, 0}, .dy = {0, 0.1 / 16}};
        double rgb[3];
        cwi_look_texture_sample(&t, &place, rgb);
        assert_near(255 * rgb[0], 3 * (x - 0.5) + 5 * (y - 0.5), 1e-4);
        assert_near(255 * rgb[1], 77, 1e-4);
    }
    cwi_look_texture_free(&t);
    cw_image_free(&image);
}

/* Far away a fine pattern is its mean: of light, where it is a colour. */
static void a_small_pattern_is_its_mean(void **state)
{
    (void)state;
    static const size_t sizes[][2] = {{64, 64}, {128, 32}, {256, 1024}};
    for (int n = 0; n < 3; n++) {
        cw_image image = make_picture(sizes[n][0], sizes[n][1], checks);
        cwi_look_texture plain = make_texture(&image, false, true),
                         color = make_texture(&image, true, true);
        const cwi_look_place place = {.uv = {0.3, 0.7}, .dx = {2, 0.1}, .dy = {0.1, 3}};
        double rgb[3];
        cwi_look_texture_sample(&plain, &place, rgb);
        assert_near(rgb[0], 0.5, 0.01);
        cwi_look_texture_sample(&color, &place, rgb);
        assert_near(rgb[0], 0.5, 0.01);
        cwi_look_texture_free(&plain);
        cwi_look_texture_free(&color);
        cw_image_free(&image);
    }
}

/* A footprint that is long along the stripes and narrow across keeps them apart. */
static void a_slanted_look_stays_sharp(void **state)
{
    (void)state;
    cw_image image = make_picture(64, 64, stripes);
    cwi_look_texture t = make_texture(&image, false, true);
    const cwi_look_place dark = {.uv = {32.5 / 64, 0.5},
                                 .dx = {0.5 / 64, 0},
                                 .dy = {0, 7.9 / 64}},
                         light = {
                             .uv = {33.5 / 64, 0.5}, .dx = {0.5 / 64, 0}, .dy = {0, 7.9 / 64}};
    double rgb[3];
    cwi_look_texture_sample(&t, &dark, rgb);
    assert_near(rgb[0], 0, 1e-6);
    cwi_look_texture_sample(&t, &light, rgb);
    assert_near(rgb[0], 1, 1e-6);
    cwi_look_texture_free(&t);
    cw_image_free(&image);
}

static void borders_go_on_or_repeat(void **state)
{
    (void)state;
    cw_image image = make_picture(8, 8, ramp);
    for (int repeats = 0; repeats < 2; repeats++) {
        cwi_look_texture t = make_texture(&image, false, repeats);
        const cwi_look_place place = {
            .uv = {1 + 2.5 / 8, -3 + 4.5 / 8}, .dx = {1e-3, 0}, .dy = {0, 1e-3}};
        double rgb[3];
        cwi_look_texture_sample(&t, &place, rgb);
        assert_near(255 * rgb[0], repeats ? 3 * 2 + 5 * 4 : 3 * 7, 1e-4);
        cwi_look_texture_free(&t);
    }
    cw_image_free(&image);
}

/* Coordinates and footprints that no surface should have give some colour, too. */
static void any_place_can_be_sampled(void **state)
{
    (void)state;
    static const double odd[] = {0, -1e30, 1e30, INFINITY, NAN, 1e-300};
    cw_image image = make_picture(5, 3, ramp);
    for (int repeats = 0; repeats < 2; repeats++) {
        cwi_look_texture t = make_texture(&image, true, repeats);
        for (int n = 0; n < 6 * 6 * 6; n++) {
            const double a = odd[n % 6], b = odd[n / 6 % 6], c = odd[n / 36];
            const cwi_look_place place = {.uv = {a, b}, .dx = {c, a}, .dy = {b, c}};
            double rgb[3];
            cwi_look_texture_sample(&t, &place, rgb);
        }
        cwi_look_texture_free(&t);
    }
    cw_image_free(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ramp_is_interpolated_between_texels),
        cmocka_unit_test(a_small_pattern_is_its_mean),
        cmocka_unit_test(a_slanted_look_stays_sharp),
        cmocka_unit_test(borders_go_on_or_repeat),
        cmocka_unit_test(any_place_can_be_sampled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
