/* Tests shadows of volumes: on paper in a solid, as convergence to the reference, and errors. */
#include "support/pictures.h"

#include "viewer/scene/gradient_volume.h"
#include "viewer/scene/shadow_volume.h"

#include <math.h>
#include <string.h>

enum { SIDE = 41, COUNT = SIDE * SIDE * SIDE };

static const double cube[3] = {1, 1, 1};

/* Takes a tenth of the light a millimetre. */
static const cw_transfer haze = {
    .opacity_count = 2, .opacities = {{-9, 0.1f}, {9, 0.1f}}, .unit_mm = 1};

/* The light comes from the right of the picture, +x in the world, of a box seen from the front. */
static cw_scene scene_of(const cw_volume *box, cw_shadow shadow)
{
    return (cw_scene){.mode = CW_MODE_VBUFFER,
                      .volume = box,
                      .transfer = &haze,
                      .camera = {.eye = {0, -500, 0}, .up = {0, 0, 1}, .height_mm = 10},
                      .lights = {{{2, 0, 0}, {1, 1, 1}}},
                      .light_count = 1,
                      .width = 8,
                      .height = 8,
                      .lit = true,
                      .shadow = shadow};
}

static size_t take_shadows(const cw_scene *scene, cwi_shadow_volume *made)
{
    cwi_frame frame;
    cw_error err = {0};
    assert_ok(cwi_frame_init(&frame, scene, &err), err);
    assert_ok(cwi_shadow_volume_take(made, &frame, &err), err);
    assert_ptr_equal(frame.shadows, made->values);
    return frame.shadow_version;
}

/* Samples stand 1.5, 2.5, ... mm from a voxel, up to the volume's end. */
static void shadows_deepen_along_the_light(void **state)
{
    (void)state;
    cw_volume box = {0};
    cwi_shadow_volume one = {0}, two = {0}, cut = {0};
    test_field(&box, SIDE, SIDE, SIDE, cube, test_constant);
    cw_scene scene = scene_of(&box, CW_SHADOW_LIGHT);
    scene.threads = 1;
    take_shadows(&scene, &one);
    scene.threads = 2;
    take_shadows(&scene, &two);
    assert_memory_equal(one.values, two.values, COUNT * sizeof(float));
    scene.clips[scene.clip_count++] = (cw_clip){{-1, 0, 0}, -10}; /* x <= 10: voxel 30 */
    take_shadows(&scene, &cut);
    for (size_t n = 0; n < COUNT; n += 7) {
        const size_t x = n % SIDE;
        if (x % 2)
            continue;
        const double samples = floor((double)(SIDE - 1 - x) - 0.5);
        const double kept = floor(30 - (double)x - 0.5);
        assert_near((double)one.values[n], pow(0.9, fmax(samples, 0)), 1e-4);
        assert_near((double)cut.values[n], pow(0.9, fmax(kept, 0)), 1e-4);
    }
    for (size_t x = 1; x + 1 < SIDE; x += 2) /* odd ones are interpolated */
        assert_near((double)one.values[x],
                    0.5 * (double)(one.values[x - 1] + one.values[x + 1]), 1e-6);
    cwi_shadow_volume_free(&one);
    cwi_shadow_volume_free(&two);
    cwi_shadow_volume_free(&cut);
    cw_volume_free(&box);
}

/* In the middle of a solid all 14 rays are dark, of 10 samples and a half; a corner is open. */
static void occlusion_is_the_mean_of_rays(void **state)
{
    (void)state;
    cw_volume box = {0};
    cwi_shadow_volume made = {0};
    test_field(&box, SIDE, SIDE, SIDE, cube, test_constant);
    cw_scene scene = scene_of(&box, CW_SHADOW_AMBIENT);
    const size_t first = take_shadows(&scene, &made);
    const size_t middle = ((size_t)20 * SIDE + 20) * SIDE + 20;
    assert_near((double)made.values[middle], 2 * pow(0.9, 11), 1e-4);
    assert_near((double)made.values[0], 1, 1e-6);
    scene.camera.eye[0] = 100; /* the same from elsewhere */
    assert_int_equal(take_shadows(&scene, &made), first);
    scene.clips[scene.clip_count++] = (cw_clip){{-1, 0, 0}, -10};
    assert_true(take_shadows(&scene, &made) != first);
    cwi_shadow_volume_free(&made);
    cw_volume_free(&box);
}

