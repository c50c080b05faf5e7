/* Tests values over slices: a linear field on a grid that lies askew has, in every pixel, the
 * colour of its value there. */
#include "support/pictures.h"

#include <cubewright/overlay.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 60, HEIGHT = 40 };

/* A grey scan with an axial slice, and a field on a coarse grid that is rotated and shifted. */
typedef struct fixture {
    float grey[20 * 16 * 8];
    float field[7 * 6 * 5];
    cw_volume scan, values;
    cw_transfer transfer;
    cw_scene scene;
} fixture;

static double value_at(const double w[3])
{
    return 2 * w[0] - w[1] + 3 * w[2];
}

static void make_fixture(fixture *f)
{
    cw_error err = {0};
    const double rotated[3][4] = {{1.6, -1.2, 0, 9}, {1.2, 1.6, 0, -2}, {0, 0, 1.7, 1}};
    memset(f, 0, sizeof *f);
    f->scan = (cw_volume){.data = f->grey, .type = CW_F32, .dim = {20, 16, 8}};
    f->values = (cw_volume){.data = f->field, .type = CW_F32, .dim = {7, 6, 5}};
    memcpy(f->values.affine, rotated, sizeof rotated);
    for (size_t n = 0; n < 7 * 6 * 5; n++) {
        const double index[3] = {(double)(n % 7), (double)(n / 7 % 6), (double)(n / 42)};
        double world[3];
        cw_volume_to_world(&f->values, index, world);
        f->field[n] = (float)value_at(world);
    }
    f->transfer = (cw_transfer){.color_count = 1, .opacity_count = 1, .opacities = {{0, 1}}};
    f->scene = (cw_scene){.mode = CW_MODE_SLICES,
                          .volume = &f->scan,
                          .transfer = &f->transfer,
                          .width = WIDTH,
                          .height = HEIGHT,
                          .slice_count = 1,
                          .slices = {{{0, 0, 1}, 4.3}}};
    assert_ok(cw_slice_camera(&f->scan, &f->scene.slices[0], (double)WIDTH / HEIGHT,
                              &f->scene.camera, &err),
              err);
}

static void colours_are_those_of_the_field(void **state)
{
    (void)state;
    static fixture f;
    cw_error err = {0};
    size_t coloured = 0, low = 0, outside = 0;
    make_fixture(&f);
    const cw_value_slices values = {.values = &f.values,
                                    .map = CW_COLORMAP_INFERNO,
                                    .low = 24,
                                    .high = 40,
                                    .opacity = 0.5f};
    cw_picture picture;
    assert_ok(cw_picture_alloc(&picture, WIDTH, HEIGHT, &err), err);
    for (size_t n = 0; n < 4 * (size_t)WIDTH * HEIGHT; n++)
        picture.pixels[n] = n % 4 == 3 ? 1 : 0.25f;
    assert_ok(cw_value_slices_draw(&values, &f.scene, &picture, &err), err);
    for (size_t y = 0; y < HEIGHT; y++)
        for (size_t x = 0; x < WIDTH; x++) {
            const double pixel[2] = {(double)x + 0.5, (double)y + 0.5};
            const float *found = picture.pixels + 4 * (y * WIDTH + x);
            double w[3], direction[3], index[3];
            uint8_t rgb[3];
            assert_ok(cw_camera_ray(&f.scene.camera, WIDTH, HEIGHT, pixel, w, direction, &err),
                      err);
            w[2] = 4.3;
            assert_ok(cw_volume_to_index(&f.values, w, index, &err), err);
            const bool inside = w[0] >= 0 && w[0] <= 19 && w[1] >= 0 && w[1] <= 15 &&
                                index[0] >= 0 && index[0] <= 6 && index[1] >= 0 &&
                                index[1] <= 5;
            const double value = value_at(w);
            const bool shown = inside && value >= 24;
            if (inside && fabs(value - 24) < 1e-3)
                continue;
            cw_colormap_color(CW_COLORMAP_INFERNO, (value - 24) / 16, rgb);
            for (int c = 0; c < 3; c++) /* a byte of the map may be rounded otherwise */
                assert_near((double)found[c], shown ? 0.125 + 0.5 * rgb[c] / 255 : 0.25,
                            shown ? 0.51 / 255 : 1e-6);
            coloured += shown;
            low += inside && !shown;
            outside += !inside;
        }
    assert_true(coloured > 150 && low > 100 && outside > 300);
    cw_picture_free(&picture);
}

