/* Tests surfaces between materials [Drebin1988], and smoothed gradients: on paper, as
 * convergence to the reference in every mode, and in memory. */
#include "support/integral.h"

#include "viewer/scene/gradient_volume.h"

#include <math.h>
#include <string.h>

enum { SIDE = 33 };

static const double cube[3] = {1, 1, 1};

/* Draws with whichever backend has the mode. */
static cw_picture draw_by_any(const cw_scene *scene)
{
    cw_renderer *r;
    cw_error err = {0};
    assert_ok(cw_renderer_new(CW_BACKEND_AUTO, &r, &err), err);
    cw_picture picture = test_draw(r, scene);
    cw_renderer_free(r);
    return picture;
}

static double rise_along_y(const double p[3], const double q[3])
{
    (void)p;
    return q[1];
}

/* Two materials of the same opacity that mix over the whole volume. */
static cw_transfer mixed_transfer(void)
{
    const cw_material_class materials[] = {
        {{-INFINITY, -INFINITY, 0, 1}, {0.2f, 0.4f, 1}, 0.05f, 1},
        {{0, 1, INFINITY, INFINITY}, {0.8f, 0.4f, 0}, 0.05f, 9}};
    cw_transfer t = {.unit_mm = 1, .surface_mm = 1.5};
    cw_error err = {0};
    assert_ok(cw_transfer_set_materials(&t, materials, 2, &err), err);
    return t;
}

/* The index rises by 8 over 32 mm: surfaces 1.5 mm wide have the strength 0.375. Seen along the
 * gradient, with the light behind the eye, a point reflects (0.25 + 0.75 S) C + 0.2 S; colours
 * are linear along a ray of constant extinction. */
static void reflection_grows_with_the_change_of_the_index(void **state)
{
    (void)state;
    (void)test_renderer(); /* skips without OpenGL */
    cw_volume ramp = {0};
    const cw_transfer t = mixed_transfer();
    const double length = SIDE - 1, k = -log(0.95), strength = 0.375;
    const double light = 0.25 + 0.75 * strength, seen = 1 - exp(-k * length);
    /* the mean of x over the ray, weighted by the light that leaves it: x from 0 to 1 */
    const double mean = 1 / (k * length) - exp(-k * length) / seen;
    test_field(&ramp, 17, SIDE, 19, cube, rise_along_y);
    for (int n = 0; n < 4; n++) {
        static const cw_mode modes[] = {CW_MODE_REFERENCE, CW_MODE_VBUFFER, CW_MODE_COMPOSITE,
                                        CW_MODE_PROJECTION};
        static const double bounds[] = {1e-6, 1e-3, 1e-3, 1e-3};
        const cw_scene scene = {
            .mode = modes[n],
            .volume = &ramp,
            .transfer = &t,
            .camera = {.eye = {0, -500, 0}, .up = {0, 0, 1}, .height_mm = 10},
            .width = 8,
            .height = 8,
            .lit = true,
            .sampling.step_vox = 0.25,
            .sampling.stop_opacity = 1};
        cw_picture picture = draw_by_any(&scene);
        for (size_t p = 0; p < 64; p++) {
            assert_near((double)picture.pixels[4 * p + 3], seen, 1e-5);
            for (size_t c = 0; c < 3; c++) {
                const double a = (double[]){0.2, 0.4, 1}[c], b = (double[]){0.8, 0.4, 0}[c];
                const double color = seen * (light * (a + (b - a) * mean) + 0.2 * strength);
                assert_near((double)picture.pixels[4 * p + c], color, bounds[n]);
            }
        }
        cw_picture_free(&picture);
    }
    cw_volume_free(&ramp);
}

/* Three materials, whose insides are thinner than their surfaces. */
static cw_transfer blob_transfer(void)
{
    const cw_material_class materials[] = {
        {{-INFINITY, -INFINITY, 0.2, 0.45}, {0, 0, 0}, 0, 0},
        {{0.2, 0.45, 0.5, 0.75}, {0.4f, 0.6f, 0.9f}, 0.05f, 2},
        {{0.5, 0.75, INFINITY, INFINITY}, {0.95f, 0.75f, 0.2f}, 0.4f, 5}};
    cw_transfer t = {.gradient_count = 2, .gradients = {{0, 0.2f}, {1, 1}}};
    cw_error err = {0};
    assert_ok(cw_transfer_set_materials(&t, materials, 3, &err), err);
    return t;
}

/* Every mode that shades comes to the reference of the same model: of 255, at steps of a
 * half and an eighth. Splats blur, by their width. */
