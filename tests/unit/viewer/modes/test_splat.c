/* Tests splatting: sums of footprints, opacity along the path, and errors against ray
 * casting. */
#include "support/views.h"

#include <math.h>

enum { EDGE = 32, SIZE = 48 };

static const double cube[3] = {1, 1, 1};

static cw_scene scene_of(const cw_volume *volume, const cw_transfer *transfer, cw_camera camera)
{
    return (cw_scene){.mode = CW_MODE_SPLAT,
                      .volume = volume,
                      .transfer = transfer,
                      .camera = camera,
                      .width = SIZE,
                      .height = SIZE};
}

/* The optical depth of a constant box in its middle: footprints add up to a plane, at all
 * scales between a voxel that is a third of a pixel and one that is many. */
static void footprints_add_up_to_one(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_volume box = {0};
    const cw_transfer flat = test_flat_transfer();
    const double sizes[] = {3, 6.5, 24, 64, 144}; /* voxels the picture covers */
    test_field(&box, EDGE, EDGE, EDGE, cube, test_constant);
    cw_renderer_forget(r);
    for (int n = 0; n < 5; n++) {
        const cw_scene scene = scene_of(&box, &flat, test_view(90 * (n % 2), 0, 0, sizes[n]));
        cw_picture picture = test_draw(r, &scene);
        const double truth = -log(1 - 0.05) * (EDGE - 1), half = (EDGE - 1) / 2.0 - 3;
        double low = INFINITY, high = 0, sum = 0, count = 0;
        for (size_t p = 0; p < SIZE * SIZE; p++) {
            const double x = ((double)(p % SIZE) + 0.5 - SIZE / 2.0) / SIZE * sizes[n];
            const double y = ((double)(p / SIZE) + 0.5 - SIZE / 2.0) / SIZE * sizes[n];
            if (fabs(x) > half || fabs(y) > half)
                continue;
            const double alpha = (double)picture.pixels[4 * p + 3], depth = -log(1 - alpha);
            low = fmin(low, depth);
            high = fmax(high, depth);
            sum += depth;
            count++;
            assert_true(fabs(alpha - (1 - exp(-truth))) < 1 / 255.0);
        }
        assert_true(high - low <= 0.01 * truth);
        assert_true(fabs(sum / count - truth) <= 0.005 * truth);
        cw_picture_free(&picture);
    }
    cw_volume_free(&box);
}

/* Oblique and in perspective the path is longer, and the middle of the picture still right. */
static void opacity_follows_the_path(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_volume box = {0};
    const cw_transfer flat = test_flat_transfer();
    test_field(&box, EDGE, EDGE, EDGE, cube, test_constant);
    cw_renderer_forget(r);
    for (int n = 0; n < 8; n++) {
        const cw_camera camera = test_view(11 * n, n < 4 ? 7 * n : 0, n % 2 ? 30 : 0, 60);
        const cw_scene scene = scene_of(&box, &flat, camera);
        cw_picture picture = test_draw(r, &scene), truth = test_truth(r, &scene);
        const size_t middle = 4 * (SIZE / 2 * SIZE + SIZE / 2) + 3;
        assert_true(fabs((double)(picture.pixels[middle] - truth.pixels[middle])) < 1 / 255.0);
        cw_picture_free(&picture);
        cw_picture_free(&truth);
    }
    cw_volume_free(&box);
}

/* A Gaussian blurs by its width: the error falls with the square of the spacing. */
static void error_falls_with_the_spacing(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    double before = 0;
    for (int n = 0; n < 3; n++) {
        const size_t edge = (size_t[]){17, 33, 65}[n];
        const double spacing = 64 / (double)(edge - 1);
        cw_transfer soft = test_soft_transfer();
        cw_volume blobs = {0};
        test_field(&blobs, edge, edge, edge, (double[]){spacing, spacing, spacing}, test_blobs);
        cw_renderer_forget(r);
        soft.unit_mm = 1;
        cw_scene scene = scene_of(&blobs, &soft, test_view(30, 25, 30, 100));
        scene.width = scene.height = 160; /* pixels are smaller than voxels */
        const double rmse = test_error(r, &scene).rmse;
        if (n > 0 && !(rmse < before / 2.5))
            fail_msg("%zu voxels along an edge: rmse %g after %g", edge, rmse, before);
        before = rmse;
        cw_volume_free(&blobs);
    }
    assert_true(before < 1.5);
}

static void reverse(cw_volume *v)
{
    const size_t n = v->dim[0];
    float *voxels = cw_volume_voxels(v);
    for (size_t row = 0; row < v->dim[1] * v->dim[2]; row++)
        for (size_t i = 0; i < n / 2; i++) {
            float *a = &voxels[row * n + i], *b = &voxels[row * n + n - 1 - i];
            const float keep = *a;
            *a = *b;
            *b = keep;
        }
    v->affine[0][0] *= -1;
    v->affine[0][3] *= -1;
}

