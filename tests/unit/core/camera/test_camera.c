/* Tests cameras: fitting boxes into the picture, turning views, refused angles and camera
 * texts. */
#include "support/support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const cw_fit_desc around = {
    .min = {-10, -20, -30}, .max = {30, 40, 50}, .fov_deg = 30, .margin = 0.04};

static cw_camera fit(const char *view, double azimuth, double elevation, double fov)
{
    cw_error err = {0};
    cw_camera c;
    cw_fit_desc d = around;
    d.view = view;
    d.azimuth_deg = azimuth;
    d.elevation_deg = elevation;
    d.fov_deg = fov;
    assert_ok(cw_camera_fit(&d, &c, &err), err);
    return c;
}

static void assert_alike(const cw_camera *a, const cw_camera *b)
{
    for (int n = 0; n < 3; n++) {
        assert_near(a->eye[n], b->eye[n], 1e-9);
        assert_near(a->target[n], b->target[n], 1e-9);
        assert_near(a->up[n], b->up[n], 1e-12);
    }
    assert_near(a->height_mm, b->height_mm, 1e-9);
    assert_near(a->fov_deg, b->fov_deg, 1e-12);
}

/* All corners of a box are in the picture, and none has room to spare: of both ways to look, in
 * pictures of any shape. */
static void boxes_just_fit_into_the_picture(void **state)
{
    (void)state;
    static const double sizes[][3] = {{60, 10, 8}, {8, 10, 60}, {20, 90, 20}, {30, 30, 30}};
    static const double aspects[] = {0.4, 1, 2.5}, margin = 0.1;
    for (int n = 0; n < 4 * 3 * 2; n++) {
        const double *size = sizes[n % 4], aspect = aspects[n / 4 % 3];
        const size_t height = 1000, width = (size_t)(1000 * aspect);
        cw_fit_desc d = {.view = "iso", .aspect = aspect, .margin = margin};
        cw_error err = {0};
        cw_camera c;
        double most = 0;
        d.fov_deg = n < 12 ? 0 : 30;
        for (int a = 0; a < 3; a++) {
            d.min[a] = -size[a];
            d.max[a] = size[a];
        }
        assert_ok(cw_camera_fit(&d, &c, &err), err);
        for (int corner = 0; corner < 8; corner++) {
            double p[3], pixel[2];
            for (int a = 0; a < 3; a++)
                p[a] = corner >> a & 1 ? size[a] : -size[a];
            assert_true(cw_camera_project(&c, width, height, p, pixel, NULL));
            most = fmax(most, fabs(pixel[0] / (double)width - 0.5));
            most = fmax(most, fabs(pixel[1] / (double)height - 0.5));
        }
        assert_near(most, 0.5 - margin, 1e-9);
    }
}

/* Quarter turns of the front view are other views: the eye goes to the picture's right,
 * and up. */
