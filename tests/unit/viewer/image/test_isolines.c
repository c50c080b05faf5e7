/* Tests isolines on slices: where a known field has its value, to a part of a pixel, on grids
 * that are rotated and have thick slices. */
#include "support/pictures.h"

#include "core/base/memory.h"
#include "viewer/image/isolines.h"

#include <cubewright/overlay.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 90, HEIGHT = 70, SIDE = 24 };

typedef struct fixture {
    float values[SIDE * SIDE * SIDE];
    cw_volume volume;
    cw_transfer transfer;
    cw_scene scene;
} fixture;

/* A grid of 1 x 1 x 1.5 mm, rotated by 30 degrees about x. */
static void make_fixture(fixture *f, double (*field)(const double world[3]))
{
    const double c = cos(PI / 6), s = sin(PI / 6);
    const double affine[3][4] = {{1, 0, 0, -11.5}, {0, c, -1.5 * s, -4}, {0, s, 1.5 * c, -18}};
    cw_error err = {0};
    memset(f, 0, sizeof *f);
    f->volume = (cw_volume){.data = f->values, .type = CW_F32, .dim = {SIDE, SIDE, SIDE}};
    memcpy(f->volume.affine, affine, sizeof affine);
    for (size_t n = 0; n < SIDE * SIDE * SIDE; n++) {
        const double index[3] = {(double)(n % SIDE), (double)(n / SIDE % SIDE),
                                 (double)(n / (SIDE * SIDE))};
        double world[3];
        cw_volume_to_world(&f->volume, index, world);
        f->values[n] = (float)field(world);
    }
    f->transfer = (cw_transfer){.color_count = 1, .opacity_count = 1, .opacities = {{0, 1}}};
    f->scene = (cw_scene){.mode = CW_MODE_SLICES,
                          .volume = &f->volume,
                          .transfer = &f->transfer,
                          .width = WIDTH,
                          .height = HEIGHT,
                          .slice_count = 1,
                          .slices = {{{0, 0, 1}, 2}}};
    assert_ok(cw_slice_camera(&f->volume, &f->scene.slices[0], (double)WIDTH / HEIGHT,
                              &f->scene.camera, &err),
              err);
}

static double tilted_plane(const double w[3])
{
    return 3 * w[0] - 2 * w[1] + w[2];
}

static double ball(const double w[3])
{
    return 8 - sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
}

/* Finds the isolines, and the world's points of their ends. */
static double (*find_points(const fixture *f, double isovalue, size_t *count))[3]
{
    cw_error err = {0};
    cwi_frame frame;
    cwi_stroke *strokes;
    size_t found;
    double depth[3];
    const cw_image image = {.width = WIDTH, .height = HEIGHT};
    assert_ok(cwi_frame_init(&frame, &f->scene, &err), err);
    assert_ok(cwi_isolines_find(&frame, &image, isovalue, &strokes, &found, &err), err);
    double(*points)[3] = malloc((2 * found + 1) * sizeof *points);
    assert_non_null(points);
    for (size_t n = 0; n < 2 * found; n++) {
        const double *pixel = n % 2 ? strokes[n / 2].to : strokes[n / 2].from;
        assert_ok(cw_camera_ray(&f->scene.camera, WIDTH, HEIGHT, pixel, points[n], depth, &err),
                  err);
        points[n][2] = 2;
    }
    cwi_free(strokes);
    *count = 2 * found;
    return points;
}

/* Linear fields are themselves when interpolated. */
static void lines_of_a_plane_are_exact(void **state)
{
    (void)state;
    static fixture f;
    size_t count;
    make_fixture(&f, tilted_plane);
    const double pixel_mm = f.scene.camera.height_mm / HEIGHT;
    double(*points)[3] = find_points(&f, 1, &count);
    assert_true(count > 40);
    for (size_t n = 0; n < count; n++) /* by the gradient in the slice */
        assert_near((tilted_plane(points[n]) - 1) / sqrt(13), 0, pixel_mm / 64);
    free(points);
}

/* The ball of radius 5 has a circle here, of a length known on paper. */
static void a_ball_has_a_circle(void **state)
{
    (void)state;
    static fixture f;
    size_t count;
    double length = 0;
    make_fixture(&f, ball);
    double(*points)[3] = find_points(&f, 3, &count);
    const double radius = sqrt(25 - 4);
    for (size_t n = 0; n < count; n += 2) {
        assert_near(hypot(points[n][0], points[n][1]), radius, 0.1); /* of interpolation */
        length += hypot(points[n + 1][0] - points[n][0], points[n + 1][1] - points[n][1]);
    }
    assert_within(length, 2 * PI * radius, 0.02);
    free(points);
}

/* The picture has the line's colour on the line, and is as before away from it; the number of
 * threads changes nothing. */
static void pictures_have_the_line(void **state)
{
    (void)state;
    static fixture f;
    cw_error err = {0};
    cw_image images[2];
    make_fixture(&f, ball);
    const cw_overlay overlay = {
        .isoline = true, .isovalue = 3, .isoline_color = {255, 0, 0, 255}};
    for (int n = 0; n < 2; n++) {
        f.scene.threads = 1 + 2 * n;
        assert_ok(cw_image_alloc(&images[n], WIDTH, HEIGHT, &err), err);
        for (size_t b = 0; b < 4 * (size_t)WIDTH * HEIGHT; b++)
            images[n].pixels[b] = b % 4 == 3 ? 255 : 90;
        assert_ok(cw_overlay_draw(&overlay, &f.scene, &images[n], &err), err);
    }
    const size_t bytes = 4 * (size_t)WIDTH * HEIGHT;
    assert_memory_equal(images[0].pixels, images[1].pixels, bytes);
    size_t red = 0, changed = 0;
    for (size_t p = 0; p < bytes; p += 4) {
        const uint8_t *c = images[0].pixels + p;
        red += c[0] > 200 && c[1] < 60;
        changed += c[0] != 90 || c[1] != 90;
    }
    assert_true(red > 40 && changed < 800);
    f.scene.mode = CW_MODE_MIP;
    assert_fails(cw_overlay_draw(&overlay, &f.scene, &images[0], &err), CW_ERR_ARGUMENT,
                 "isolines are drawn on slices, not in the mode mip", err);
    cw_image_free(&images[0]);
    cw_image_free(&images[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_of_a_plane_are_exact),
        cmocka_unit_test(a_ball_has_a_circle),
        cmocka_unit_test(pictures_have_the_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
