/* Tests the renderer: lost contexts, replaced volumes, repeated pictures, and named
 * mistakes. */
#define _GNU_SOURCE /* RTLD_DEFAULT */
#include "support/pictures.h"

#include <dlfcn.h>
#include <math.h>

static const double cube[3] = {1, 1, 1};

/* A scene that every mode that needs a volume draws. */
static cw_scene small_scene(const cw_volume *volume, const cw_transfer *transfer)
{
    return (cw_scene){.mode = CW_MODE_COMPOSITE,
                      .volume = volume,
                      .transfer = transfer,
                      .width = 32,
                      .height = 32};
}

static unsigned lost(void)
{
    return 0x8253; /* GL_GUILTY_CONTEXT_RESET */
}

/* A reset that a driver reports is passed on, and the renderer can still be freed. */
static void lost_contexts_are_reported(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_renderer *r = test_renderer();
    cw_volume blobs = {0};
    cw_picture picture;
    const cw_transfer soft = test_soft_transfer();
    test_field(&blobs, 16, 16, 16, cube, test_blobs);
    const cw_scene scene = small_scene(&blobs, &soft);
    picture = test_draw(r, &scene);
    cw_picture_free(&picture);
    void *epoxy = dlopen("libepoxy.so.0", RTLD_NOW | RTLD_NOLOAD);
    assert_non_null(epoxy);
    unsigned (**status)(void) =
        (unsigned (**)(void))dlsym(epoxy, "epoxy_glGetGraphicsResetStatus");
    assert_non_null(status);
    unsigned (*const before)(void) = *status;
    *status = lost;
    assert_fails(cw_render(r, &scene, &picture, &err), CW_ERR_BACKEND, "lost", err);
    assert_null(picture.pixels);
    *status = before;
    picture = test_draw(r, &scene);
    cw_picture_free(&picture);
    dlclose(epoxy);
    cw_volume_free(&blobs);
}

/* A second volume takes the place of the first, and bricks that of a whole texture. */
static void volumes_take_each_others_place(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_volume blobs = {0}, ramp = {0};
    const cw_transfer soft = test_soft_transfer();
    test_field(&blobs, 33, 20, 17, cube, test_blobs);
    test_field(&ramp, 33, 20, 17, cube, test_ramp);
    cw_scene scene = small_scene(&blobs, &soft);
    scene.sampling.step_vox = 0.2; /* steps begin again in each brick */
    cw_picture first = test_draw(r, &scene);
    scene.volume = &ramp;
    cw_picture second = test_draw(r, &scene);
    assert_true(test_compare(&first, &second).max > 10);
    scene.volume = &blobs;
    scene.sampling.texture_edge = 9;
    cw_picture bricks = test_draw(r, &scene);
    assert_true(test_compare(&first, &bricks).max < 0.2);
    cw_picture_free(&first);
    cw_picture_free(&second);
    cw_picture_free(&bricks);
    cw_volume_free(&blobs);
    cw_volume_free(&ramp);
}

/* The same scene, the same bytes, from this renderer and another, which drew a lower picture before. */
static void pictures_repeat(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_renderer *other;
    cw_renderer *r = test_renderer();
    cw_volume blobs = {0};
    const cw_transfer soft = test_soft_transfer();
    test_field(&blobs, 32, 32, 32, cube, test_blobs);
    assert_ok(cw_renderer_new(CW_BACKEND_EGL, &other, &err), err);
    cw_scene low = small_scene(&blobs, &soft);
    low.height /= 2;
    cw_picture before = test_draw(other, &low);
    cw_picture_free(&before);
    for (int m = 0; m < CW_MODE_SLICES; m++) {
        cw_scene scene = small_scene(&blobs, &soft);
        scene.mode = (cw_mode)m;
        if (m == CW_MODE_MESH)
            continue;
        cw_picture a = test_draw(r, &scene), b = test_draw(other, &scene);
        assert_memory_equal(a.pixels, b.pixels, 32 * 32 * 4 * sizeof *a.pixels);
        cw_picture_free(&a);
        cw_picture_free(&b);
    }
    cw_renderer_free(other);
    cw_volume_free(&blobs);
}

/* Mistakes are named before anything is drawn. */
static void mistakes_are_named(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_renderer *cpu;
    cw_volume blobs = {0};
    cw_picture picture;
    const cw_transfer soft = test_soft_transfer();
    test_field(&blobs, 8, 8, 8, cube, test_blobs);
    assert_ok(cw_renderer_new(CW_BACKEND_CPU, &cpu, &err), err);
    const cw_scene good = small_scene(&blobs, &soft);
#define FAILS(status, words, ...)                                                              \
    do {                                                                                       \
        cw_scene bad = good;                                                                   \
        __VA_ARGS__;                                                                           \
        assert_fails(cw_render(cpu, &bad, &picture, &err), status, words, err);                \
        assert_null(picture.pixels);                                                           \
    } while (0)
    FAILS(CW_ERR_UNSUPPORTED, "composite", (void)bad);
    FAILS(CW_ERR_ARGUMENT, "transfer function", bad.transfer = NULL);
    FAILS(CW_ERR_ARGUMENT, "volume", bad.volume = NULL);
    FAILS(CW_ERR_ARGUMENT, "mesh", bad.mode = CW_MODE_MESH);
    FAILS(CW_ERR_ARGUMENT, "mode", bad.mode = CW_MODE_COUNT);
    FAILS(CW_ERR_ARGUMENT, "20000", bad.width = 20000);
    FAILS(CW_ERR_ARGUMENT, "samples", bad.samples = 5);
    FAILS(CW_ERR_ARGUMENT, "step", bad.sampling.step_vox = -1);
    FAILS(CW_ERR_ARGUMENT, "step", bad.sampling.step_vox = (double)NAN);
    FAILS(CW_ERR_ARGUMENT, "opacity", bad.sampling.stop_opacity = 2);
    FAILS(CW_ERR_ARGUMENT, "texture.direction_filter",
          bad.texture.direction_filter = CW_DIRECTIONS_COUNT);
    FAILS(CW_ERR_ARGUMENT, "depth_cue", bad.depth_cue = -1);
    FAILS(CW_ERR_ARGUMENT, "rising", bad.cue_range[0] = 2);
    FAILS(CW_ERR_ARGUMENT, "rising", bad.cue_range[1] = NAN);
    FAILS(CW_ERR_ARGUMENT, "form", bad.cue_form = CW_CUE_COUNT);
    FAILS(CW_ERR_ARGUMENT, "less than 1", bad.cue_form = CW_CUE_EXPONENTIAL; bad.depth_cue = 1);
    FAILS(CW_ERR_ARGUMENT, "light_count", bad.light_count = 9);
    FAILS(CW_ERR_ARGUMENT, "clip plane 0", bad.clip_count = 1);
    FAILS(CW_ERR_ARGUMENT, "camera", bad.camera.up[2] = 1);
#undef FAILS
    cw_renderer_free(cpu);
    assert_fails(cw_renderer_new((cw_backend)9, &cpu, &err), CW_ERR_ARGUMENT, "backend", err);
    cw_volume_free(&blobs);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lost_contexts_are_reported),
        cmocka_unit_test(volumes_take_each_others_place),
        cmocka_unit_test(pictures_repeat),
        cmocka_unit_test(mistakes_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
