/* Tests the kernels of splatting: sums of footprints, errors against ray casting, and nodes of
 * the octree that join voxels without a seam. */
#include "support/views.h"

#include <math.h>
#include <string.h>

enum { EDGE = 32, SIZE = 64 };

static const double cube[3] = {1, 1, 1};
static const char *const names[CW_SPLAT_COUNT] = {"gaussian", "polygon", "tent", "b-spline"};

static cw_scene scene_of(int kernel, const cw_volume *volume, const cw_transfer *transfer,
                         cw_camera camera)
{
    return (cw_scene){.mode = CW_MODE_SPLAT,
                      .splat.kernel = (cw_splat_kernel)kernel,
                      .volume = volume,
                      .transfer = transfer,
                      .camera = camera,
                      .width = SIZE,
                      .height = SIZE};
}

/* The ratio of the depths of a picture to the true ones: its mean, and how much it varies. */
static void measure_ripple(cw_renderer *r, const cw_scene *scene, double *mean, double *ripple)
{
    cw_picture picture = test_draw(r, scene), truth = test_truth(r, scene);
    double low = INFINITY, high = 0, sum = 0;
    for (size_t p = 0; p < SIZE * SIZE; p++) {
        const double ratio = log(1 - (double)picture.pixels[4 * p + 3]) /
                             log(1 - (double)truth.pixels[4 * p + 3]);
        low = fmin(low, ratio);
        high = fmax(high, ratio);
        sum += ratio;
    }
    *mean = sum / (SIZE * SIZE);
    *ripple = high - low;
    cw_picture_free(&picture);
    cw_picture_free(&truth);
}

/* In the middle of a constant box, footprints add up to its depth. The sum of B-splines is
 * constant; a Gaussian's varies by less than 1 %, that of its triangles by up to 10 %. */
static void sums_vary_as_they_should(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_volume box = {0};
    const cw_transfer flat = test_flat_transfer();
    const double most[CW_SPLAT_COUNT] = {0.01, 0.1, 1e-4, 1e-4};
    test_field(&box, EDGE, EDGE, EDGE, cube, test_constant);
    cw_renderer_forget(r);
    for (int kernel = 0; kernel < CW_SPLAT_COUNT; kernel++)
        for (int n = 0; n < 3; n++) {
            double mean, ripple;
            const cw_scene scene =
                scene_of(kernel, &box, &flat, test_view(13 * n, 5 * n, n % 2 ? 4 : 0, 6));
            measure_ripple(r, &scene, &mean, &ripple);
            if (ripple > most[kernel] || fabs(mean - 1) > 0.001)
                fail_msg("%s, view %d: mean %g, ripple %g", names[kernel], n, mean, ripple);
        }
    cw_volume_free(&box);
}

/* Against ray casting, in the order of their blur; wider ones blur more. */
static void errors_follow_the_blur(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_volume blobs = {0};
    const cw_transfer soft = test_soft_transfer();
    const double most[CW_SPLAT_COUNT] = {1.5, 1.7, 1.1, 1.35};
    test_field(&blobs, EDGE, EDGE, EDGE, cube, test_blobs);
    cw_renderer_forget(r);
    for (int kernel = 0; kernel < CW_SPLAT_COUNT; kernel++) {
        cw_scene scene = scene_of(kernel, &blobs, &soft, test_view(30, 25, 30, 50));
        const double usual = test_error(r, &scene).rmse;
        scene.lit = true;
        const double lit = test_error(r, &scene).rmse;
        scene.lit = false;
        scene.splat.width = 1.2;
        const double wide = test_error(r, &scene).rmse;
        if (!(usual < most[kernel] && lit < most[kernel] && usual < wide))
            fail_msg("%s: rmse %g, lit %g, wide %g", names[kernel], usual, lit, wide);
    }
    cw_volume_free(&blobs);
}

/* Nodes of voxels that differ little change the picture little. A box of one value is one node,
 * whose middle is as that of its voxels. */
static void nodes_join_voxels(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_volume volume = {0};
    const cw_transfer transfers[2] = {test_soft_transfer(), test_flat_transfer()};
    const double most[2][CW_SPLAT_COUNT] = {{0.2, 0.2, 0.01, 0.01}, {0.02, 0.5, 1e-3, 1e-3}};
    for (int field = 0; field < 2; field++) {
        test_field(&volume, EDGE, EDGE, EDGE, cube, field ? test_constant : test_blobs);
        cw_renderer_forget(r);
        for (int kernel = 0; kernel < CW_SPLAT_COUNT; kernel++) {
            cw_scene scene = scene_of(kernel, &volume, &transfers[field],
                                      test_view(30, 25, field ? 4 : 30, field ? 6 : 50));
            scene.mode = CW_MODE_SPLAT_TREE;
            cw_picture voxels = test_draw(r, &scene);
            scene.splat.tree_error = 0.02;
            cw_picture nodes = test_draw(r, &scene);
            const double rmse = test_compare(&nodes, &voxels).rmse;
            if (rmse > most[field][kernel])
                fail_msg("%s, field %d: rmse %g", names[kernel], field, rmse);
            cw_picture_free(&voxels);
            cw_picture_free(&nodes);
        }
        cw_volume_free(&volume);
    }
}

static void kernels_out_of_range_are_refused(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const cw_transfer soft = test_soft_transfer();
    cw_volume blobs = {0};
    cw_error err = {0};
    cw_picture picture;
    test_field(&blobs, 4, 4, 4, cube, test_blobs);
    cw_renderer_forget(r);
    for (int n = 0; n < 4; n++) {
        cw_scene scene = scene_of(0, &blobs, &soft, test_view(0, 0, 30, 10));
        if (n == 3)
            scene.splat.kernel = CW_SPLAT_COUNT;
        else
            scene.splat.width = (double[]){0.1, 5, NAN}[n];
        assert_fails(cw_render(r, &scene, &picture, &err), CW_ERR_ARGUMENT, "splat.", err);
        assert_null(picture.pixels);
    }
    cw_volume_free(&blobs);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_vary_as_they_should),
        cmocka_unit_test(errors_follow_the_blur),
        cmocka_unit_test(nodes_join_voxels),
        cmocka_unit_test(kernels_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
