/* Tests slices through textures: matrix, marked boxes, bricks, convergence, and skipping. */
#include "support/integral.h"

#include "viewer/proxy/view_slabs.h"

#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

static const double cube[3] = {1, 1, 1};

/* Fails, and says how far, when pictures are farther apart than they may be, in 1/255. */
static test_gap expect_near(const char *what, const cw_picture *a, const cw_picture *b,
                            double rmse, double max)
{
    const test_gap gap = test_compare(a, b);
    if (!(gap.rmse <= rmse && gap.max <= max))
        print_message("%s: rmse %.5f of %g, max %.5f of %g\n", what, gap.rmse, rmse, gap.max,
                      max);
    assert_true(gap.rmse <= rmse && gap.max <= max);
    return gap;
}

/* Draws the same scene twice, changed in between, and compares. */
static void expect_same(const char *what, const cw_scene *a, const cw_scene *b, double rmse,
                        double max)
{
    cw_picture x = test_draw(test_renderer(), a), y = test_draw(test_renderer(), b);
    expect_near(what, &x, &y, rmse, max);
    cw_picture_free(&x);
    cw_picture_free(&y);
}

/* From the front, or from a corner of the world. */
static cw_camera looking(bool oblique, double height_mm, double fov_deg)
{
    cw_camera c = {.eye = {0, -500, 0}, .up = {0, 0, 1}, .height_mm = height_mm};
    const double corner[3] = {0.9 * height_mm, -1.4 * height_mm, 0.7 * height_mm};
    if (oblique)
        memcpy(c.eye, corner, sizeof corner);
    c.fov_deg = fov_deg;
    return c;
}

static cw_scene scene_of(const cw_volume *volume, const cw_transfer *transfer, cw_camera camera)
{
    return (cw_scene){.mode = CW_MODE_TEXTURE,
                      .volume = volume,
                      .transfer = transfer,
                      .camera = camera,
                      .width = 64,
                      .height = 64};
}

/* A grid that is turned, sheared, mirrored and of uneven spacing. */
static void tilt(cw_volume *v, double scale)
{
    static const double m[3][3] = {{0.6, -0.9, 0.3}, {0.7, 0.5, -0.2}, {0.1, 0.3, -1.7}};
    for (int r = 0; r < 3; r++) {
        v->affine[r][3] = 0;
        for (int c = 0; c < 3; c++) {
            v->affine[r][c] = scale * m[r][c];
            v->affine[r][3] -= v->affine[r][c] * ((double)v->dim[c] - 1) / 2;
        }
    }
}

/* (s, t, r) is T S R^-1 D^-1 (x, y, z): from the camera back to the world, to the grid, to the
 * texture's size, to the middle of texels. */
static void texture_matrix_is_right(void **state)
{
    (void)state;
    cw_error err = {0};
    cwi_frame f;
    cw_volume v = {0};
    const cw_transfer soft = test_soft_transfer();
    const size_t first[3] = {3, 0, 5}, count[3] = {9, 12, 8};
    test_field(&v, 20, 12, 16, cube, test_blobs);
    tilt(&v, 0.01);
    cw_scene scene = scene_of(&v, &soft, looking(true, 0.4, 25));
    assert_ok(cwi_frame_init(&f, &scene, &err), err);
    for (int n = 0; n < 200; n++) {
        double m[12], eye[3] = {0}, world[3], texel[3];
        const double index[3] = {n % 20, n % 12, n % 16};
        cw_volume_to_world(&v, index, world);
        for (int r = 0; r < 3; r++)
            for (int a = 0; a < 3; a++)
                eye[r] += f.axes[r][a] * (world[a] - f.eye_mm[a]) / f.unit_mm;
        cwi_slabs_texture_matrix(&f, first, count, m);
        cwi_affine_apply(m, eye, texel);
        for (int a = 0; a < 3; a++)
            assert_true(
                fabs(texel[a] - (index[a] - (double)first[a] + 0.5) / (double)count[a]) < 1e-9);
    }
    cw_volume_free(&v);
}

static bool is_in(const cwi_slab_rect *r, double x, double y)
{
    return x >= r->left && x < r->right && y >= r->bottom && y < r->top;
}

