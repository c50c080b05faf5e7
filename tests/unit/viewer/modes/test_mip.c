/* Intensity projections by OpenGL, beside the exact ones of the CPU. */
#include "support/pictures.h"

#include <math.h>

static const double cube[3] = {1, 1, 1};
static const cw_mode modes[] = {CW_MODE_MIP, CW_MODE_MINIP, CW_MODE_AVERAGE, CW_MODE_LOCAL_MIP};

enum { MODES = sizeof modes / sizeof *modes };

/* Greys, so that a picture tells values. */
static const cw_transfer greys = {.color_count = 2,
                                  .colors = {{-0.1, {0, 0, 0}}, {1.1, {1, 1, 1}}},
                                  .opacity_count = 1,
                                  .opacities = {{0, 0.5f}}};

static cw_scene scene_of(cw_mode mode, const cw_volume *volume, bool perspective)
{
    return (cw_scene){.mode = mode,
                      .volume = volume,
                      .transfer = &greys,
                      .camera = {.eye = {30, -80, 20},
                                 .up = {0, 0, 1},
                                 .fov_deg = perspective ? 30 : 0,
                                 .height_mm = 48},
                      .intensity.threshold = 0.4,
                      .width = 48,
                      .height = 48};
}

/* How far OpenGL is from the CPU. */
static test_gap measure(const cw_scene *scene)
{
    cw_error err = {0};
    cw_renderer *cpu, *gl = test_renderer();
    assert_ok(cw_renderer_new(CW_BACKEND_CPU, &cpu, &err), err);
    cw_renderer_forget(gl);
    cw_picture a = test_draw(gl, scene), b = test_draw(cpu, scene);
    const test_gap gap = test_compare(&a, &b);
    cw_picture_free(&a);
    cw_picture_free(&b);
    cw_renderer_free(cpu);
    return gap;
}

/* By cells all but the first local maximum is exact; that may be told apart from a shoulder by
 * rounding. */
static void cells_are_exact(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    test_field(&blobs, 30, 26, 28, cube, test_blobs);
    for (int m = 0; m < MODES; m++)
        for (int perspective = 0; perspective < 2; perspective++) {
            cw_scene s = scene_of(modes[m], &blobs, perspective);
            s.sampling.cell_steps = true;
            const test_gap gap = measure(&s);
            assert_true(modes[m] == CW_MODE_LOCAL_MIP ? gap.rmse < 1.5 : gap.max < 0.01);
        }
    cw_volume_free(&blobs);
}

/* A thick shell around a hollow of -0.1, in air of -0.1: it peaks at a radius of 9 voxels. */
static double hollow_ball(const double p[3], const double q[3])
{
    (void)q;
    const double r = hypot(hypot(p[0] - 15, p[1] - 15), p[2] - 15);
    return fmax(1 - fabs(r - 9) / 5, -0.1);
}

/* Inside of a shell the lowest value is that of the hollow: known on paper, along rays through
 * the middle and beside it, where plain minip is as dark as the air. */
static void minimum_inside_shows_a_hollow(void **state)
{
    (void)state;
    cw_volume ball = {0};
    cw_renderer *gl = test_renderer();
    test_field(&ball, 31, 31, 31, cube, hollow_ball);
    cw_scene s = scene_of(CW_MODE_MINIP, &ball, false);
    s.camera.eye[0] = s.camera.eye[2] = 0;
    s.camera.height_mm = 30;
    s.width = s.height = 30;
    s.intensity.threshold = 0.5;
    s.sampling.step_vox = 0.2;
    for (int cells = 0; cells < 2; cells++) {
        s.sampling.cell_steps = cells;
        s.intensity.minip_inside = true;
        cw_renderer_forget(gl);
        cw_picture inside = test_draw(gl, &s);
        s.intensity.minip_inside = false;
        cw_picture plain = test_draw(gl, &s);
        for (size_t n = 0; n < 30 * 30; n++) {
            const double b =
                hypot((double)(n % 30) - 14.5, (double)(n / 30) - 14.5); /* from the middle */
            const double lowest = fmax(fmin(1 - (9 - b) / 5, 0.5), -0.1);
            const float *pixel = inside.pixels + 4 * n;
            assert_near((double)plain.pixels[4 * n], 0, 1e-3);
            if (fabs(b - 11.5) < 1) /* the outline */
                continue;
            assert_true(pixel[3] == (b < 11.5 ? 1 : 0));
            if (b < 11.5) /* voxels know the ball to a tenth */
                assert_near((double)pixel[0], (lowest + 0.1) / 1.2, 0.05);
        }
        cw_picture_free(&inside);
        cw_picture_free(&plain);
    }
    cw_volume_free(&ball);
}

