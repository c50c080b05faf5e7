/* Tests the reference renderer of volumes against formulas: opacity, depth cue, cells without
 * values, and meshes. */
#include "support/pictures.h"
#include "support/rays.h"

#include "viewer/cpu/reference_volume.h"

#include <math.h>
#include <string.h>

static const double cube[3] = {1, 1, 1};

/* From the front, orthographically: rays go along y. */
static cw_camera straight(double height_mm)
{
    return (cw_camera){.eye = {0, -500, 0}, .up = {0, 0, 1}, .height_mm = height_mm};
}

/* From aslant, close. */
static cw_camera aslant(double distance)
{
    return (cw_camera){.eye = {0.6 * distance, -0.8 * distance, 0.5 * distance},
                       .up = {0.1, 0, 1},
                       .fov_deg = 40};
}

static cw_scene scene_of(const cw_volume *volume, const cw_transfer *transfer, cw_camera camera)
{
    return (cw_scene){.mode = CW_MODE_REFERENCE,
                      .volume = volume,
                      .transfer = transfer,
                      .camera = camera,
                      .width = 8,
                      .height = 8};
}

static double ray_of(const cw_scene *scene, double x, double y, double out[4])
{
    const cwi_frame frame = test_frame(scene);
    cwi_reference reference;
    cwi_reference_make(&frame, NULL, &reference);
    return cwi_reference_ray(&reference, NULL, x, y, INFINITY, out);
}

static void expect_box(const cw_scene *scene, double length)
{
    double out[4];
    ray_of(scene, 4, 4, out);
    assert_near(out[3], 1 - pow(1 - (double)0.05f, length), 1e-12);
    assert_near(out[0], (double)0.8f * out[3], 1e-11);
    assert_near(out[2], (double)0.4f * out[3], 1e-11);
}

/* A ray through 32 mm that each take half of the light ends where nothing shows the rest. */
static void rays_end_in_the_dark_only(void **state)
{
    (void)state;
    cw_volume box = {0};
    const cw_transfer half = {
        .opacity_count = 2, .opacities = {{-9, 0.5f}, {9, 0.5f}}, .unit_mm = 1};
    test_field(&box, 24, 33, 20, cube, test_constant);
    const cw_scene scene = scene_of(&box, &half, straight(10));
    double out[4];
    assert_true(ray_of(&scene, 4, 4, out) < 1e-8);
    assert_near(out[3], 1 - pow(0.5, 32), 1e-9);
    cw_volume_free(&box);
}

/* Beer and Lambert, straight through, cut, cut away, and aslant. */
static void constant_box_is_exact(void **state)
{
    (void)state;
    cw_volume box = {0};
    const cw_transfer flat = test_flat_transfer();
    test_field(&box, 24, 33, 20, cube, test_constant);
    cw_scene scene = scene_of(&box, &flat, straight(10));
    expect_box(&scene, 32);
    scene.clip_count = 2;
    scene.clips[0] = (cw_clip){{0, 2, 0}, -14}; /* y >= -7 */
    scene.clips[1] = (cw_clip){{0, -1, 0}, -3}; /* y <= 3 */
    expect_box(&scene, 10);
    scene.cut_away = true;
    expect_box(&scene, 22);
    scene.clips[1].distance_mm = 8; /* y <= -8: nothing is cut away */
    expect_box(&scene, 32);
    scene.clip_count = 0;
    scene.camera = (cw_camera){.eye = {-100, -100, 0}, .up = {0, 0, 1}, .fov_deg = 20};
    expect_box(&scene, 23 * sqrt(2));
    scene.camera = (cw_camera){.eye = {0, -1, 0}, .up = {0, 0, 1}, .fov_deg = 20};
    scene.camera.target[1] =
        1; /* from inside; what is nearer than the near plane is not seen */
    const cwi_frame frame = test_frame(&scene);
    expect_box(&scene, 17 - frame.near);
    cw_volume_free(&box);
}