/* Whatever ray meets a marked box, its sample is in one rectangle of the slab's layer. */
static void marks_cover_a_box_once(void **state)
{
    (void)state;
    cw_error err = {0};
    cwi_frame f;
    cwi_slabs s;
    cw_volume v = {0};
    static cwi_slab_rect rects[CWI_SLAB_RECTS];
    const cw_transfer soft = test_soft_transfer();
    test_field(&v, 20, 12, 16, cube, test_blobs);
    for (int view = 0; view < 4; view++) {
        cw_scene scene = scene_of(&v, &soft, looking(view & 1, 30, view & 2 ? 40 : 0));
        scene.width = 150;
        scene.height = 96;
        scene.sampling.step_vox = view == 3 ? 5 : 0.7;
        assert_ok(cwi_frame_init(&f, &scene, &err), err);
        assert_ok(cwi_slabs_init(&f, &s, &err), err);
        cwi_slabs_mark(&s, &f, (double[]){2, 3, 4}, (double[]){5, 11, 9});
        cwi_slabs_mark(&s, &f, (double[]){8, 0, 1}, (double[]){15, 3, 5});
        for (int n = 0; n < 2000; n++) {
            const double p[3] = {2 + n % 7 / 2.0, 3 + n % 17 / 2.0, 4 + n % 11 / 2.0};
            const double z = -(f.eye_from_index[8] * p[0] + f.eye_from_index[9] * p[1] +
                               f.eye_from_index[10] * p[2] + f.eye_from_index[11]);
            const size_t layer = (size_t)((z - s.first) / s.thickness) / s.per_layer;
            const size_t count = cwi_slabs_rects(&s, &f, layer, rects);
            double eye[3], at[2], hits = 0;
            cwi_affine_apply(f.eye_from_index, p, eye);
            for (int a = 0; a < 2; a++)
                at[a] = (eye[a] / (view & 2 ? z : 1) / f.half[a] + 1) / 2 * (a ? 96 : 150);
            for (size_t r = 0; r < count; r++)
                hits += is_in(&rects[r], at[0], at[1]);
            assert_true(hits == (at[0] >= 0 && at[0] < 150 && at[1] >= 0 && at[1] < 96));
        }
        cwi_slabs_clear(&s);
        for (size_t n = 0; n < s.layer_count; n++)
            assert_int_equal(cwi_slabs_rects(&s, &f, n, rects), 0);
        cwi_slabs_free(&s);
    }
    cw_volume_free(&v);
}

/* A box of one value is as opaque as Beer and Lambert say, however many slices are drawn, and
 * in bricks. */
static void constant_box_is_exact(void **state)
{
    (void)state;
    cw_volume box = {0};
    const cw_transfer flat = test_flat_transfer();
    test_field(&box, 33, 33, 33, cube, test_constant);
    for (int n = 0; n < 5; n++)
        for (int view = 0; view < 4; view++) {
            cw_scene scene = scene_of(&box, &flat, looking(view & 1, 60, view & 2 ? 35 : 0));
            scene.sampling.step_vox = (double[]){1, 0.5, 1.0 / 16, 0.73, 7.3}[n];
            scene.sampling.no_preintegration = n % 2;
            scene.texture.colors_first = n == 3; /* of half precision */
            scene.sampling.texture_edge =
                n == 0 ? 9 : 0; /* what counts twice at a seam shows */
            cw_picture truth = test_integral(&scene, 100);
            cw_picture picture = test_draw(test_renderer(), &scene);
            expect_near("box", &picture, &truth, n == 3 ? 0.05 : 0.001, n == 3 ? 0.1 : 0.003);
            cw_picture_free(&picture);
            cw_picture_free(&truth);
        }
    cw_volume_free(&box);
}

