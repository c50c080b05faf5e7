/* Tests textures shaded by quantised gradients: directions, relighting, boundaries, and
 * bricks. */
#include "support/integral.h"

#include "viewer/proxy/quantized_normals.h"
#include "viewer/scene/frame_setup.h"

#include "core/base/memory.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

static const double cube[3] = {1, 1, 1};

static cw_scene scene_of(const cw_volume *volume, const cw_transfer *transfer, double fov_deg)
{
    return (cw_scene){
        .mode = CW_MODE_SHADED_TEXTURE,
        .volume = volume,
        .transfer = transfer,
        .camera = {.eye = {60, -90, 45}, .up = {0, 0, 1}, .height_mm = 56, .fov_deg = fov_deg},
        .width = 64,
        .height = 64,
        .sampling.no_preintegration = true};
}

static void expect_near(const char *what, const cw_picture *a, const cw_picture *b, double rmse,
                        double max)
{
    const test_gap gap = test_compare(a, b);
    if (!(gap.rmse <= rmse && gap.max <= max))
        print_message("%s: rmse %.5f of %g, max %.5f of %g\n", what, gap.rmse, rmse, gap.max,
                      max);
    assert_true(gap.rmse <= rmse && gap.max <= max);
}

/* The more directions, the nearer to light by exact gradients. By the nearest voxel what stays is
 * that a voxel has one direction, not a mixture. */
static void more_directions_are_nearer_to_exact(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    double before = INFINITY;
    const cw_transfer soft = test_soft_transfer();
    test_field(&blobs, 40, 40, 40, cube, test_blobs);
    for (int perspective = 0; perspective < 2; perspective++, before = INFINITY) {
        cw_scene scene = scene_of(&blobs, &soft, perspective ? 28 : 0);
        scene.lit = true;
        scene.mode = CW_MODE_TEXTURE;
        cw_picture exact = test_draw(test_renderer(), &scene);
        scene.mode = CW_MODE_SHADED_TEXTURE;
        scene.texture.direction_filter = CW_DIRECTIONS_NEAREST;
        for (int n = 0; n < 5; n++) {
            scene.texture.normals = (size_t[]){4, 16, 64, 256, 4096}[n];
            cw_picture picture = test_draw(test_renderer(), &scene);
            const double rmse = test_compare(&picture, &exact).rmse;
            expect_near("directions", &picture, &exact, (double[]){3, 1.5, 1, 0.9, 0.8}[n], 70);
            assert_true(rmse < before);
            before = rmse;
            cw_picture_free(&picture);
        }
        cw_picture_free(&exact);
    }
    cw_volume_free(&blobs);
}

/* Interpolated directions converge to the reference: each four times as many leave about half of
 * the error, which the nearest voxel's do not. */
static void interpolated_directions_converge(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    cw_error err = {0};
    cw_renderer *any;
    const cw_transfer soft = test_soft_transfer();
    test_renderer(); /* or skip */
    assert_ok(cw_renderer_new(CW_BACKEND_AUTO, &any, &err), err);
    test_field(&blobs, 40, 40, 40, cube, test_blobs);
    for (int kind = 0; kind < 4; kind++) { /* one side lit, perspective */
        double linear[4], nearest = 0;
        cw_scene scene = scene_of(&blobs, &soft, kind & 1 ? 28 : 0);
        scene.lit = true;
        scene.one_sided = kind & 2;
        scene.material = (cw_material){.ambient = 0.1f, .diffuse = 0.9f};
        scene.sampling.step_vox = 0.25;
        scene.mode = CW_MODE_REFERENCE;
        cw_picture exact = test_draw(any, &scene);
        scene.mode = CW_MODE_SHADED_TEXTURE;
        for (int n = 0; n < 5; n++) {
            scene.texture.normals = (size_t[]){64, 256, 1024, 4096, 4096}[n];
            scene.texture.direction_filter =
                n == 4 ? CW_DIRECTIONS_NEAREST : CW_DIRECTIONS_LINEAR;
            cw_picture picture = test_draw(any, &scene);
            *(n == 4 ? &nearest : &linear[n]) = test_compare(&picture, &exact).rmse;
            cw_picture_free(&picture);
        }
        print_message("rmse of 64, 256, 1024, 4096: %.4f %.4f %.4f %.4f; nearest %.4f\n",
                      linear[0], linear[1], linear[2], linear[3], nearest);
        for (int n = 1; n < 4; n++)
            assert_true(linear[n] < 0.7 * linear[n - 1]);
        assert_true(linear[3] < nearest / 4);
        cw_picture_free(&exact);
    }
    cw_volume_free(&blobs);
    cw_renderer_free(any);
}