static void modes_converge_to_the_reference(void **state)
{
    (void)state;
    static const struct {
        cw_mode mode;
        double coarse, fine;
    } rows[] = {{CW_MODE_COMPOSITE, 0.2, 0.02},     {CW_MODE_TEXTURE, 0.2, 0.03},
                {CW_MODE_SHADED_TEXTURE, 0.5, 0.5}, {CW_MODE_PROJECTION, 0.5, 0.5},
                {CW_MODE_VBUFFER, 0.05, 0.05},      {CW_MODE_SPLAT, 8, 8},
                {CW_MODE_SPLAT_TREE, 8, 8}};
    (void)test_renderer(); /* skips without OpenGL */
    cw_volume blobs = {0};
    const cw_transfer t = blob_transfer();
    const double spacing[3] = {1, 0.8, 1.3};
    test_field(&blobs, 40, 40, 40, spacing, test_blobs);
    for (int smooth = 0; smooth < 2; smooth++) {
        cw_scene scene = {.mode = CW_MODE_REFERENCE,
                          .volume = &blobs,
                          .transfer = &t,
                          .width = 64,
                          .height = 64,
                          .lit = true,
                          .gradient_sigma = smooth ? 1.2 : 0};
        cw_picture truth = draw_by_any(&scene);
        for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
            scene.mode = rows[n].mode;
            scene.sampling.step_vox = 0.5;
            cw_picture coarse = draw_by_any(&scene);
            scene.sampling.step_vox = 0.125;
            cw_picture fine = draw_by_any(&scene);
            const double gaps[] = {test_compare(&coarse, &truth).rmse,
                                   test_compare(&fine, &truth).rmse};
            if (!(gaps[0] < rows[n].coarse && gaps[1] < rows[n].fine))
                fail_msg("%s is %g and %g from the reference", cw_mode_name(rows[n].mode),
                         gaps[0], gaps[1]);
            cw_picture_free(&coarse);
            cw_picture_free(&fine);
        }
        cw_picture_free(&truth);
    }
    cw_volume_free(&blobs);
}

/* Volumes of colour and opacity, composited: by the definition, and lit slices of them. */
static void colors_of_voxels_have_a_reference(void **state)
{
    (void)state;
    (void)test_renderer(); /* skips without OpenGL */
    cw_volume blobs = {0};
    cw_transfer t = blob_transfer();
    test_field(&blobs, 30, 30, 30, cube, test_blobs);
    cw_scene scene = {.mode = CW_MODE_REFERENCE,
                      .volume = &blobs,
                      .transfer = &t,
                      .width = 48,
                      .height = 48,
                      .texture.colors_first = true,
                      .lit = true};
    cw_picture truth = draw_by_any(&scene);
    scene.mode = CW_MODE_TEXTURE;
    for (int n = 0; n < 2; n++) {
        scene.sampling.step_vox = n ? 0.125 : 0.5;
        cw_picture slices = draw_by_any(&scene);
        assert_true(test_compare(&slices, &truth).rmse < (n ? 0.1 : 0.3));
        cw_picture_free(&slices);
    }
    cw_picture_free(&truth);
    t.gradient_count = 0;
    scene.mode = CW_MODE_REFERENCE;
    scene.lit = false;
    truth = test_integral(&scene, 0.02);
    cw_picture reference = draw_by_any(&scene);
    assert_true(test_compare(&reference, &truth).max < 0.01);
    scene.texture.colors_first = false;
    cw_picture data = draw_by_any(&scene);
    assert_true(test_compare(&data, &truth).max > 2);
    cw_picture_free(&data);
    cw_picture_free(&reference);
    cw_picture_free(&truth);
    cw_volume_free(&blobs);
}

static double wave_along_y(const double p[3], const double q[3])
{
    (void)p;
    return sin(2 * 3.14159265358979 * 4 * q[1]);
}

/* Smooths a frame's volume; returns the version of the result. */
static size_t smooth_volume(const cw_volume *v, double sigma, int threads,
                            cwi_gradient_volume *made)
{
    const cw_transfer t = test_soft_transfer();
    const cw_scene scene = {.mode = CW_MODE_VBUFFER,
                            .volume = v,
                            .transfer = &t,
                            .lit = true,
                            .threads = threads,
                            .gradient_sigma = sigma};
    cwi_frame frame;
    cw_error err = {0};
    assert_ok(cwi_frame_init(&frame, &scene, &err), err);
    assert_ok(cwi_gradient_volume_take(made, &frame, &err), err);
    return frame.gradient_version;
}

/* A Gaussian of s voxels lessens a wave of w radians a voxel by exp(-w^2 s^2 / 2). The spacing
 * along y is twice the smallest, so s is half of what was requested. */