/* A ramp of values, and of opacities: both orders of interpolation. */
static void ramp_is_near_the_truth(void **state)
{
    (void)state;
    cw_volume ramp = {0};
    const cw_transfer linear = {.color_count = 2,
                                .colors = {{0, {1, 0.4f, 0}}, {1, {0.2f, 0.6f, 1}}},
                                .opacity_count = 2,
                                .opacities = {{0, 0}, {1, 0.3f}}};
    test_field(&ramp, 33, 20, 24, cube, test_ramp);
    for (int view = 0; view < 4; view++) {
        cw_scene scene = scene_of(&ramp, &linear, looking(view & 1, 50, view & 2 ? 35 : 0));
        for (int colors = 0; colors < 2; colors++) {
            scene.texture.colors_first = colors;
            cw_picture truth = test_integral(&scene, 0.15);
            scene.sampling.step_vox = colors ? 0.5 : 1;
            cw_picture picture = test_draw(test_renderer(), &scene);
            expect_near(colors ? "ramp, colours" : "ramp", &picture, &truth, 0.05, 0.2);
            cw_picture_free(&picture);
            cw_picture_free(&truth);
        }
    }
    cw_volume_free(&ramp);
}

/* Errors fall with the square of the distance of slices. */
static void slices_converge(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    double before[4];
    const cw_transfer soft = test_soft_transfer();
    test_field(&blobs, 48, 48, 48, cube, test_blobs);
    for (int n = 0; n < 12; n++) {
        const int kind = n % 4, step = n / 4;
        cw_scene scene = scene_of(&blobs, &soft, looking(true, 70, kind < 2 ? 0 : 30));
        scene.sampling.no_preintegration = kind % 2;
        scene.texture.colors_first = kind == 3;
        scene.sampling.step_vox = (double[]){2, 1, 0.5}[step];
        cw_picture truth = test_integral(&scene, 0.15);
        cw_picture picture = test_draw(test_renderer(), &scene);
        const test_gap gap =
            expect_near("blobs", &picture, &truth, (double[]){0.4, 0.1, 0.03}[step],
                        (double[]){8, 3, 0.6}[step]);
        assert_true(step == 0 || before[kind] / gap.rmse > 3);
        before[kind] = gap.rmse;
        cw_picture_free(&picture);
        cw_picture_free(&truth);
    }
    cw_volume_free(&blobs);
}

/* The coarser the blending, the worse: the picture of 1994 and of today. */
static void blending_rounds(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    const cw_transfer soft = test_soft_transfer();
    test_field(&blobs, 48, 48, 48, cube, test_blobs);
    cw_scene scene = scene_of(&blobs, &soft, looking(true, 70, 30));
    scene.sampling.step_vox = 72.0 / 256;
    cw_picture truth = test_integral(&scene, 0.15);
    double before = 0;
    for (int n = 0; n < CW_TARGET_COUNT; n++) {
        scene.texture.target =
            (cw_target[]){CW_TARGET_32F, CW_TARGET_16, CW_TARGET_16F, CW_TARGET_8}[n];
        cw_picture picture = test_draw(test_renderer(), &scene);
        const test_gap gap =
            expect_near("target", &picture, &truth, (double[]){0.05, 0.06, 3, 12}[n],
                        (double[]){0.3, 0.4, 8, 60}[n]);
        assert_true(gap.rmse >= before);
        before = gap.rmse;
        cw_picture_free(&picture);
    }
    assert_true(before > 0.5); /* eight bits show */
    cw_picture_free(&truth);
    cw_volume_free(&blobs);
}

/* Bricks meet without a seam. A slab that is cut in two is integrated in two, which is nearer
 * to the truth, and lit by the gradient at two places. */
static void bricks_have_no_seams(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    cw_picture whole[6];
    const cw_transfer soft = test_soft_transfer();
    test_field(&blobs, 48, 40, 52, cube, test_blobs);
    for (int n = 0; n < 18; n++) {
        const int kind = n % 6;
        cw_scene scene = scene_of(&blobs, &soft, looking(true, 70, kind & 1 ? 40 : 0));
        scene.lit = kind / 2 == 1;
        scene.texture.colors_first = kind / 2 == 2;
        scene.sampling.step_vox = 0.2;
        scene.sampling.texture_edge = (size_t[]){0, 17, 33}[n / 6];
        cw_picture picture = test_draw(test_renderer(), &scene);
        if (n < 6) {
            whole[kind] = picture;
            continue;
        }
        expect_near("bricks", &whole[kind], &picture, scene.lit ? 0.01 : 0.005,
                    scene.lit ? 0.5 : 0.05);
        cw_picture_free(&picture);
    }
    for (int n = 0; n < 6; n++)
        cw_picture_free(&whole[n]);
    cw_volume_free(&blobs);
}

