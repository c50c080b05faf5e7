/* Tests the V-buffer renderer against the reference: peaks within cells, ends of rays, types,
 * and threads. */
#include "support/pictures.h"

#include "core/base/memory.h"

#include <math.h>
#include <string.h>

enum { SIZE = 64 };

static const double cube[3] = {1, 1, 1};

static cw_renderer *cpu(void)
{
    cw_error err = {0};
    cw_renderer *r;
    assert_ok(cw_renderer_new(CW_BACKEND_CPU, &r, &err), err);
    return r;
}

static cw_comparison gap_of(cw_renderer *r, cw_scene scene, double max)
{
    static const float black[2][3];
    cw_error err = {0};
    cw_comparison gap;
    scene.mode = CW_MODE_REFERENCE;
    cw_picture truth = test_draw(r, &scene);
    scene.mode = CW_MODE_VBUFFER;
    cw_picture fast = test_draw(r, &scene);
    assert_ok(cw_picture_compare(&fast, &truth, black, &gap, &err), err);
    for (size_t p = 0; p < truth.width * truth.height; p++)
        assert_near((double)fast.pixels[4 * p + 3], (double)truth.pixels[4 * p + 3], max / 255);
    cw_picture_free(&truth);
    cw_picture_free(&fast);
    return gap;
}

static void expect_close(cw_renderer *r, const cw_scene *scene, double rmse, double max)
{
    const cw_comparison gap = gap_of(r, *scene, max);
    assert_true(gap.pixels > SIZE * SIZE / 20);
    if (gap.rmse > rmse || gap.max > max)
        fail_msg("rmse %g, largest %g; expected %g and %g", gap.rmse, gap.max, rmse, max);
}

/* In 1/255; the light that is left where rays end makes the most of it with a soft transfer
 * function. */
static void it_is_as_exact_as_bytes_can_show(void **state)
{
    (void)state;
    cw_renderer *r = cpu();
    cw_volume blobs = {0};
    const cw_transfer soft = test_soft_transfer(), tent = test_tent_transfer();
    cw_transfer edges = soft;
    edges.gradient_count = 2;
    edges.gradients[0] = (cw_opacity_point){0, 0};
    edges.gradients[1] = (cw_opacity_point){0.1, 1};
    test_field(&blobs, 48, 44, 40, (const double[3]){1, 1.1, 1.2}, test_blobs);
    blobs.affine[0][1] = 0.2;
    cw_scene scene = {.volume = &blobs, .transfer = &soft, .width = SIZE, .height = SIZE};
    expect_close(r, &scene, 0.005, 0.1);
    scene.sampling.stop_opacity = 1;
    expect_close(r, &scene, 0.001, 0.01);
    scene.depth_cue = 0.8f;
    scene.background[0][0] = 1;
    scene.background[1][1] = 1;
    expect_close(r, &scene, 0.001, 0.01);
    scene.clip_count = 1;
    scene.clips[0] = (cw_clip){{1, 1, 0.5}, 2};
    scene.cut_away = true;
    expect_close(r, &scene, 0.001, 0.01);
    scene.lit = true;
    expect_close(r, &scene, 0.02, 0.5); /* where gradients vanish, light turns in a cell */
    scene.transfer = &edges;
    expect_close(r, &scene, 0.05, 0.5);
    scene.lit = false;
    expect_close(r, &scene, 0.01, 0.1);
    scene.cut_away = false;
    scene.transfer = &tent;
    scene.camera = (cw_camera){.eye = {20, -90, 30}, .up = {0, 0, 1}, .height_mm = 60};
    expect_close(r, &scene, 0.02, 0.1);
    cw_volume_free(&blobs);
    cw_renderer_free(r);
}

/* Seen through the thinnest slab, too. */
static double waves(const double p[3], const double q[3])
{
    (void)p;
    return 0.6 + 0.4 * sin(9 * (q[0] + q[1])) * cos(7 * (q[1] - q[2]));
}

/* Turns within every cell. */
static double noise(const double p[3], const double q[3])
{
    (void)q;
    return fmod(p[0] * 0.618034 + p[1] * 0.754878 + p[2] * 0.569840 + p[0] * p[1] * 0.3, 1);
}

/* Only peaks are seen, some of them within a cell. */
static void peaks_within_cells_are_seen(void **state)
{
    (void)state;
    cw_renderer *r = cpu();
    cw_volume v = {0};
    const cw_transfer peaks = {
        .opacity_count = 2, .opacities = {{0.7, 0}, {0.75, 0.5f}}, .unit_mm = 1};
    test_field(&v, 16, 16, 16, cube, noise);
    const cw_scene scene = {.volume = &v,
                            .transfer = &peaks,
                            .width = SIZE,
                            .height = SIZE,
                            .sampling.stop_opacity = 1};
    expect_close(r, &scene, 0.03, 1);
    cw_volume_free(&v);
    cw_renderer_free(r);
}

static double even(const double p[3], const double q[3])
{
    (void)p;
    (void)q;
    return 1;
}