/* The bar has the map's colours from bottom to top, and its picture needs a range. */
static void a_bar_tells_the_colours(void **state)
{
    (void)state;
    static fixture f;
    cw_error err = {0};
    cw_image image;
    uint8_t first[3], last[3];
    size_t found[2] = {0};
    make_fixture(&f);
    cw_value_slices values = {.values = &f.values, .low = 0, .high = 1};
    cw_overlay overlay = {.values_bar = &values};
    f.scene.width = 320, f.scene.height = 240;
    assert_ok(cw_image_alloc(&image, 320, 240, &err), err);
    assert_ok(cw_overlay_draw(&overlay, &f.scene, &image, &err), err);
    cw_colormap_color(CW_COLORMAP_VIRIDIS, 0.01, first);
    cw_colormap_color(CW_COLORMAP_VIRIDIS, 0.99, last);
    for (size_t y = 0; y < 240; y++)
        for (size_t x = 0; x < 320; x++) {
            const uint8_t *p = image.pixels + 4 * (y * 320 + x);
            found[0] +=
                abs(p[0] - first[0]) + abs(p[1] - first[1]) + abs(p[2] - first[2]) < 12 &&
                y > 60;
            found[1] +=
                abs(p[0] - last[0]) + abs(p[1] - last[1]) + abs(p[2] - last[2]) < 12 && y < 60;
        }
    assert_true(found[0] > 5 && found[1] > 5);
    values.high = 0;
    assert_fails(cw_overlay_draw(&overlay, &f.scene, &image, &err), CW_ERR_ARGUMENT,
                 "the bar of values needs a range", err);
    cw_image_free(&image);
}

static void what_cannot_be_drawn_is_refused(void **state)
{
    (void)state;
    static fixture f;
    cw_error err = {0};
    cw_picture picture;
    make_fixture(&f);
    assert_ok(cw_picture_alloc(&picture, WIDTH, HEIGHT, &err), err);
    cw_value_slices values = {.values = &f.values, .low = 3, .high = 3};
    assert_fails(cw_value_slices_draw(&values, &f.scene, &picture, &err), CW_ERR_ARGUMENT,
                 "the colours are from 3 to 3", err);
    values.high = NAN;
    assert_fails(cw_value_slices_draw(&values, &f.scene, &picture, &err), CW_ERR_ARGUMENT,
                 "finite, rising values were expected", err);
    values.high = 4;
    values.map = CW_COLORMAP_COUNT;
    assert_fails(cw_value_slices_draw(&values, &f.scene, &picture, &err), CW_ERR_ARGUMENT,
                 "is not a colour map", err);
    values.map = CW_COLORMAP_VIRIDIS;
    f.scene.mode = CW_MODE_MIP;
    assert_fails(cw_value_slices_draw(&values, &f.scene, &picture, &err), CW_ERR_ARGUMENT,
                 "values are drawn over slices, not in the mode mip", err);
    f.scene.mode = CW_MODE_SLICES;
    f.values.affine[0][3] = 400;
    assert_fails(cw_value_slices_draw(&values, &f.scene, &picture, &err), CW_ERR_ARGUMENT,
                 "the values do not overlap the volume", err);
    cw_picture_free(&picture);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colours_are_those_of_the_field),
        cmocka_unit_test(a_bar_tells_the_colours),
        cmocka_unit_test(what_cannot_be_drawn_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