/* Lengths of opacities are in millimetres or in voxels, whatever the world's unit. */
static void opacity_is_of_a_length(void **state)
{
    (void)state;
    cw_volume box = {0};
    cw_transfer flat = test_flat_transfer();
    static const struct {
        double spacing[3], unit_mm, length;
    } cases[] = {{{1, 1, 1}, 0, 20},          {{2, 3, 4}, 0, 30}, /* of 2 mm */
                 {{2, 3, 4}, 1, 60},          {{4, 3, 2}, 0.5, 120},
                 {{1e-3, 1e-3, 1e-3}, 0, 20}, {{1e3, 1e3, 1e3}, 0, 20},
                 {{1e3, 1e3, 1e3}, 500, 40}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        const double size = cases[n].spacing[0];
        test_field(&box, 21, 21, 21, cases[n].spacing, test_constant);
        flat.unit_mm = cases[n].unit_mm;
        const cw_camera camera = {
            .eye = {0, -900 * size, 0}, .up = {0, 0, 1}, .height_mm = 8 * size};
        const cw_scene scene = scene_of(&box, &flat, camera);
        expect_box(&scene, cases[n].length);
        cw_volume_free(&box);
    }
}

static void shear(cw_volume *v)
{
    v->affine[0][1] = 0.3;
    v->affine[1][2] = -0.2;
    v->affine[2][0] = 0.1;
}

static void mirror(cw_volume *v)
{
    v->affine[0][0] *= -1;
    v->affine[0][3] *= -1;
    shear(v);
}

static const cw_transfer ramp_transfer = {
    .color_count = 2,
    .colors = {{0, {0.1f, 0.4f, 1}}, {1, {1, 0.3f, 0.2f}}},
    .opacity_count = 2,
    .opacities = {{0, 0}, {1, 0.3f}},
};

static const cw_transfer jumpy_transfer = {
    .color_count = 4,
    .colors = {{0.2, {1, 0, 0}}, {0.5, {1, 1, 0}}, {0.5, {0, 0, 1}}, {0.9, {0, 1, 1}}},
    .opacity_count = 6,
    .opacities = {{0.1, 0}, {0.3, 0.2f}, {0.3, 0}, {0.6, 0}, {0.6, 0.4f}, {0.8, 1}},
};