/* Every millimetre takes half of the light: a ray ends in the cell in which the opacity asked
 * for is reached, neither before nor much later. */
static void rays_end_at_the_opacity_asked_for(void **state)
{
    (void)state;
    static const struct {
        float asked;
        double at_least;
    } rows[] = {{0, 0.99999}, {0.5f, 0.5}, {0.9f, 0.9}, {0.99f, 0.99}, {0.9999f, 0.9999}};
    cw_renderer *r = cpu();
    cw_volume v = {0};
    const cw_transfer half = {
        .opacity_count = 2, .opacities = {{0, 0.5f}, {2, 0.5f}}, .unit_mm = 1};
    test_field(&v, 33, 33, 33, cube, even);
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        const cw_scene scene = {.mode = CW_MODE_VBUFFER,
                                .volume = &v,
                                .transfer = &half,
                                .camera = {.eye = {0, -99, 0}, .up = {0, 0, 1}, .height_mm = 8},
                                .width = 8,
                                .height = 8,
                                .sampling.stop_opacity = rows[n].asked};
        cw_picture picture = test_draw(r, &scene);
        for (size_t p = 0; p < 64; p++) {
            const double opacity = (double)picture.pixels[4 * p + 3];
            assert_true(opacity >= rows[n].at_least - 1e-7);
            assert_true(1 - opacity > 0.4 * (1 - rows[n].at_least)); /* one cell more at most */
        }
        cw_picture_free(&picture);
    }
    cw_volume_free(&v);
    cw_renderer_free(r);
}

/* Straight along an axis, from inside, through slabs, and past what has no value. */
static void rays_of_any_kind_pass(void **state)
{
    (void)state;
    cw_renderer *r = cpu();
    const cw_transfer soft = test_soft_transfer();
    static const struct {
        size_t dim[3];
        cw_camera camera;
    } cases[] = {
        {{33, 33, 33}, {.eye = {0, -99, 0}, .up = {0, 0, 1}, .height_mm = 32}},
        {{33, 33, 33}, {.eye = {0, 0, 99}, .up = {0, 1, 0}, .height_mm = 30}},
        {{33, 33, 33}, {.eye = {0, 0, 0}, .target = {9, 1, 3}, .up = {0, 0, 1}, .fov_deg = 90}},
        {{33, 1, 33}, {.eye = {20, -60, 10}, .up = {0, 0, 1}, .fov_deg = 30}},
        {{1, 33, 33}, {.eye = {20, -60, 10}, .up = {0, 0, 1}, .fov_deg = 30}},
        {{40, 2, 33}, {.eye = {0, -60, 0}, .up = {0, 0, 1}, .fov_deg = 30}},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        const size_t *dim = cases[n].dim;
        cw_volume v = {0};
        test_field(&v, dim[0], dim[1], dim[2], cube,
                   dim[0] * dim[1] * dim[2] == 33 * 33 * 33 ? test_blobs : waves);
        float *voxels = cw_volume_voxels(&v);
        for (size_t p = 0; p < dim[0] * dim[1] * dim[2]; p += 997)
            voxels[p] = NAN;
        const cw_scene scene = {.volume = &v,
                                .transfer = &soft,
                                .camera = cases[n].camera,
                                .width = SIZE,
                                .height = SIZE};
        expect_close(r, &scene, 0.01, 0.1);
        cw_volume_free(&v);
        cw_renderer_forget(r);
    }
    cw_renderer_free(r);
}

/* Bytes with nodata, doubles far from 0, and a view with steps, are the same to
 * the reference. */
static void voxels_of_any_type_pass(void **state)
{
    (void)state;
    cw_renderer *r = cpu();
    cw_error err = {0};
    const size_t dim[3] = {30, 32, 34};
    for (int row = 0; row < 2 * CW_TYPE_COUNT; row++) {
        const int type = row / 2;
        const size_t channels = 1 + (size_t)row % 2; /* two: voxels are not packed */
        cw_volume v = {0};
        cw_transfer soft = test_soft_transfer();
        const double shift = type == CW_F64 ? 1e9 : 0;
        assert_ok(cw_volume_alloc(&v, (cw_type)type, dim, channels, 1, &err), err);
        for (size_t n = 0; n < 30 * 32 * 34; n++) {
            double q[3] = {(double)(n % 30) / 29, (double)(n / 30 % 32) / 31,
                           (double)(n / 960) / 33};
            const double value = test_blobs(q, q);
            void *at = (char *)cw_volume_voxels(&v) + channels * n * cw_type_size(v.type);
            const double stored = fmin(fmax(rint(value * 100), 0), 120);
            if (type == CW_F64)
                *(double *)at = shift + stored;
            else if (type == CW_F32)
                *(float *)at = (float)stored;
            else if (cw_type_size(v.type) == 1)
                *(uint8_t *)at = (uint8_t)stored;
            else if (cw_type_size(v.type) == 2)
                *(uint16_t *)at = (uint16_t)stored;
            else
                *(uint32_t *)at = (uint32_t)stored;
        }
        v.slope = 0.01;
        v.intercept = -0.01 * shift;
        v.has_nodata = true;
        v.nodata = shift + 70;
        cw_scene scene = {.volume = &v, .transfer = &soft, .width = SIZE, .height = SIZE};
        expect_close(r, &scene, 0.02, 0.3);
        scene.lit = true;
        expect_close(r, &scene, 0.05, 1);
        cw_volume_free(&v);
    }
    cw_renderer_free(r);
}