static void angles_lead_from_view_to_view(void **state)
{
    (void)state;
    static const struct {
        const char *from;
        double azimuth, elevation;
        const char *to;
    } rows[] = {{"front", 90, 0, "left"},   {"front", 180, 0, "back"},
                {"front", -90, 0, "right"}, {"front", 360, 0, "front"},
                {"left", 90, 0, "back"},    {"front", 0, -90, "bottom"},
                {"back", 0, 90, "top"},     {"top", 0, -90, "back"}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        for (int flat = 0; flat < 2; flat++) {
            const cw_camera a =
                fit(rows[n].from, rows[n].azimuth, rows[n].elevation, flat ? 0 : 30);
            const cw_camera b = fit(rows[n].to, 0, 0, flat ? 0 : 30);
            assert_alike(&a, &b);
        }
}

static void turns_keep_the_distance_and_add_up(void **state)
{
    (void)state;
    cw_error err = {0};
    const double z[3] = {0, 0, 2}, nowhere[3] = {0};
    const cw_camera start = fit("iso", 0, 0, 30);
    cw_camera c = start;
    for (int n = 1; n <= 9; n++) {
        double across[2] = {0};
        assert_ok(cw_camera_turn(&c, z, 40, &err), err);
        for (int a = 0; a < 2; a++)
            for (int b = 0; b < 2; b++)
                across[b] += pow((b ? c : start).eye[a] - start.target[a], 2);
        assert_within(across[0], across[1], 1e-12);
        assert_near(c.eye[2], start.eye[2], 1e-9);
    }
    assert_alike(&c, &start);
    const cw_camera front = fit("front", 0, 0, 30);
    c = front;
    assert_ok(cw_camera_turn(&c, front.up, 90, &err), err);
    assert_true(c.eye[0] > front.eye[0] + 10); /* to the picture's right */
    assert_fails(cw_camera_turn(&c, nowhere, 90, &err), CW_ERR_ARGUMENT, "(0, 0, 0)", err);
    assert_fails(cw_camera_turn(&c, z, NAN, &err), CW_ERR_ARGUMENT, "turn of nan", err);
}

/* The tangent of half the angle, and the height, shrink by the factor. */
static void zooms_are_exact(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_camera c = {.fov_deg = 90}, flat = {.height_mm = 60};
    assert_ok(cw_camera_zoom(&c, 2, &err), err);
    assert_near(tan(c.fov_deg * PI / 360), 0.5, 1e-12);
    assert_ok(cw_camera_zoom(&flat, 1.5, &err), err);
    assert_near(flat.height_mm, 40, 1e-12);
    assert_true(flat.fov_deg == 0);
    for (int n = 0; n < 3; n++)
        assert_fails(cw_camera_zoom(&c, (double[]){0, -1, NAN}[n], &err), CW_ERR_ARGUMENT,
                     "above 0", err);
}

static void impossible_angles_are_refused(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_camera c;
    cw_fit_desc d = around;
    d.elevation_deg = 91;
    assert_fails(cw_camera_fit(&d, &c, &err), CW_ERR_ARGUMENT, "elevation of 91", err);
    d.elevation_deg = 0;
    d.azimuth_deg = INFINITY;
    assert_fails(cw_camera_fit(&d, &c, &err), CW_ERR_ARGUMENT, "azimuth of inf", err);
}

static void files_are_read_back_to_the_bit(void **state)
{
    (void)state;
    cw_error err = {0};
    for (int flat = 0; flat < 2; flat++) {
        cw_camera c = fit("iso", 12.3, 45.6, flat ? 0 : 31.4), back = {0};
        c.height_mm = flat ? c.height_mm : 0;
        assert_ok(cw_camera_write(test_path("c.json"), &c, &err), err);
        assert_ok(cw_camera_read(test_path("c.json"), &back, &err), err);
        assert_memory_equal(&c, &back, sizeof c);
        assert_int_equal(test_folder_entries(), 1);
    }
    const cw_camera blind = {.fov_deg = 30, .up = {0, 0, 1}};
    assert_fails(cw_camera_write(test_path("c.json"), &blind, &err), CW_ERR_ARGUMENT, "apart",
                 err);
}

/* Texts are what is in files, and as exact, with the longest numbers too. */
static void texts_are_what_files_hold(void **state)
{
    (void)state;
    cw_error err = {0};
    const double far = -1.2345678901234567e-300, up = -9.8765432109876543e-200;
    const cw_camera all[] = {
        fit("iso", 12.3, 45.6, 31.4),
        {{far, 1 / 3.0, -0.0}, {2 / 3.0, far, 5}, {up, 1, up}, .height_mm = 1 / 7.0}};
    for (int n = 0; n < 2; n++) {
        cw_camera c = all[n], back = {0};
        char text[CW_CAMERA_TEXT];
        size_t size;
        c.height_mm = n ? c.height_mm : 0;
        assert_ok(cw_camera_format(&c, text, &err), err);
        assert_ok(cw_camera_parse(text, &back, &err), err);
        assert_memory_equal(&c, &back, sizeof c);
        assert_ok(cw_camera_write(test_path("c.json"), &c, &err), err);
        char *file = test_file_read(test_path("c.json"), &size);
        assert_int_equal(size, strlen(text));
        assert_memory_equal(file, text, size);
        free(file);
    }
    cw_camera back;
    char text[CW_CAMERA_TEXT];
    assert_fails(cw_camera_parse("{\n]", &back, &err), CW_ERR_FORMAT, "line 2, column 1", err);
    assert_fails(cw_camera_format(&(cw_camera){0}, text, &err), CW_ERR_ARGUMENT, "apart", err);
}

static void bad_files_are_told_apart(void **state)
{
    (void)state;
#define START "{\"schema\": \"cubewright-camera-1\""
    static const struct {
        const char *text, *words;
    } rows[] = {
        {START "}", "'eye': [x, y, z] in mm was expected"},
        {START ", \"eye\": [0, 1]}", "'eye': [x, y, z]"},
        {START ", \"eye\": [0, 1, \"2\"]}", "'eye': [x, y, z]"},
        {START ", \"eye\": [0, 0, 0], \"target\": [0, 1, 0], \"up\": [0, 0, 1]}",
         "either 'fov_deg' (perspective) or 'height_mm'"},
        {START ", \"eye\": [0, 0, 0], \"target\": [0, 1, 0], \"up\": [0, 0, 1], "
               "\"fov_deg\": 30, \"height_mm\": 2}",
         "either 'fov_deg' (perspective) or 'height_mm'"},
        {START ", \"eye\": [0, 0, 0], \"target\": [0, 1, 0], \"up\": [0, 0, 1], "
               "\"fov_deg\": 0}",
         "'fov_deg' is 0: above 0"},
        {START ", \"eye\": [0, 0, 0], \"target\": [0, 1, 0], \"up\": [0, 2, 0], "
               "\"fov_deg\": 30}",
         "up is along its line of sight"},
        {START ", \"look\": 3}", "'look' is no key; there are schema, eye, target, up"},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_error err = {0};
        cw_camera c;
        test_file_write(test_path("bad.json"), rows[n].text, strlen(rows[n].text));
        assert_fails(cw_camera_read(test_path("bad.json"), &c, &err), CW_ERR_FORMAT,
                     rows[n].words, err);
        assert_int_equal(err.status, CW_ERR_FORMAT);
    }
}

#define CASE(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)

int main(void)
{
    const struct CMUnitTest tests[] = {
        CASE(boxes_just_fit_into_the_picture),    CASE(angles_lead_from_view_to_view),
        CASE(turns_keep_the_distance_and_add_up), CASE(zooms_are_exact),
        CASE(impossible_angles_are_refused),      CASE(files_are_read_back_to_the_bit),
        CASE(texts_are_what_files_hold),          CASE(bad_files_are_told_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