/* Takes minima inside by cells, in one texture and in bricks, past gaps and cuts, as the CPU. */
static void minima_inside_are_exact_by_cells(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    test_field(&blobs, 30, 26, 28, cube, test_blobs);
    float *voxels = cw_volume_voxels(&blobs);
    for (int what = 0; what < 8; what++) {
        cw_scene s = scene_of(CW_MODE_MINIP, &blobs, what & 1);
        s.intensity.minip_inside = s.sampling.cell_steps = true;
        s.sampling.texture_edge = what & 2 ? 9 : 0;
        s.clip_count = what / 2 == 2 || what / 2 == 3;
        s.cut_away = what / 2 == 3;
        s.clips[0] = (cw_clip){{0.2, 1, 0.3}, 2};
        for (int t = 0; t < 3; t++) {
            s.intensity.threshold = (double[]){0.1, 0.4, 0.8}[t];
            assert_true(measure(&s).rmse < 0.5); /* a ray may graze the threshold */
        }
    }
    for (size_t n = 0; n < 30 * 26 * 28; n++)
        if (n % 30 > 8 && n % 30 < 14)
            voxels[n] = NAN;
    cw_scene s = scene_of(CW_MODE_MINIP, &blobs, true);
    s.intensity.minip_inside = s.sampling.cell_steps = true;
    assert_true(measure(&s).rmse < 6); /* two pixels, as in gaps_and_cuts_are_left_out */
    cw_volume_free(&blobs);
}

/* Leaping over blocks changes nothing of it, and fewer samples change little: rays that graze the
 * threshold find the object or not. */
static void minima_inside_converge(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    double rmse[2];
    test_field(&blobs, 64, 64, 64, cube, test_blobs);
    for (int n = 0; n < 2; n++) {
        cw_scene s = scene_of(CW_MODE_MINIP, &blobs, true);
        s.camera.eye[0] = 65;
        s.camera.eye[1] = -170;
        s.intensity.minip_inside = true;
        s.sampling.step_vox = (double[]){2, 0.125}[n];
        rmse[n] = measure(&s).rmse;
    }
    assert_true(rmse[0] < 8);
    assert_true(rmse[1] < 1e-2 || rmse[1] < rmse[0] / 2);
    cw_volume_free(&blobs);
}

/* The reference of a projection is the picture of the CPU; other modes have none. */
static void projections_have_a_reference(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    cw_renderer *any, *cpu, *gl = test_renderer();
    cw_error err = {0};
    assert_ok(cw_renderer_new(CW_BACKEND_AUTO, &any, &err), err);
    assert_ok(cw_renderer_new(CW_BACKEND_CPU, &cpu, &err), err);
    test_field(&blobs, 20, 18, 16, cube, test_blobs);
    for (int m = 0; m < MODES; m++) {
        cw_scene s = scene_of(modes[m], &blobs, true);
        cw_picture exact = test_draw(cpu, &s), drawn;
        s.mode = CW_MODE_REFERENCE;
        s.reference_of = modes[m];
        drawn = test_draw(any, &s);
        assert_memory_equal(drawn.pixels, exact.pixels, 48 * 48 * 4 * sizeof *exact.pixels);
        cw_picture_free(&drawn);
        assert_fails(cw_render(gl, &s, &drawn, &err), CW_ERR_UNSUPPORTED, "reference", err);
        cw_picture_free(&exact);
    }
    cw_picture drawn;
    cw_scene s = scene_of(CW_MODE_REFERENCE, &blobs, true);
    s.reference_of = CW_MODE_SLICES;
    assert_fails(cw_render(any, &s, &drawn, &err), CW_ERR_ARGUMENT,
                 "slices: an intensity projection was expected", err);
    cw_volume_free(&blobs);
    cw_renderer_free(any);
    cw_renderer_free(cpu);
}