/* Computes how much a ramp's one gradient, quantised, reflects of a light in the camera's
 * frame. */
static void gain_of(const cw_scene *scene, double gain[3])
{
    cw_error err = {0};
    cwi_frame f;
    cwi_directions d;
    double n[3];
    assert_ok(cwi_frame_init(&f, scene, &err), err);
    assert_ok(cwi_directions_make(scene->texture.normals, &d, &err), err);
    const size_t nearest = cwi_directions_nearest(&d, (double[]){1, 0, 0});
    for (int a = 0; a < 3; a++)
        n[a] = cwi_dot(f.axes[a], d.all[nearest]);
    for (int c = 0; c < 3; c++)
        gain[c] = (double)scene->material.ambient;
    for (size_t l = 0; l < scene->light_count; l++) {
        const double *to = scene->lights[l].direction;
        const double share = fabs(cwi_dot(n, to)) / sqrt(cwi_dot(to, to));
        for (int c = 0; c < 3; c++)
            gain[c] +=
                (double)scene->material.diffuse * share * (double)scene->lights[l].color[c];
    }
    cwi_directions_free(&d);
}

/* A ramp has one gradient, so its light is the integral times a number: in both orders of
 * interpolation, with either rule. */
static void a_ramp_is_shaded_as_computed(void **state)
{
    (void)state;
    cw_volume ramp = {0};
    const cw_transfer t = {.color_count = 2,
                           .colors = {{0, {1, 0.4f, 0.1f}}, {1, {0.2f, 0.6f, 1}}},
                           .opacity_count = 3,
                           .opacities = {{0, 0}, {0.6, 0.02f}, {1, 0.4f}}};
    test_field(&ramp, 33, 25, 20, cube, test_ramp);
    for (int kind = 0; kind < 8; kind++) {
        double gain[3];
        cw_scene scene = scene_of(&ramp, &t, kind & 1 ? 28 : 0);
        scene.texture.colors_first = kind >> 1 & 1;
        scene.sampling.no_preintegration = kind >> 2;
        scene.sampling.step_vox = 0.5;
        scene.texture.normals = 200;
        scene.material = (cw_material){.ambient = 0.3f, .diffuse = 0.6f, .shininess = 1};
        scene.light_count = 2;
        scene.lights[0] = (cw_light){{1, 2, 3}, {1, 0.5f, 0.2f}};
        scene.lights[1] = (cw_light){{-1, 0, 0.5}, {0, 0.3f, 0.4f}};
        gain_of(&scene, gain);
        cw_picture truth = test_integral(&scene, 0.15);
        cw_picture picture = test_draw(test_renderer(), &scene);
        for (size_t p = 0; p < 4 * truth.width * truth.height; p++)
            truth.pixels[p] *= p % 4 < 3 ? (float)gain[p % 4] : 1;
        expect_near("ramp", &picture, &truth, 0.08, 0.5);
        cw_picture_free(&picture);
        cw_picture_free(&truth);
    }
    cw_volume_free(&ramp);
}

/* Another light changes the table of colours, and nothing else: voxels that were changed in
 * secret do not show until cw_renderer_forget() is called. */