static void modes_converge_to_the_reference(void **state)
{
    (void)state;
    static const cw_mode modes[] = {CW_MODE_COMPOSITE, CW_MODE_TEXTURE, CW_MODE_VBUFFER};
    cw_volume blobs = {0};
    cw_renderer *r;
    cw_error err = {0};
    const cw_transfer soft = test_soft_transfer();
    (void)test_renderer(); /* skips without OpenGL */
    assert_ok(cw_renderer_new(CW_BACKEND_AUTO, &r, &err), err);
    test_field(&blobs, 40, 40, 40, cube, test_blobs);
    for (int n = 0; n < 3; n++) {
        cw_scene scene = {
            .mode = CW_MODE_REFERENCE,
            .volume = &blobs,
            .transfer = &soft,
            .lights = {{{1, 1, 0.3}, {1, 1, 1}}, {{-1, 0, 1}, {0.2f, 0.2f, 0.3f}}},
            .light_count = 2,
            .width = 64,
            .height = 64,
            .lit = true,
            .shadow = (cw_shadow)n};
        cw_picture truth = test_draw(r, &scene);
        scene.sampling.step_vox = 0.25;
        for (int m = 0; m < 3; m++) {
            scene.mode = modes[m];
            cw_picture picture = test_draw(r, &scene);
            assert_true(test_compare(&picture, &truth).rmse < 0.1);
            scene.shadow = n ? CW_SHADOW_NONE : CW_SHADOW_LIGHT;
            cw_picture other = test_draw(r, &scene);
            assert_true(test_compare(&picture, &other).rmse > 1);
            scene.shadow = (cw_shadow)n;
            cw_picture_free(&picture);
            cw_picture_free(&other);
        }
        cw_picture_free(&truth);
    }
    cw_volume_free(&blobs);
    cw_renderer_free(r);
}

static void unusable_scenes_are_named(void **state)
{
    (void)state;
    cw_volume box = {0};
    cw_renderer *r;
    cw_picture picture;
    cw_error err = {0};
    double coordinates[SIDE];
    assert_ok(cw_renderer_new(CW_BACKEND_CPU, &r, &err), err);
    test_field(&box, SIDE, SIDE, SIDE, cube, test_constant);
    cw_scene scene = scene_of(&box, CW_SHADOW_LIGHT);
    scene.mode = CW_MODE_PROJECTION;
    assert_fails(cw_render(r, &scene, &picture, &err), CW_ERR_UNSUPPORTED,
                 "the mode projection has no shadows", err);
    scene.mode = CW_MODE_VBUFFER;
    scene.shadow = (cw_shadow)9;
    assert_fails(cw_render(r, &scene, &picture, &err), CW_ERR_ARGUMENT, "shadow is 9", err);
    scene.shadow = CW_SHADOW_AMBIENT;
    for (int n = 0; n < SIDE; n++)
        coordinates[n] = n * n;
    for (int a = 0; a < 3; a++)
        box.coordinates[a] = coordinates;
    assert_fails(cw_render(r, &scene, &picture, &err), CW_ERR_UNSUPPORTED,
                 "shadows fall in evenly spaced volumes", err);
    for (int a = 0; a < 3; a++)
        box.coordinates[a] = NULL;
    cw_volume_free(&box);
    cw_renderer_free(r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(shadows_deepen_along_the_light),
                                       cmocka_unit_test(occlusion_is_the_mean_of_rays),
                                       cmocka_unit_test(modes_converge_to_the_reference),
                                       cmocka_unit_test(unusable_scenes_are_named)};
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
