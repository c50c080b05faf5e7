/* Tests marks of points of the world: where they are on the picture, and where they are not. */
#include "support/pictures.h"

#include <cubewright/overlay.h>

#include <string.h>

enum { WIDTH = 120, HEIGHT = 80 };

/* 1 mm is 1 pixel; x runs to the right, z up, and (0, 0, 0) is in the middle. */
static const cw_scene scene = {
    .camera = {.eye = {0, -100, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}, .height_mm = HEIGHT},
    .width = WIDTH,
    .height = HEIGHT};

static cw_image draw_marks(const cw_world_mark *marks, size_t count, const cw_scene *of)
{
    cw_image image;
    cw_error err = {0};
    assert_ok(cw_image_alloc(&image, WIDTH, HEIGHT, &err), err);
    for (size_t n = 0; n < 4 * (size_t)WIDTH * HEIGHT; n++)
        image.pixels[n] = n % 4 == 3 ? 255 : 100;
    assert_ok(cw_world_marks_draw(marks, count, 10, of, &image, &err), err);
    return image;
}

static bool is_yellow(const cw_image *image, size_t x, size_t y)
{
    const uint8_t *p = image->pixels + 4 * (y * WIDTH + x);
    return p[0] > 200 && p[1] > 160 && p[2] < 120;
}

static size_t count_changed(const cw_image *image)
{
    size_t changed = 0;
    for (size_t n = 0; n < (size_t)WIDTH * HEIGHT; n++)
        changed += image->pixels[4 * n] != 100;
    return changed;
}

static void lines_are_where_their_points_are(void **state)
{
    (void)state;
    static const double points[3][3] = {{-40, 5, -20}, {40, -30, -20}, {40, 0, 20}};
    cw_world_mark mark = {.points = points, .count = 3};
    cw_image open = draw_marks(&mark, 1, &scene);
    mark.is_closed = true;
    cw_image closed = draw_marks(&mark, 1, &scene);
    assert_true(is_yellow(&open, 20, 60) && is_yellow(&open, 60, 60)); /* below the middle */
    assert_true(is_yellow(&open, 100, 40) && is_yellow(&open, 100, 20));
    assert_false(is_yellow(&open, 60, 39));
    assert_true(is_yellow(&closed, 60, 39)); /* half of the way back */
    assert_true(count_changed(&closed) < 1200);
    mark.opacity = 0.25f;
    cw_image faint = draw_marks(&mark, 1, &scene);
    assert_false(is_yellow(&faint, 60, 39));
    assert_true(count_changed(&faint) > 200);
    cw_image_free(&open);
    cw_image_free(&closed);
    cw_image_free(&faint);
}

/* The first and the last row in which two images differ. */
static void find_changed_rows(const cw_image *a, const cw_image *b, size_t rows[2])
{
    rows[0] = HEIGHT;
    rows[1] = 0;
    for (size_t y = 0; y < HEIGHT; y++)
        if (memcmp(a->pixels + 4 * WIDTH * y, b->pixels + 4 * WIDTH * y, 4 * WIDTH) != 0) {
            rows[0] = y < rows[0] ? y : rows[0];
            rows[1] = y;
        }
    assert_true(rows[0] <= rows[1]);
}

static void texts_stand_beside_their_point(void **state)
{
    (void)state;
    static const double points[2][3] = {{-50, 0, 20}, {-50, 0, -20}};
    cw_world_mark mark = {.points = points, .count = 2, .text_point = 1};
    cw_image plain = draw_marks(&mark, 1, &scene);
    mark.text = "1: 40 mm\xc2\xb2 90\xc2\xb0";
    cw_image written = draw_marks(&mark, 1, &scene);
    mark.text_point = 2;
    cw_image middle = draw_marks(&mark, 1, &scene);
    size_t rows[2], middle_rows[2];
    find_changed_rows(&plain, &written, rows);
    find_changed_rows(&plain, &middle, middle_rows);
    assert_in_range(rows[0], 25, 45); /* above the lower point, which is at row 60 */
    assert_in_range(rows[1], 45, 60);
    for (int n = 0; n < 2; n++)
        assert_int_equal(rows[n] - middle_rows[n], 20);
    cw_image_free(&plain);
    cw_image_free(&written);
    cw_image_free(&middle);
}

static void marks_behind_the_eye_are_left_out(void **state)
{
    (void)state;
    static const double points[2][3] = {{0, 0, 0}, {0, -200, 0}};
    const cw_world_mark mark = {.points = points, .count = 2};
    cw_scene near = scene;
    cw_error err = {0};
    near.camera.height_mm = 0;
    near.camera.fov_deg = 30;
    cw_image image = draw_marks(&mark, 1, &near);
    assert_int_equal(count_changed(&image), 0);
    assert_fails(cw_world_marks_draw(&mark, 1, -1, &near, &image, &err), CW_ERR_ARGUMENT,
                 "letters -1 pixels high", err);
    assert_fails(cw_world_marks_draw(NULL, 1, 0, &near, &image, &err), CW_ERR_ARGUMENT,
                 "no marks", err);
    cw_image_free(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_are_where_their_points_are),
        cmocka_unit_test(texts_stand_beside_their_point),
        cmocka_unit_test(marks_behind_the_eye_are_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