/* The same world, told in other units or the other way round, is the same picture. */
static void scale_and_handedness_do_not_matter(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const cw_transfer soft = test_soft_transfer();
    cw_picture first = {0};
    for (int n = 0; n < 4; n++) {
        const double scale = (double[]){1, 1e-3, 1e3, 1}[n];
        const double spacing[3] = {scale, 1.5 * scale, 2 * scale};
        cw_volume blobs = {0};
        test_field(&blobs, EDGE, EDGE, EDGE, spacing, test_blobs);
        if (n == 3)
            reverse(&blobs);
        cw_renderer_forget(r);
        cw_scene scene = scene_of(&blobs, &soft, test_view(30, 25, 30, 90 * scale));
        scene.lit = true;
        cw_picture picture = test_draw(r, &scene);
        if (n == 0) {
            first = picture;
        } else {
            assert_true(test_compare(&picture, &first).max < 0.1);
            cw_picture_free(&picture);
        }
        cw_volume_free(&blobs);
    }
    cw_picture_free(&first);
}

/* Anisotropic and sheared grids, light, gradients, fog, planes: near ray casting. */
static void settings_are_near_ray_casting(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    for (int n = 0; n < 8; n++) {
        cw_transfer soft = test_soft_transfer();
        cw_volume blobs = {0};
        const double thin[3] = {1, 2, 0.5};
        test_field(&blobs, EDGE, EDGE, EDGE, n < 2 ? thin : cube, test_blobs);
        cw_renderer_forget(r);
        cw_scene scene = scene_of(&blobs, &soft, test_view(30, 25, n % 2 ? 0 : 30, 60));
        if (n < 2)
            soft.unit_mm = 1;
        if (n == 1 || n == 2) {
            blobs.affine[0][1] = 0.5 * blobs.affine[1][1];
            blobs.affine[0][3] -= 0.5 * blobs.affine[1][1] * (EDGE - 1) / 2;
        }
        scene.lit = n == 3;
        if (n == 4) {
            soft.gradient_count = 2;
            soft.gradients[1] = (cw_opacity_point){0.05, 1};
        }
        if (n == 5) {
            scene.depth_cue = 0.8f;
            scene.background[0][0] = 1;
        }
        if (n == 6 || n == 7) {
            scene.clip_count = 1;
            scene.clips[0] = (cw_clip){{0, -1, 0.1}, -3.3};
            scene.cut_away = n == 7;
        }
        const test_gap gap = test_error(r, &scene);
        if (gap.rmse > 4)
            fail_msg("setting %d: rmse %g, max %g", n, gap.rmse, gap.max);
        cw_volume_free(&blobs);
    }
}

/* Planes that keep all, and none. */
static void clips_take_whole_voxels(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const cw_transfer soft = test_soft_transfer();
    cw_volume blobs = {0};
    test_field(&blobs, EDGE, EDGE, EDGE, cube, test_blobs);
    cw_renderer_forget(r);
    cw_scene scene = scene_of(&blobs, &soft, test_view(30, 25, 30, 50));
    cw_picture all = test_draw(r, &scene);
    scene.clip_count = 1;
    scene.clips[0] = (cw_clip){{1, 1, 1}, -1000};
    cw_picture kept = test_draw(r, &scene);
    scene.cut_away = true;
    cw_picture none = test_draw(r, &scene);
    assert_true(test_compare(&all, &kept).max == 0);
    for (size_t p = 0; p < SIZE * SIZE * 4; p++)
        assert_true(none.pixels[p] == 0);
    cw_picture_free(&all);
    cw_picture_free(&kept);
    cw_picture_free(&none);
    cw_volume_free(&blobs);
}

/* Voxels without a value are holes, and halve what the faces of their neighbours stand for:
 * behind a wall of them a box goes on as if it began there. */
static void nodata_is_left_out(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const cw_transfer flat = test_flat_transfer();
    cw_volume box = {0};
    test_field(&box, EDGE, EDGE, EDGE, cube, test_constant);
    float *voxels = cw_volume_voxels(&box);
    for (size_t n = 0; n < EDGE * EDGE * EDGE; n++)
        if (n / EDGE % EDGE == 10)
            voxels[n] = NAN;
    cw_renderer_forget(r);
    const cw_scene scene = scene_of(&box, &flat, test_view(0, 0, 0, 10));
    cw_picture picture = test_draw(r, &scene);
    const double alpha = 1 - pow(1 - 0.05, EDGE - 1 - 2);
    for (size_t p = 0; p < SIZE * SIZE; p++)
        assert_true(fabs((double)picture.pixels[4 * p + 3] - alpha) < 1 / 255.0);
    cw_picture_free(&picture);
    cw_volume_free(&box);
}

/* One voxel thick is one voxel's path. */
static void slab_has_its_thickness(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const cw_transfer flat = test_flat_transfer();
    cw_volume slab = {0};
    test_field(&slab, EDGE, 1, EDGE, cube, test_constant);
    cw_renderer_forget(r);
    const cw_scene scene = scene_of(&slab, &flat, test_view(0, 0, 0, 10));
    cw_picture picture = test_draw(r, &scene);
    for (size_t p = 0; p < SIZE * SIZE; p++)
        assert_true(fabs((double)picture.pixels[4 * p + 3] - 0.05) < 0.0005);
    cw_picture_free(&picture);
    cw_volume_free(&slab);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(footprints_add_up_to_one),
        cmocka_unit_test(opacity_follows_the_path),
        cmocka_unit_test(error_falls_with_the_spacing),
        cmocka_unit_test(scale_and_handedness_do_not_matter),
        cmocka_unit_test(settings_are_near_ray_casting),
        cmocka_unit_test(clips_take_whole_voxels),
        cmocka_unit_test(nodata_is_left_out),
        cmocka_unit_test(slab_has_its_thickness),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