static void relighting_leaves_the_texture_alone(void **state)
{
    (void)state;
    cw_volume blobs = {0}, other = {0};
    const cw_transfer soft = test_soft_transfer();
    cw_renderer *r = test_renderer();
    test_field(&blobs, 32, 32, 32, cube, test_blobs);
    test_field(&other, 32, 32, 32, cube, test_blobs);
    cw_scene scene = scene_of(&blobs, &soft, 0);
    scene.texture.direction_filter = CW_DIRECTIONS_NEAREST;
    cw_picture front = test_draw(r, &scene);
    memset(cw_volume_voxels(&blobs), 0, sizeof(float[32 * 32 * 32]));
    scene.light_count = 1;
    scene.lights[0] = (cw_light){{1, 0.2, 0.1}, {1, 1, 1}};
    cw_picture kept = test_draw(r, &scene);
    assert_true(test_compare(&front, &kept).max > 10); /* it is another light */
    scene.volume = &other;
    cw_picture fresh = test_draw(r, &scene);
    assert_true(test_compare(&fresh, &kept).max == 0);
    scene.volume = &blobs;
    cw_renderer_forget(r);
    cw_picture told = test_draw(r, &scene);
    assert_true(test_compare(&fresh, &told).max > 10);
    cw_picture_free(&front);
    cw_picture_free(&kept);
    cw_picture_free(&fresh);
    cw_picture_free(&told);
    cw_volume_free(&blobs);
    cw_volume_free(&other);
}

/* Along a ramp only the cells in which a point of the opacity lies are at a boundary, and those
 * beside them. */
static void boundaries_are_where_materials_meet(void **state)
{
    (void)state;
    cw_volume ramp = {0};
    const cw_transfer t = {.opacity_count = 3,
                           .opacities = {{0.26, 0.1f}, {0.51, 0.2f}, {0.8, 0.3f}}};
    test_field(&ramp, 21, 9, 21, cube, test_ramp);
    cw_scene scene = scene_of(&ramp, &t, 0);
    scene.camera = (cw_camera){.eye = {0, -500, 0}, .up = {0, 0, 1}, .height_mm = 20};
    scene.width = scene.height = 80; /* four samples a cell */
    for (int bricks = 0; bricks < 2; bricks++) {
        scene.sampling.texture_edge = bricks ? 6 : 0;
        scene.texture.mark_boundary = false;
        cw_picture all = test_draw(test_renderer(), &scene);
        scene.texture.mark_boundary = true;
        cw_picture marked = test_draw(test_renderer(), &scene);
        for (size_t p = 0; p < 80 * 80; p++) {
            const size_t cell = p % 80 / 4;
            const float full = all.pixels[4 * p + 3], got = marked.pixels[4 * p + 3];
            assert_true(full > 0.3f);
            /* 0.8 is a sample's value, in single precision a little more: of the cell below */
            const bool is_marked = cell % 5 != 2 && cell % 5 != 3 && cell > 3 && cell < 17;
            assert_true(is_marked ? fabsf(got - full) < 1e-4f : got == 0);
        }
        cw_picture_free(&all);
        cw_picture_free(&marked);
    }
    cw_volume_free(&ramp);
}

/* A ball, whose surface is between two voxels. */
static double ball(const double p[3], const double q[3])
{
    (void)q;
    return 10 - hypot(hypot(p[0] - 13, p[1] - 13), p[2] - 13);
}

/* The boundary of a ball hides what is behind it everywhere, however short the path of a ray
 * through the cell that it enters by. */