/* Two lights, glossy by a power that is not whole, from one side, smoothed, with shadows: each
 * row has one more. */
static void every_kind_of_light_passes(void **state)
{
    (void)state;
    cw_renderer *r = cpu();
    cw_volume blobs = {0};
    const cw_transfer soft = test_soft_transfer();
    test_field(&blobs, 36, 40, 38, cube, test_blobs);
    cw_scene scene = {.volume = &blobs,
                      .transfer = &soft,
                      .width = SIZE,
                      .height = SIZE,
                      .lit = true,
                      .light_count = 2,
                      .lights = {{{1, 1, 1}, {1, 0.9f, 0.8f}}, {{-1, 0, 0.5}, {0, 0.2f, 0.4f}}},
                      .material = {0.2f, 0.6f, 0.4f, 7.5f}};
    expect_close(r, &scene, 0.05, 1);
    scene.one_sided = true;
    expect_close(r, &scene, 0.05, 1);
    scene.gradient_sigma = 1.5;
    expect_close(r, &scene, 0.05, 1);
    scene.shadow = CW_SHADOW_LIGHT;
    expect_close(r, &scene, 0.05, 1);
    scene.shadow = CW_SHADOW_AMBIENT;
    expect_close(r, &scene, 0.05, 1);
    cw_volume_free(&blobs);
    cw_renderer_free(r);
}

static void any_threads_give_the_same_bytes(void **state)
{
    (void)state;
    cw_renderer *r = cpu();
    cw_volume blobs = {0};
    const cw_transfer soft = test_soft_transfer();
    test_field(&blobs, 32, 32, 32, cube, test_blobs);
    cw_scene scene = {.mode = CW_MODE_VBUFFER,
                      .volume = &blobs,
                      .transfer = &soft,
                      .width = SIZE,
                      .height = SIZE,
                      .threads = 1};
    cw_picture one = test_draw(r, &scene);
    scene.threads = 3;
    cw_picture three = test_draw(r, &scene);
    assert_memory_equal(one.pixels, three.pixels, SIZE * SIZE * 4 * sizeof(float));
    cw_picture_free(&three);

    memset(cw_volume_voxels(&blobs), 0, 32 * 32 * 32 * sizeof(float));
    cw_renderer_forget(r);
    cw_picture empty = test_draw(r, &scene);
    for (size_t p = 0; p < SIZE * SIZE * 4; p++)
        assert_true(empty.pixels[p] == 0);
    cw_picture_free(&one);
    cw_picture_free(&empty);
    cw_volume_free(&blobs);
    cw_renderer_free(r);
}

/* Each allocation fails in turn; nothing is left behind, and the renderer goes on. */
static void memory_that_runs_out_is_reported(void **state)
{
    (void)state;
    static const cw_mode modes[] = {CW_MODE_VBUFFER, CW_MODE_REFERENCE, CW_MODE_MIP};
    cw_error err = {0};
    cw_renderer *r = cpu();
    cw_volume blobs = {0};
    cw_mesh mesh = {0};
    const cw_transfer soft = test_soft_transfer();
    test_field(&blobs, 12, 12, 12, cube, test_blobs);
    test_make_tetrahedron(&mesh);
    for (size_t m = 0; m < 3; m++) {
        cw_status st = CW_ERR_NO_MEMORY;
        for (long n = 0; st != CW_OK; n++) {
            const cw_scene scene = {.mode = modes[m],
                                    .volume = &blobs,
                                    .mesh = &mesh,
                                    .transfer = &soft,
                                    .width = 8,
                                    .height = 8,
                                    .threads = 1};
            cw_picture picture;
            cw_renderer_forget(r);
            cwi_alloc_fail_after(n);
            st = cw_render(r, &scene, &picture, &err);
            cwi_alloc_fail_after(-1);
            assert_true(n < 40 && (n > 3 || st == CW_ERR_NO_MEMORY));
            assert_true(st == CW_OK || (st == CW_ERR_NO_MEMORY && !picture.pixels));
            cw_picture_free(&picture);
        }
    }
    cw_mesh_free(&mesh);
    cw_volume_free(&blobs);
    cw_renderer_free(r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_as_exact_as_bytes_can_show),
        cmocka_unit_test(peaks_within_cells_are_seen),
        cmocka_unit_test(rays_end_at_the_opacity_asked_for),
        cmocka_unit_test(rays_of_any_kind_pass),
        cmocka_unit_test(voxels_of_any_type_pass),
        cmocka_unit_test(every_kind_of_light_passes),
        cmocka_unit_test(any_threads_give_the_same_bytes),
        cmocka_unit_test(memory_that_runs_out_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