/* Where the eye is in the volume, slices begin before it. */
static void an_eye_inside_sees_what_is_ahead(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    const cw_transfer soft = test_soft_transfer();
    test_field(&blobs, 48, 48, 48, cube, test_blobs);
    cw_scene scene = scene_of(
        &blobs, &soft,
        (cw_camera){.eye = {3, -9, 4}, .target = {0, 10, 0}, .up = {0, 0, 1}, .fov_deg = 60});
    scene.sampling.step_vox = 0.5;
    cw_picture truth = test_integral(&scene, 0.15);
    cw_picture picture = test_draw(test_renderer(), &scene);
    expect_near("inside", &picture, &truth, 0.03, 0.3);
    scene.sampling.texture_edge = 17;
    cw_picture bricks = test_draw(test_renderer(), &scene);
    expect_near("inside, bricks", &bricks, &truth, 0.03, 0.3);
    cw_picture_free(&truth);
    cw_picture_free(&picture);
    cw_picture_free(&bricks);
    cw_volume_free(&blobs);
}

/* Turned, sheared, mirrored; of any size; of uneven spacing; of a voxel. */
static void any_place_is_drawn_alike(void **state)
{
    (void)state;
    const cw_transfer soft = test_soft_transfer();
    for (int kind = 0; kind < 8; kind++) {
        cw_volume v = {0};
        const double scale = (double[]){1, 1e-3, 1e3, 1}[kind % 4];
        const bool flat = kind % 4 == 3;
        test_field(&v, 40, 36, flat ? 1 : 32, cube, flat ? test_ramp : test_blobs);
        tilt(&v, scale);
        cw_scene scene = scene_of(&v, &soft, looking(true, 70 * scale, kind < 4 ? 0 : 35));
        cw_picture truth = test_integral(&scene, 0.15);
        scene.sampling.step_vox = 0.5;
        cw_picture picture = test_draw(test_renderer(), &scene);
        expect_near("tilted", &picture, &truth, 0.05, 0.6);
        cw_scene rays = scene;
        rays.mode = CW_MODE_COMPOSITE;
        expect_same("tilted, rays", &scene, &rays, 0.1, 2.5);
        cw_picture_free(&picture);
        cw_picture_free(&truth);
        cw_volume_free(&v);
    }
}

static void opacity_is_of_a_length(void **state)
{
    (void)state;
    cw_volume v = {0};
    cw_transfer soft = test_soft_transfer();
    test_field(&v, 32, 32, 32, (double[]){1, 2, 3}, test_blobs);
    soft.unit_mm = 2.5;
    for (int n = 0; n < 2; n++) {
        cw_scene scene = scene_of(&v, &soft, looking(true, 110, n ? 35 : 0));
        cw_picture truth = test_integral(&scene, 0.15);
        cw_picture picture = test_draw(test_renderer(), &scene);
        expect_near("uneven", &picture, &truth, 0.05, 1.5);
        cw_picture_free(&picture);
        cw_picture_free(&truth);
    }
    cw_volume_free(&v);
}