static void boundaries_have_no_holes(void **state)
{
    (void)state;
    cw_volume v = {0};
    const cw_transfer t = {.opacity_count = 2, .opacities = {{0, 0}, {0.3, 0.6f}}};
    test_field(&v, 27, 27, 27, cube, ball);
    for (int kind = 0; kind < 4; kind++) {
        cw_scene scene = scene_of(&v, &t, kind & 1 ? 28 : 0);
        const double distance = 117, scale = 64 / 56.0; /* samples per mm, in the middle */
        scene.texture.mark_boundary = true;
        scene.sampling.step_vox = kind & 2 ? 1 : 0.25;
        if (kind & 1)
            scene.camera.height_mm = 2 * distance * tan(14 * 3.14159265358979 / 180);
        cw_picture p = test_draw(test_renderer(), &scene);
        for (size_t n = 0; n < 64 * 64; n++) {
            const double b = hypot((double)(n % 64) - 31.5, (double)(n / 64) - 31.5) / scale;
            if (b < 8)
                assert_true(p.pixels[4 * n + 3] > 0.9f);
        }
        cw_picture_free(&p);
    }
    cw_volume_free(&v);
}

/* Computes the mean colour and extinction between two opacities, where red rises from 0 to 1. */
static void expected_material(double from, double to, double a, double b, double out[2])
{
    double red = 0, sum = 0;
    for (int n = 0; n < 1000; n++) {
        const double at = (n + 0.5) / 1000, extinction = -log(1 - a - at * (b - a));
        red += extinction * (from + at * (to - from));
        sum += extinction;
    }
    out[0] = sum > 0 ? red / sum : 0;
    out[1] = sum / 1000;
}

/* By materials each interval of a ramp has one colour and one opacity, the means over it; what is
 * invisible stays so. */
static void materials_have_their_means(void **state)
{
    (void)state;
    cw_volume ramp = {0};
    const cw_transfer t = {.color_count = 2,
                           .colors = {{0, {0, 0, 0}}, {1, {1, 0, 0}}},
                           .opacity_count = 4,
                           .opacities = {{0.11, 0}, {0.26, 0}, {0.51, 0.3f}, {0.81, 0.4f}}};
    const double ends[6] = {0, 0.11, 0.26, 0.51, 0.81, 1},
                 opacities[6] = {0, 0, 0, 0.3, 0.4, 0.4};
    test_field(&ramp, 21, 9, 21, cube, test_ramp);
    cw_scene scene = scene_of(&ramp, &t, 0);
    scene.camera = (cw_camera){.eye = {0, -500, 0}, .up = {0, 0, 1}, .height_mm = 20};
    scene.width = scene.height = 80; /* four samples a cell */
    scene.material = (cw_material){.ambient = 1};
    scene.texture.material_table = true;
    for (int kind = 0; kind < 6;
         kind++) { /* one side lit or both, and the three ways to look up */
        scene.one_sided = kind & 1;
        scene.texture.direction_filter =
            kind / 2 == 0 ? CW_DIRECTIONS_LINEAR : CW_DIRECTIONS_NEAREST;
        scene.texture.colors_first = kind / 2 == 2;
        cw_picture p = test_draw(test_renderer(), &scene);
        for (size_t n = 0; n < 80 * 80; n++) {
            const double value = ((double)(n % 80) + 0.5) / 80;
            const size_t cell = n % 80 / 4;
            int m = 0;
            double expected[2];
            while (value > ends[m + 1])
                m++;
            if (cell == 2 || cell == 5 || cell == 10 || cell == 16) /* of two materials */
                continue;
            expected_material(ends[m], ends[m + 1], opacities[m], opacities[m + 1], expected);
            const double alpha = 1 - exp(-8 * expected[1]);
            assert_near((double)p.pixels[4 * n + 3], alpha, 2e-3);
            assert_near((double)p.pixels[4 * n], alpha * expected[0], 2e-3);
        }
        cw_picture_free(&p);
    }
    cw_volume_free(&ramp);
}