/* Many small steps get to the same, whatever the field, the camera and the grid. */
static void many_small_steps_agree(void **state)
{
    (void)state;
    const cw_transfer tent = test_tent_transfer(), soft = test_soft_transfer();
    cw_transfer edges = soft;
    edges.gradient_count = 3;
    edges.gradients[0] = (cw_opacity_point){0.02, 0};
    edges.gradients[1] = (cw_opacity_point){0.08, 1};
    edges.gradients[2] = (cw_opacity_point){0.3, 0.2f};
    const struct {
        double (*field)(const double p[3], const double q[3]);
        const cw_transfer *transfer;
        void (*change)(cw_volume *v);
        bool perspective, lit;
        float depth_cue;
        double margin;
        double cue_range[2];
        cw_cue_form cue_form;
    } cases[] = {
        {test_ramp, &ramp_transfer, NULL, false, false, 0, 1e-8, {0, 0}, CW_CUE_LINEAR},
        {test_ramp, &ramp_transfer, NULL, true, false, 0, 1e-8, {0, 0}, CW_CUE_LINEAR},
        {test_ramp, &tent, NULL, true, false, 0, 1e-7, {0, 0}, CW_CUE_LINEAR},
        {test_cubic, &ramp_transfer, shear, true, false, 0.6f, 1e-8, {0, 0}, CW_CUE_LINEAR},
        {test_cubic, &tent, mirror, false, false, 0, 1e-6, {0, 0}, CW_CUE_LINEAR},
        {test_cubic,
         &jumpy_transfer,
         NULL,
         true,
         false,
         0,
         2e-4,
         {0, 0},
         CW_CUE_LINEAR}, /* steps miss the jumps */
        {test_blobs, &soft, mirror, true, false, 1, 1e-7, {0, 0}, CW_CUE_LINEAR},
        {test_blobs, &soft, shear, true, true, 0.5f, 1e-6, {0, 0}, CW_CUE_LINEAR},
        {test_blobs, &edges, NULL, true, true, 0, 1e-6, {0, 0}, CW_CUE_LINEAR},
        {test_cubic,
         &ramp_transfer,
         NULL,
         true,
         true,
         0,
         1e-6,
         {0, 0},
         CW_CUE_LINEAR}, /* lit at the border */
        {test_cubic, &ramp_transfer, NULL, true, false, 0.6f, 1e-7, {0.3, 0.6}, CW_CUE_LINEAR},
        {test_blobs, &soft, NULL, true, true, 0.9f, 1e-6, {0.4, 0.7}, CW_CUE_EXPONENTIAL},
        {test_ramp, &soft, shear, false, false, 0.9f, 1e-7, {-2, 3}, CW_CUE_EXPONENTIAL},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        cw_volume volume = {0};
        test_field(&volume, 13, 11, 14, (const double[3]){1, 1.5, 1.2}, cases[n].field);
        if (cases[n].change)
            cases[n].change(&volume);
        cw_scene scene = scene_of(&volume, cases[n].transfer,
                                  cases[n].perspective ? aslant(30) : straight(12));
        scene.lit = cases[n].lit;
        scene.depth_cue = cases[n].depth_cue;
        memcpy(scene.cue_range, cases[n].cue_range, sizeof scene.cue_range);
        scene.cue_form = cases[n].cue_form;
        scene.background[0][1] = 1;
        scene.background[1][2] = 0.5f;
        scene.light_count = 2;
        scene.lights[0] = (cw_light){{1, 2, 2}, {1, 0.8f, 0.6f}};
        scene.lights[1] = (cw_light){{-1, 0, 0.5}, {0.2f, 0.3f, 0.4f}};
        for (int p = 0; p < 6; p++) {
            const double x = (double[]){4.1, 3.2, 4.9}[p / 2],
                         y = (double[]){3.9, 4.6, 3.1}[p / 2];
            scene.one_sided = p & 1;
            const cwi_frame frame = test_frame(&scene);
            double out[4], truth[4];
            const double estimate = ray_of(&scene, x, y, out);
            test_ray(&frame, x, y, 40000, truth);
            assert_true(estimate < 1e-6);
            for (int c = 0; c < 4; c++)
                assert_near(out[c], truth[c], cases[n].margin);
        }
        cw_volume_free(&volume);
    }
}

/* The share lost to the background rises with depth: integrated by parts, on paper. */
static void depth_cue_is_exact_on_paper(void **state)
{
    (void)state;
    cw_volume box = {0};
    const cw_transfer flat = test_flat_transfer();
    test_field(&box, 24, 33, 20, cube, test_constant);
    cw_scene scene = scene_of(&box, &flat, straight(10));
    scene.depth_cue = 0.7f;
    scene.background[0][0] = scene.background[1][0] = 0.25f;
    const cwi_frame f = test_frame(&scene);
    const double tau = -log(1 - (double)0.05f), left = exp(-32 * tau);
    const double slope = (double)0.7f / (f.far - f.near),
                 start = slope * (484 - f.near); /* of the share of the background */
    const double share = start * (1 - left) + slope * (1 / tau - left * (32 + 1 / tau));
    double out[4];
    ray_of(&scene, 4, 4, out);
    assert_near(out[0], (double)0.8f * (1 - left - share) + 0.25 * share, 1e-10);
    assert_near(out[3], 1 - left, 1e-12);
    cw_volume_free(&box);
}

