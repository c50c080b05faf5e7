/* Voxels as textures: whatever they are made of, pictures are those of the voxels. */
#include "support/pictures.h"

#include <math.h>
#include <string.h>

/* Bytes that are 0 at the ends of the axes and rise to the middle, with waves. */
static void make_bytes(cw_volume *volume, size_t nx, size_t ny, size_t nz)
{
    cw_error err = {0};
    const size_t dim[3] = {nx, ny, nz};
    double share[3][512];
    assert_ok(cw_volume_alloc(volume, CW_U8, dim, 1, 1, &err), err);
    uint8_t *to = cw_volume_voxels(volume);
    for (int a = 0; a < 3; a++) {
        assert_true(dim[a] <= 512);
        for (size_t n = 0; n < dim[a]; n++) {
            const double q = (double)n / (double)(dim[a] - 1);
            share[a][n] = 4 * q * (1 - q) * (0.9 + 0.1 * cos(30 * q + a));
        }
        volume->affine[a][a] = 1;
    }
    for (size_t n = 0; n < nx * ny * nz; n++)
        to[n] =
            (uint8_t)(255 * share[0][n % nx] * share[1][n / nx % ny] * share[2][n / nx / ny]);
}

static void copy_as_floats(const cw_volume *bytes, cw_volume *floats)
{
    cw_error err = {0};
    const uint8_t *from = bytes->data;
    assert_ok(cw_volume_alloc(floats, CW_F32, bytes->dim, 1, 1, &err), err);
    memcpy(floats->affine, bytes->affine, sizeof floats->affine);
    float *to = cw_volume_voxels(floats);
    for (size_t n = 0; n < bytes->dim[0] * bytes->dim[1] * bytes->dim[2]; n++)
        to[n] = from[n];
}

/* A narrow peak shows every step of an interpolation in eight bits. */
static cw_transfer peak(void)
{
    return (cw_transfer){.color_count = 1,
                         .colors = {{0, {1, 0.8f, 0.6f}}},
                         .opacity_count = 3,
                         .opacities = {{125, 0}, {127.3, 0.9f}, {129.6, 0}}};
}

static void bytes_are_interpolated_as_finely_as_floats(void **state)
{
    (void)state;
    cw_volume bytes = {0}, floats = {0};
    const cw_transfer narrow = peak();
    make_bytes(&bytes, 24, 20, 28);
    copy_as_floats(&bytes, &floats);
    static const cw_mode modes[] = {CW_MODE_COMPOSITE, CW_MODE_TEXTURE, CW_MODE_MIP};
    for (size_t m = 0; m < sizeof modes / sizeof *modes; m++) {
        cw_scene scene = {.mode = modes[m],
                          .volume = &bytes,
                          .transfer = &narrow,
                          .width = 96,
                          .height = 96,
                          .step_vox = 0.25};
        cw_picture a = test_draw(test_renderer(), &scene);
        scene.volume = &floats;
        cw_picture b = test_draw(test_renderer(), &scene);
        assert_true(test_compare(&a, &b).max < 0.05);
        cw_picture_free(&a);
        cw_picture_free(&b);
    }
    cw_volume_free(&bytes);
    cw_volume_free(&floats);
}

/* In bricks, and as a volume that is small enough, gradients are textures. */
static void large_volumes_are_lit_as_small_ones(void **state)
{
    (void)state;
    cw_volume bytes = {0};
    const cw_transfer soft = {.color_count = 1,
                              .colors = {{0, {1, 0.8f, 0.6f}}},
                              .opacity_count = 2,
                              .opacities = {{20, 0}, {250, 0.05f}},
                              .gradient_count = 2,
                              .gradients = {{0, 0.2f}, {20, 1}}};
    make_bytes(&bytes, 260, 260, 250); /* more than 2^24 */
    static const cw_mode modes[] = {CW_MODE_COMPOSITE, CW_MODE_TEXTURE};
    for (size_t m = 0; m < sizeof modes / sizeof *modes; m++) {
        cw_scene scene = {.mode = modes[m],
                          .volume = &bytes,
                          .transfer = &soft,
                          .lit = true,
                          .width = 64,
                          .height = 64};
        cw_picture whole = test_draw(test_renderer(), &scene);
        scene.texture_edge = 200;
        cw_picture bricks = test_draw(test_renderer(), &scene);
        const test_gap gap = test_compare(&whole, &bricks);
        if (gap.rmse > 0.1 || gap.max > 2)
            fail_msg("%s: rmse %g, max %g", cw_mode_name(modes[m]), gap.rmse, gap.max);
        cw_picture_free(&whole);
        cw_picture_free(&bricks);
    }
    cw_volume_free(&bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bytes_are_interpolated_as_finely_as_floats),
        cmocka_unit_test(large_volumes_are_lit_as_small_ones),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
