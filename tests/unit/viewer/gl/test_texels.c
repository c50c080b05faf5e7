/* Voxels as textures: whatever they are made of, pictures are those of the voxels. */
#include "support/hostile.h"
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
            const double q = dim[a] > 1 ? (double)n / (double)(dim[a] - 1) : 0.5;
            share[a][n] = 4 * q * (1 - q) * (0.9 + 0.1 * cos(30 * q + a));
        }
        volume->affine[a][a] = 1;
    }
    for (size_t n = 0; n < nx * ny * nz; n++)
        to[n] =
            (uint8_t)(255 * share[0][n % nx] * share[1][n / nx % ny] * share[2][n / nx / ny]);
}

static void copy_as(const cw_volume *bytes, cw_type type, cw_volume *out)
{
    cw_error err = {0};
    const uint8_t *from = bytes->data;
    assert_ok(cw_volume_alloc(out, type, bytes->dim, 1, 1, &err), err);
    memcpy(out->affine, bytes->affine, sizeof out->affine);
    char *to = cw_volume_voxels(out);
    const bool is_signed = type != CW_U8 && type != CW_U16;
    for (size_t n = 0; n < bytes->dim[0] * bytes->dim[1] * bytes->dim[2]; n++)
        test_store(type, to, n, is_signed ? from[n] - 128.0 : from[n]);
    out->intercept = is_signed ? 128 : 0;
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
    copy_as(&bytes, CW_F32, &floats);
    static const cw_mode modes[] = {CW_MODE_COMPOSITE, CW_MODE_TEXTURE, CW_MODE_MIP};
    for (size_t m = 0; m < sizeof modes / sizeof *modes; m++) {
        cw_scene scene = {.mode = modes[m],
                          .volume = &bytes,
                          .transfer = &narrow,
                          .width = 96,
                          .height = 96,
                          .sampling.step_vox = 0.25};
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
    for (size_t m = 0; m < (size_t)test_some(sizeof modes / sizeof *modes); m++) {
        cw_scene scene = {.mode = modes[m],
                          .volume = &bytes,
                          .transfer = &soft,
                          .lit = true,
                          .width = 64,
                          .height = 64};
        cw_picture whole = test_draw(test_renderer(), &scene);
        scene.sampling.texture_edge = 200;
        cw_picture bricks = test_draw(test_renderer(), &scene);
        const test_gap gap = test_compare(&whole, &bricks);
        if (gap.rmse > 0.1 || gap.max > 2)
            fail_msg("%s: rmse %g, max %g", cw_mode_name(modes[m]), gap.rmse, gap.max);
        cw_picture_free(&whole);
        cw_picture_free(&bricks);
    }
    cw_volume_free(&bytes);
}

/* A picture of a volume that is gone afterwards. */
static cw_picture draw_as(const cw_volume *bytes, cw_type type, cw_mode mode, bool lean)
{
    cw_volume volume = {0};
    const cw_transfer narrow = peak();
    copy_as(bytes, type, &volume);
    cw_scene scene = {.mode = mode,
                      .volume = &volume,
                      .transfer = &narrow,
                      .lit = mode == CW_MODE_COMPOSITE || mode == CW_MODE_PROJECTION,
                      .sampling.lean = lean,
                      .sampling.exact_filter = !lean,
                      .width = 48,
                      .height = 48,
                      .sampling.step_vox = 0.5};
    cw_picture picture = test_draw(test_renderer(), &scene);
    cw_volume_free(&volume);
    return picture;
}

static void lean_pictures_are_as_others(void **state)
{
    (void)state;
    static const size_t dims[][3] = {{24, 20, 28}, {31, 2, 17}, {1, 16, 24}};
    static const cw_type types[] = {CW_U8, CW_U16, CW_I16, CW_F32};
    static const cw_mode modes[] = {CW_MODE_COMPOSITE, CW_MODE_MIP, CW_MODE_SLICES,
                                    CW_MODE_PROJECTION};
    for (size_t d = 0; d < sizeof dims / sizeof *dims; d++) {
        cw_volume bytes = {0};
        make_bytes(&bytes, dims[d][0], dims[d][1], dims[d][2]);
        for (size_t n = test_is_short() ? d : 0;
             n < sizeof types / sizeof *types * (sizeof modes / sizeof *modes);
             n += test_is_short() ? 3 : 1) {
            const cw_type type = types[n % (sizeof types / sizeof *types)];
            const cw_mode mode = modes[n / (sizeof types / sizeof *types)];
            cw_picture lean = draw_as(&bytes, type, mode, true);
            cw_picture other = draw_as(&bytes, type, mode, false);
            const test_gap gap = test_compare(&lean, &other);
            if (gap.rmse > 0.05 || gap.max > 1)
                fail_msg("%s, %s, %zu x %zu x %zu: rmse %g, max %g", cw_mode_name(mode),
                         cw_type_name(type), dims[d][0], dims[d][1], dims[d][2], gap.rmse,
                         gap.max);
            cw_picture_free(&lean);
            cw_picture_free(&other);
        }
        cw_volume_free(&bytes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lean_pictures_are_as_others),
        cmocka_unit_test(bytes_are_interpolated_as_finely_as_floats),
        cmocka_unit_test(large_volumes_are_lit_as_small_ones),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