static void smoothing_is_that_of_a_gaussian(void **state)
{
    (void)state;
    cw_volume wave = {0};
    cwi_gradient_volume one = {0}, two = {0};
    const double spacing[3] = {1, 2, 1}, w = 2 * 3.14159265358979 * 4 / 64;
    const double factor = exp(-0.5 * w * w * 1.5 * 1.5);
    test_field(&wave, 5, 65, 4, spacing, wave_along_y);
    smooth_volume(&wave, 3, 1, &one);
    smooth_volume(&wave, 3, 2, &two);
    for (size_t n = 0; n < (size_t)5 * 65 * 4; n++) {
        const size_t y = n / 5 % 65;
        if (y >= 6 && y < 65 - 6)
            assert_near((double)one.values[n], factor * sin(w * (double)y), 2e-3);
    }
    assert_memory_equal(one.values, two.values, (size_t)5 * 65 * 4 * sizeof(float));
    cwi_gradient_volume_free(&one);
    cwi_gradient_volume_free(&two);
    cw_volume_free(&wave);
}

/* Voxels without a value keep none, and do not count for others. */
static void smoothing_leaves_gaps(void **state)
{
    (void)state;
    cw_volume box = {0};
    cwi_gradient_volume made = {0};
    test_field(&box, 9, 8, 7, cube, test_constant);
    float *values = (float *)(uintptr_t)box.data;
    for (size_t n = 0; n < 9 * 8 * 7; n += 11)
        values[n] = NAN;
    const size_t first = smooth_volume(&box, 1, 0, &made);
    for (size_t n = 0; n < 9 * 8 * 7; n++)
        if (n % 11 == 0)
            assert_true(isnan(made.values[n]));
        else
            assert_near((double)made.values[n], 1, 1e-6);
    assert_int_equal(smooth_volume(&box, 1, 0, &made), first); /* kept */
    assert_true(smooth_volume(&box, 2, 0, &made) != first);
    assert_int_equal(smooth_volume(&box, 0, 0, &made), 0);
    cwi_gradient_volume_free(&made);
    cw_volume_free(&box);
}

/* A factor of gradients refers to the index: what is picked is what is drawn. */
static void picking_sees_surfaces(void **state)
{
    (void)state;
    cw_volume ramp = {0};
    cw_transfer t = mixed_transfer();
    cw_picked picked;
    cw_error err = {0};
    test_field(&ramp, 17, SIDE, 19, cube, rise_along_y);
    t.gradient_count = 3;
    t.gradients[0] = (cw_opacity_point){0, 1};
    t.gradients[1] = (cw_opacity_point){0.374, 1};
    t.gradients[2] = (cw_opacity_point){0.375, 0};
    cw_scene scene = {.mode = CW_MODE_VBUFFER,
                      .volume = &ramp,
                      .transfer = &t,
                      .camera = {.eye = {0, -500, 0}, .up = {0, 0, 1}, .height_mm = 10},
                      .width = 8,
                      .height = 8};
    t.surface_mm = 1;
    assert_ok(cw_pick(&scene, (double[]){4.5, 4.5}, &picked, &err), err);
    assert_int_equal(picked.kind, CW_PICK_VOLUME);
    t.surface_mm = 1.51;
    assert_ok(cw_pick(&scene, (double[]){4.5, 4.5}, &picked, &err), err);
    assert_int_equal(picked.kind, CW_PICK_NOTHING);
    cw_volume_free(&ramp);
}

static void unusable_settings_are_named(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_volume box = {0};
    const cw_transfer t = test_soft_transfer();
    cw_picture picture;
    cw_error err = {0};
    test_field(&box, 9, 8, 7, cube, test_constant);
    cw_scene scene = {.mode = CW_MODE_VBUFFER, .volume = &box, .transfer = &t, .lit = true};
    for (int n = 0; n < 3; n++) {
        scene.gradient_sigma = (double[]){-1, 17, NAN}[n];
        assert_fails(cw_render(r, &scene, &picture, &err), CW_ERR_ARGUMENT, "gradient_sigma",
                     err);
    }
    const double coordinates[9] = {0, 1, 2, 3, 4, 5, 6, 7, 9};
    scene.gradient_sigma = 1;
    for (int a = 0; a < 3; a++)
        box.coordinates[a] = coordinates;
    assert_fails(cw_render(r, &scene, &picture, &err), CW_ERR_UNSUPPORTED,
                 "gradients are smoothed on evenly spaced volumes", err);
    for (int a = 0; a < 3; a++)
        box.coordinates[a] = NULL;
    cw_volume_free(&box);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reflection_grows_with_the_change_of_the_index),
        cmocka_unit_test(modes_converge_to_the_reference),
        cmocka_unit_test(colors_of_voxels_have_a_reference),
        cmocka_unit_test(smoothing_is_that_of_a_gaussian),
        cmocka_unit_test(smoothing_leaves_gaps),
        cmocka_unit_test(picking_sees_surfaces),
        cmocka_unit_test(unusable_settings_are_named)};
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