/* A quarter of the step, less than a quarter of the error: samples miss a smooth maximum by its
 * curvature, one at the face of a cell by its slope. */
static void samples_converge(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    test_field(&blobs, 64, 64, 64, cube, test_blobs);
    for (int m = 0; m < 3; m++) {
        double rmse[2];
        for (int n = 0; n < 2; n++) {
            cw_scene s = scene_of(modes[m], &blobs, true);
            s.camera.eye[0] = 65;
            s.camera.eye[1] = -170;
            s.sampling.step_vox = (double[]){2, 0.5}[n];
            rmse[n] = measure(&s).rmse;
        }
        assert_true(rmse[0] < 1);
        assert_true(rmse[1] < rmse[0] / 4 || rmse[1] < 1e-3);
    }
    cw_volume_free(&blobs);
}

/* Voxels may fall where values rise. */
static void falling_voxels_have_the_same_values(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    test_field(&blobs, 30, 26, 28, cube, test_blobs);
    float *voxels = cw_volume_voxels(&blobs);
    for (size_t n = 0; n < 30 * 26 * 28; n++)
        voxels[n] = 3 - 2 * voxels[n];
    blobs.slope = -0.5;
    blobs.intercept = 1.5;
    for (int m = 0; m < 5; m++) {
        cw_scene s = scene_of(modes[m % MODES], &blobs, true);
        s.mode = m == MODES ? CW_MODE_MINIP : s.mode;
        s.intensity.minip_inside = m == MODES;
        s.sampling.cell_steps = true;
        const test_gap gap = measure(&s);
        assert_true(s.mode == CW_MODE_LOCAL_MIP || s.intensity.minip_inside ? gap.rmse < 1.5
                                                                            : gap.max < 0.01);
    }
    cw_volume_free(&blobs);
}

static void bricks_are_as_one_texture(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    test_field(&blobs, 30, 26, 28, cube, test_blobs);
    for (int m = 0; m < 3; m++) {
        cw_scene s = scene_of(modes[m], &blobs, true);
        s.sampling.cell_steps = true;
        s.sampling.texture_edge = 9;
        assert_true(measure(&s).max < 0.01);
    }
    cw_volume_free(&blobs);
}

/* Rays pass over samples without a value, and over what is cut away. */
static void gaps_and_cuts_are_left_out(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    test_field(&blobs, 30, 26, 28, cube, test_blobs);
    float *voxels = cw_volume_voxels(&blobs);
    for (size_t n = 0; n < 30 * 26 * 28; n++)
        if (n % 30 > 8 && n % 30 < 14)
            voxels[n] = NAN;
    for (int m = 0; m < 3; m++)
        for (int cut = 0; cut < 3; cut++) {
            cw_scene s = scene_of(modes[m], &blobs, cut == 1);
            s.sampling.cell_steps = true;
            s.clip_count = cut > 0;
            s.cut_away = cut > 1;
            s.clips[0] = (cw_clip){{0.2, 1, 0.3}, 2};
            assert_true(measure(&s).rmse <
                        4); /* two pixels at a gap's edge round differently */
        }
    cw_volume_free(&blobs);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_are_exact),
        cmocka_unit_test(samples_converge),
        cmocka_unit_test(minimum_inside_shows_a_hollow),
        cmocka_unit_test(minima_inside_are_exact_by_cells),
        cmocka_unit_test(minima_inside_converge),
        cmocka_unit_test(projections_have_a_reference),
        cmocka_unit_test(falling_voxels_have_the_same_values),
        cmocka_unit_test(bricks_are_as_one_texture),
        cmocka_unit_test(gaps_and_cuts_are_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