/* Bricks, and a volume of a single layer. */
static void bricks_and_layers_are_shaded_alike(void **state)
{
    (void)state;
    const cw_transfer soft = test_soft_transfer();
    for (int n = 0; n < 6; n++) {
        cw_volume v = {0};
        test_field(&v, 40, 36, n == 5 ? 1 : 40, cube, n == 5 ? test_ramp : test_blobs);
        cw_scene scene = scene_of(&v, &soft, n & 1 ? 28 : 0);
        scene.texture.colors_first = n >> 1 & 1;
        scene.texture.direction_filter = n == 1 ? CW_DIRECTIONS_NEAREST : CW_DIRECTIONS_LINEAR;
        scene.texture.material_table = n == 0;
        scene.texture.mark_boundary = n == 4;
        scene.sampling.step_vox = 0.5;
        cw_picture one = test_draw(test_renderer(), &scene);
        scene.sampling.texture_edge = 17;
        cw_picture parts = test_draw(test_renderer(), &scene);
        /* A slab that is cut in two is in two cells. */
        expect_near("bricks", &one, &parts, n == 4 ? 0.4 : 0.1, n == 4 ? 30 : 8);
        cw_picture_free(&one);
        cw_picture_free(&parts);
        cw_volume_free(&v);
    }
}

static void too_many_directions_are_refused(void **state)
{
    (void)state;
    cw_volume v = {0};
    cw_error err = {0};
    cw_picture picture;
    const cw_transfer soft = test_soft_transfer();
    test_field(&v, 8, 8, 8, cube, test_blobs);
    cw_scene scene = scene_of(&v, &soft, 0);
    scene.texture.normals = 10000;
    assert_int_equal(cw_render(test_renderer(), &scene, &picture, &err), CW_ERR_ARGUMENT);
    assert_non_null(strstr(err.message, "10000 directions"));
    assert_null(picture.pixels);
    cw_volume_free(&v);
}

/* Wherever memory runs out, that is said, and the next picture is whole. */
static void lack_of_memory_is_told(void **state)
{
    (void)state;
    cw_volume v = {0};
    cw_renderer *r = test_renderer();
    const cw_transfer soft = test_soft_transfer();
    test_field(&v, 20, 20, 20, cube, test_blobs);
    for (int kind = 0; kind < 4; kind++) {
        long fails = 0;
        cw_scene scene = scene_of(&v, &soft, 0);
        scene.mode = kind == 0 || kind == 3 ? CW_MODE_SHADED_TEXTURE : CW_MODE_TEXTURE;
        scene.texture.direction_filter =
            kind == 3 ? CW_DIRECTIONS_NEAREST : CW_DIRECTIONS_LINEAR;
        scene.texture.colors_first = kind == 1;
        scene.texture.target = kind == 2 ? CW_TARGET_16 : CW_TARGET_32F;
        scene.sampling.texture_edge = 12;
        scene.texture.normals = 100;
        cw_picture whole = test_draw(r, &scene), picture;
        for (bool failed = true; failed; fails++) {
            cw_error err = {0};
            cw_renderer_forget(r);
            cwi_alloc_fail_after(fails);
            const cw_status st = cw_render(r, &scene, &picture, &err);
            failed = cwi_alloc_fail_after(-1);
            assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        }
        assert_true(fails > 10);
        assert_true(test_compare(&whole, &picture).max == 0);
        cw_picture_free(&whole);
        cw_picture_free(&picture);
    }
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(more_directions_are_nearer_to_exact),
        cmocka_unit_test(interpolated_directions_converge),
        cmocka_unit_test(a_ramp_is_shaded_as_computed),
        cmocka_unit_test(relighting_leaves_the_texture_alone),
        cmocka_unit_test(boundaries_are_where_materials_meet),
        cmocka_unit_test(boundaries_have_no_holes),
        cmocka_unit_test(materials_have_their_means),
        cmocka_unit_test(bricks_and_layers_are_shaded_alike),
        cmocka_unit_test(too_many_directions_are_refused),
        cmocka_unit_test(lack_of_memory_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