static void slab_of_one_voxel_is_one_of_two(void **state)
{
    (void)state;
    const cw_transfer soft = test_soft_transfer();
    for (int lit = 0; lit < 2; lit++) {
        double out[2][4];
        for (size_t layers = 1; layers <= 2; layers++) {
            cw_volume slab = {0};
            test_field(&slab, 20, 20, layers, cube, test_ramp);
            cw_scene scene = scene_of(&slab, &soft, aslant(20));
            scene.lit = lit;
            ray_of(&scene, 5.2, 3.9, out[layers - 1]);
            cw_volume_free(&slab);
        }
        assert_true(out[0][3] > 0.01);
        for (int c = 0; c < 4; c++)
            assert_near(out[0][c], out[1][c], 1e-12);
    }
}

/* Cells with a corner outside of the domain are transparent. */
static void cells_without_values_are_empty(void **state)
{
    (void)state;
    const cw_transfer flat = test_flat_transfer();
    for (int n = 0; n < 3; n++) {
        cw_volume box = {0};
        test_field(&box, 8, 33, 8, cube, test_constant);
        float *voxels = cw_volume_voxels(&box);
        for (size_t p = 0; p < 8 * 33 * 8; p++)
            if (p / 8 % 33 > 16)
                voxels[p] = (float[]){NAN, INFINITY, -5}[n];
        box.has_nodata = n == 2;
        box.nodata = -5;
        const cw_scene scene = scene_of(&box, &flat, straight(4));
        expect_box(&scene, 16);
        cw_volume_free(&box);
    }
}

/* Numbers of any type and order stand for the same field. */
static void any_type_and_order_is_the_same(void **state)
{
    (void)state;
    const cw_transfer soft = test_soft_transfer();
    const size_t dim[3] = {12, 13, 14};
    double first[4];
    for (int type = 0; type < CW_TYPE_COUNT; type++) {
        cw_error err = {0};
        cw_volume v = {0}, view;
        double out[4];
        assert_ok(cw_volume_alloc(&v, (cw_type)type, dim, 1, 1, &err), err);
        const size_t size = cw_type_size(v.type);
        for (size_t n = 0; n < 12 * 13 * 14; n++) {
            const int value = (int)(n * 7919 % 127);
            unsigned char *at = (unsigned char *)cw_volume_voxels(&v) + n * size;
            if (type == CW_F32)
                *(float *)at = (float)value;
            else if (type == CW_F64)
                *(double *)at = value;
            else
                for (size_t b = 0; b < size; b++) /* little or big endian: below 128 */
                    at[b] = (unsigned char)(*(const unsigned char *)&(uint16_t){1}
                                                ? (b == 0 ? value : 0)
                                                : (b == size - 1 ? value : 0));
        }
        v.slope = -0.01;
        v.intercept = 1.1;
        assert_ok(cw_volume_resolve(&v, &view, &err), err);
        if (type % 2) { /* the same field, seen from its other end */
            view.data = (const char *)view.data + 11 * view.stride[0];
            view.stride[0] *= -1;
            view.affine[0][0] = -1;
            view.affine[0][3] = 11;
        }
        const cw_camera camera = {
            .eye = {40, -30, 20}, .target = {5.5, 6, 6.5}, .up = {0, 0, 1}, .fov_deg = 20};
        const cw_scene scene = scene_of(&view, &soft, camera);
        ray_of(&scene, 3.7, 4.2, type == 0 ? first : out);
        for (int c = 0; c < 4 && type > 0; c++)
            assert_near(out[c], first[c], 1e-9);
        cw_volume_free(&v);
    }
    assert_true(first[3] > 0.1);
}