/* Everything that a mode adds to the integral agrees with ray casting in small steps. */
static void everything_else_is_as_along_rays(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    cw_transfer soft = test_soft_transfer();
    float corners[] = {-20, 3, -20, 20, -4, -15, 5, 6, 20}; /* a triangle through the middle */
    uint32_t triangle[] = {0, 1, 2};
    const cw_mesh mesh = {
        .vertex_count = 3, .positions = corners, .triangle_count = 1, .triangles = triangle};
    test_field(&blobs, 40, 40, 40, cube, test_blobs);
    for (int kind = 0; kind < 14; kind++) {
        cw_scene slices = scene_of(&blobs, &soft, looking(true, 60, kind & 1 ? 35 : 0));
        const int what = kind / 2;
        soft.gradient_count = what >= 5 ? 2 : 0;
        soft.gradients[1] = (cw_opacity_point){0.06, 1};
        slices.lit = what == 0 || what == 6;
        slices.depth_cue = what == 2 || what == 6 ? 0.8f : 0;
        slices.background[0][0] = slices.background[1][2] = 0.7f;
        slices.clip_count = what >= 3 && what <= 6 ? 2 : 0;
        slices.cut_away = what >= 4;
        slices.clips[0] = (cw_clip){{1, 0.3, -0.2}, 1.3};
        slices.clips[1] = (cw_clip){{0.2, 1, 0.1}, what == 5 ? 50 : -3.1};
        slices.sampling.step_vox = 0.2;
        slices.mesh = what == 2 || what == 6 ? &mesh : NULL;
        cw_scene rays = slices;
        rays.mode = CW_MODE_COMPOSITE;
        rays.sampling.step_vox = 0.1; /* rays are lit every other step */
        rays.sampling.stop_opacity = 1;
        expect_same("slices and rays", &slices, &rays, 0.05, 1.5);
    }
    cw_volume_free(&blobs);
}

static void skipping_and_filters_change_nothing(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    const cw_transfer soft = test_soft_transfer();
    test_field(&blobs, 64, 64, 64, cube, test_blobs);
    for (int n = 0; n < 4; n++) {
        cw_scene a = scene_of(&blobs, &soft, looking(true, 90, n & 1 ? 35 : 0));
        cw_scene b = a;
        b.sampling.no_skipping = n < 2;
        b.sampling.exact_filter = n >= 2;
        expect_same("skipping", &a, &b, 0.01, 0.03);
    }
    cw_volume_free(&blobs);
}

/* Cells with a sample without a value are left out, as along rays. */
static void samples_without_a_value_are_empty(void **state)
{
    (void)state;
    cw_volume v = {0};
    const cw_transfer soft = test_soft_transfer();
    test_field(&v, 32, 32, 32, cube, test_blobs);
    float *x = cw_volume_voxels(&v);
    for (size_t n = 0; n < 32 * 32 * 32; n++)
        if (n / 32 % 32 < 12)
            x[n] = -7;
    v.has_nodata = true;
    v.nodata = -7;
    cw_scene slices = scene_of(&v, &soft, looking(true, 45, 30));
    slices.sampling.step_vox = 0.1;
    cw_scene rays = slices;
    rays.mode = CW_MODE_COMPOSITE;
    expect_same("no value", &slices, &rays, 0.15, 2);
    cw_volume_free(&v);
}

static void too_many_slices_are_refused(void **state)
{
    (void)state;
    cw_volume v = {0};
    cw_error err = {0};
    cw_picture picture;
    const cw_transfer soft = test_soft_transfer();
    test_field(&v, 8, 8, 8, (double[]){1, 1, 1e7}, test_blobs);
    cw_scene scene = scene_of(&v, &soft, looking(true, 1e8, 0));
    scene.width = scene.height = 8;
    scene.sampling.no_preintegration = true;
    assert_int_equal(cw_render(test_renderer(), &scene, &picture, &err), CW_ERR_LIMIT);
    assert_null(picture.pixels);
    scene.sampling.step_vox = 1000;
    assert_ok(cw_render(test_renderer(), &scene, &picture, &err), err);
    cw_picture_free(&picture);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texture_matrix_is_right),
        cmocka_unit_test(marks_cover_a_box_once),
        cmocka_unit_test(constant_box_is_exact),
        cmocka_unit_test(ramp_is_near_the_truth),
        cmocka_unit_test(slices_converge),
        cmocka_unit_test(blending_rounds),
        cmocka_unit_test(bricks_have_no_seams),
        cmocka_unit_test(an_eye_inside_sees_what_is_ahead),
        cmocka_unit_test(any_place_is_drawn_alike),
        cmocka_unit_test(opacity_is_of_a_length),
        cmocka_unit_test(everything_else_is_as_along_rays),
        cmocka_unit_test(skipping_and_filters_change_nothing),
        cmocka_unit_test(samples_without_a_value_are_empty),
        cmocka_unit_test(too_many_slices_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