static void renderer_draws_it_with_any_threads(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_renderer *r;
    cw_volume blobs = {0};
    double estimate;
    const cw_transfer tent = test_tent_transfer();
    test_field(&blobs, 32, 32, 32, cube, test_blobs);
    cw_scene scene = {.volume = &blobs, .transfer = &tent, .lit = true, .depth_cue = 0.5f};
    scene.mode = CW_MODE_REFERENCE;
    scene.width = 40;
    scene.height = 30;
    scene.threads = 1;
    assert_ok(cw_renderer_new(CW_BACKEND_AUTO, &r, &err), err);
    cw_picture one = test_draw(r, &scene);
    assert_string_equal(cw_renderer_name(r), "CPU");
    scene.threads = 3;
    cw_picture three = test_draw(r, &scene);
    assert_memory_equal(one.pixels, three.pixels, 40 * 30 * 4 * sizeof(float));
    const cwi_frame frame = test_frame(&scene);
    assert_ok(cwi_reference_draw(&frame, NULL, NULL, &three, &estimate, &err), err);
    assert_true(estimate > 0 && estimate < 1e-6);
    cw_picture_free(&three);
    scene.threads = 1;
    scene.progress.report = test_stop_after;
    scene.progress.user = &(int){2};
    assert_fails(cw_render(r, &scene, &three, &err), CW_ERR_CANCELLED, "", err);
    cw_picture_free(&one);
    cw_renderer_free(r);
    cw_volume_free(&blobs);
}

/* Rays end at an opaque mesh, and what was drawn lies in front of it. */
static void rays_end_at_a_mesh(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_renderer *r;
    cw_volume box = {0};
    cw_mesh plate = {0};
    const cw_transfer flat = test_flat_transfer();
    test_field(&box, 24, 33, 20, cube, test_constant);
    test_make_cube(&plate);
    double low[3], high[3];
    assert_true(cw_mesh_bounds(&plate, low, high));
    for (size_t n = 0; n < 3 * plate.vertex_count; n++) { /* its front stands at y = -1 */
        const double size = n % 3 == 1 ? 2 : 60;
        const double p = plate.origin[n % 3] + (double)plate.positions[n];
        plate.positions[n] =
            (float)(size * ((p - low[n % 3]) / (high[n % 3] - low[n % 3]) - 0.5) -
                    plate.origin[n % 3]);
    }
    assert_ok(cw_renderer_new(CW_BACKEND_CPU, &r, &err), err);
    cw_scene scene = scene_of(&box, &flat, straight(10));
    scene.mesh = &plate;
    cw_picture both = test_draw(r, &scene);
    scene.mode = CW_MODE_MESH;
    cw_picture alone = test_draw(r, &scene);
    const double alpha = 1 - pow(1 - (double)0.05f, 15);
    for (size_t p = 0; p < 64; p++) {
        assert_true(alone.pixels[4 * p] > 0.3f && alone.pixels[4 * p + 3] == 1);
        assert_near((double)both.pixels[4 * p],
                    (double)0.8f * alpha + (1 - alpha) * (double)alone.pixels[4 * p], 1e-6);
        assert_near((double)both.pixels[4 * p + 3], 1, 1e-6);
    }
    cw_picture_free(&both);
    scene.mesh_look.wireframe = true;
    assert_fails(cw_render(r, &scene, &both, &err), CW_ERR_UNSUPPORTED, "with edges", err);
    scene.mode = CW_MODE_SPLAT;
    assert_fails(cw_render(r, &scene, &both, &err), CW_ERR_UNSUPPORTED, "splat", err);
    cw_picture_free(&alone);
    cw_renderer_free(r);
    cw_mesh_free(&plate);
    cw_volume_free(&box);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constant_box_is_exact),
        cmocka_unit_test(rays_end_in_the_dark_only),
        cmocka_unit_test(opacity_is_of_a_length),
        cmocka_unit_test(many_small_steps_agree),
        cmocka_unit_test(depth_cue_is_exact_on_paper),
        cmocka_unit_test(slab_of_one_voxel_is_one_of_two),
        cmocka_unit_test(cells_without_values_are_empty),
        cmocka_unit_test(any_type_and_order_is_the_same),
        cmocka_unit_test(renderer_draws_it_with_any_threads),
        cmocka_unit_test(rays_end_at_a_mesh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
