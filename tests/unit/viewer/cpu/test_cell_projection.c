/* Tests cell projection on the CPU: against the rendering integral, against OpenGL, and with any
 * number of threads. */
#include "support/meshes.h"
#include "support/views.h"

#include "core/base/module.h"

#include <math.h>

enum { EDGE = 32, SIZE = 64 };

static const double cube[3] = {1, 1, 1};

static cw_renderer *cpu_renderer(void)
{
    static cw_renderer *r;
    cw_error err = {0};
    if (!r)
        assert_ok(cw_renderer_new(CW_BACKEND_CPU, &r, &err), err);
    cw_renderer_forget(r);
    return r;
}

static cw_scene scene_of(const cw_volume *volume, const cw_transfer *transfer, cw_camera camera)
{
    return (cw_scene){.mode = CW_MODE_PROJECTION,
                      .volume = volume,
                      .transfer = transfer,
                      .camera = camera,
                      .width = SIZE,
                      .height = SIZE};
}

static test_gap compare_and_free(cw_picture a, cw_picture b)
{
    const test_gap gap = test_compare(&a, &b);
    cw_picture_free(&a);
    cw_picture_free(&b);
    return gap;
}

/* The difference from the rendering integral. */
static test_gap error_of(cw_renderer *r, const cw_scene *scene)
{
    cw_scene exact = *scene;
    exact.mode = CW_MODE_REFERENCE;
    return compare_and_free(test_draw(r, scene), test_draw(cpu_renderer(), &exact));
}

/* Noise makes neighbours differ as they do in a scan. */
static double noisy_blobs(const double p[3], const double q[3])
{
    const double x = sin(12.9898 * p[0] + 78.233 * p[1] + 37.719 * p[2]) * 43758.5453;
    return test_blobs(p, q) + 0.1 * (x - floor(x) - 0.5);
}

static const double views[][2] = {{0, 0}, {90, 0}, {0, 89.9}, {45, 0}, {30, 25}, {45, 35.2644}};
enum { VIEWS = sizeof views / sizeof *views };

typedef struct example {
    const char *name;
    double (*field)(const double p[3], const double q[3]);
    cw_transfer transfer;
    double max_error, max_gap; /* rmse against the integral, and against GL, in 1/255 */
} example;

/* Constant and linear fields are exact but for tables. For others, what a ray meets in a cell is
 * linear between its faces; GL makes it linear over triangles of faces, too. */
static void errors_are_not_above_those_of_opengl(void **state)
{
    (void)state;
    const example examples[] = {
        {"constant", test_constant, test_flat_transfer(), 1e-4, 0.002},
        {"ramp", test_ramp, test_soft_transfer(), 0.01, 0.005},
        {"ramp, tent", test_ramp, test_tent_transfer(), 0.03, 0.01},
        {"blobs", test_blobs, test_soft_transfer(), 0.12, 0.2},
        {"blobs, tent", test_blobs, test_tent_transfer(), 1.1, 1.1},
        {"noise", noisy_blobs, test_soft_transfer(), 0.27, 0.3},
    };
    for (size_t c = 0; c < sizeof examples / sizeof *examples; c++) {
        cw_volume volume = {0};
        test_field(&volume, EDGE, EDGE, EDGE, cube, examples[c].field);
        for (size_t n = 0; n < VIEWS; n += test_is_short() ? 3 : 1) {
            const cw_scene scene =
                scene_of(&volume, &examples[c].transfer,
                         test_view(views[n][0], views[n][1], (n + c) % 2 ? 30 : 0, 50));
            const double error = error_of(cpu_renderer(), &scene).rmse;
            if (error > examples[c].max_error)
                fail_msg("%s, view %zu: rmse %g", examples[c].name, n, error);
            if (!cwi_module_present("gl"))
                continue;
            cw_renderer *gl = test_renderer();
            cw_renderer_forget(gl);
            const double gl_error = error_of(gl, &scene).rmse;
            const test_gap gap =
                compare_and_free(test_draw(gl, &scene), test_draw(cpu_renderer(), &scene));
            if (error > gl_error + 1e-4 || gap.rmse > examples[c].max_gap)
                fail_msg("%s, view %zu: rmse %g, of GL %g; between them %g, max %g",
                         examples[c].name, n, error, gl_error, gap.rmse, gap.max);
        }
        cw_volume_free(&volume);
    }
}

enum {
    TINY,
    HUGE_WORLD,
    FLAT_VOXELS,
    SHEARED,
    ONE_LAYER,
    LIT,
    LIT_AND_CUT_AWAY,
    BY_GRADIENT,
    FOG,
    CLIPPED,
    TWO_LIGHTS,
    EYE_INSIDE,
    NODATA,
    MIDPOINT,
    LINEAR,
    LINEAR_LIT,
    NODES,
    SHORTS,
    SETTINGS
};

/* A scene with one setting changed. */
typedef struct variant {
    cw_volume volume;
    cw_transfer transfer;
    cw_scene scene;
} variant;

static void make_field(variant *v, int setting)
{
    static const double wide[3] = {1, 2, 0.5};
    const double scale = setting == TINY ? 1e-3 : setting == HUGE_WORLD ? 1e3 : 1;
    const double even[3] = {scale, scale, scale};
    test_field(&v->volume, EDGE, EDGE - 5, setting == ONE_LAYER ? 1 : EDGE,
               setting == FLAT_VOXELS ? wide : even,
               setting == ONE_LAYER ? test_ramp : test_blobs);
    float *voxels = cw_volume_voxels(&v->volume);
    if (setting == SHEARED)
        test_shear(&v->volume);
    if (setting == NODATA) {
        v->volume.has_nodata = true;
        v->volume.nodata = -7;
        for (size_t n = 0; n < EDGE * (EDGE - 5) * EDGE; n += 97)
            voxels[n] = n % 2 ? -7 : NAN;
    }
}

/* The same blobs in 16 bits: the value is a thousandth of the voxel. */
static void turn_to_shorts(cw_volume *v)
{
    cw_volume shorts;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&shorts, CW_I16, v->dim, 1, 1, &err), err);
    int16_t *to = cw_volume_voxels(&shorts);
    const float *from = cw_volume_voxels(v);
    for (size_t n = 0; n < v->dim[0] * v->dim[1] * v->dim[2]; n++)
        to[n] = (int16_t)lrint(1000 * (double)from[n] - 500);
    shorts.slope = 0.001;
    shorts.intercept = 0.5;
    memcpy(shorts.affine, v->affine, sizeof shorts.affine);
    cw_volume_free(v);
    *v = shorts;
}

static void make_variant(variant *v, int setting)
{
    const double scale = setting == TINY ? 1e-3 : setting == HUGE_WORLD ? 1e3 : 1;
    *v = (variant){.transfer = test_soft_transfer()};
    make_field(v, setting);
    if (setting == SHORTS)
        turn_to_shorts(&v->volume);
    cw_scene *s = &v->scene;
    *s = scene_of(NULL, NULL, test_view(30, 25, setting % 2 ? 0 : 30, 60 * scale));
    if (setting == EYE_INSIDE)
        s->camera = test_view(30, 25, 90, 8);
    s->lit = setting == LIT || setting == LIT_AND_CUT_AWAY || setting == TWO_LIGHTS ||
             setting == LINEAR_LIT || setting == NODATA;
    if (setting == BY_GRADIENT) {
        v->transfer.gradient_count = 2;
        v->transfer.gradients[1] = (cw_opacity_point){0.05, 1};
    }
    if (setting == FOG) {
        s->depth_cue = 0.8f;
        s->background[0][0] = 1;
    }
    if (setting == CLIPPED || setting == LIT_AND_CUT_AWAY) {
        s->clip_count = 2;
        s->clips[0] = (cw_clip){{1, 0.3, -0.2}, -3.3};
        s->clips[1] = (cw_clip){{0, -1, 0.1}, -7.1};
        s->cut_away = setting == LIT_AND_CUT_AWAY;
    }
    if (setting == TWO_LIGHTS) {
        s->light_count = 2;
        s->lights[0] = (cw_light){{1, 0, 1}, {1, 0.5f, 0.5f}};
        s->lights[1] = (cw_light){{-1, 1, 0}, {0, 0.5f, 1}};
        s->material = (cw_material){0.2f, 0.6f, 0.4f, 7.5f};
    }
    s->sampling.no_preintegration = setting == MIDPOINT;
    s->projection.linear_opacity = setting == LINEAR || setting == LINEAR_LIT;
    s->projection.tree_error = setting == NODES ? 0.1 : 0;
}

/* Draws a variant by both, and asserts that the pictures are closer than a bound. */
static void settings_agree_with_opengl(void **state)
{
    (void)state;
    cw_renderer *gl = test_renderer();
    for (int n = 0; n < SETTINGS; n++) {
        variant v;
        make_variant(&v, n);
        v.scene.volume = &v.volume;
        v.scene.transfer = &v.transfer;
        cw_renderer_forget(gl);
        const test_gap gap =
            compare_and_free(test_draw(gl, &v.scene), test_draw(cpu_renderer(), &v.scene));
        const bool is_near = n == EYE_INSIDE; /* a cell is many pixels wide */
        if (gap.rmse > (is_near ? 0.3 : 0.05) || gap.max > (is_near ? 3 : 1.2))
            fail_msg("setting %d: rmse %g, max %g", n, gap.rmse, gap.max);
        cw_volume_free(&v.volume);
    }
}

/* A mesh ends rays at its depth. Its own pixels differ by rounding to bytes, and by its edges. */
static void meshes_end_rays_as_with_opengl(void **state)
{
    (void)state;
    cw_renderer *gl = test_renderer();
    cw_mesh cubes = {0};
    variant v;
    make_variant(&v, SHEARED);
    test_make_cube(&cubes);
    for (size_t n = 0; n < 3 * cubes.vertex_count; n++)
        cubes.positions[n] *= 8;
    v.scene.volume = &v.volume;
    v.scene.transfer = &v.transfer;
    v.scene.mesh = &cubes;
    for (int n = 0; n < 2; n++) {
        v.scene.camera.fov_deg = n ? 30 : 0;
        cw_renderer_forget(gl);
        const test_gap gap =
            compare_and_free(test_draw(gl, &v.scene), test_draw(cpu_renderer(), &v.scene));
        if (gap.rmse > 0.1)
            fail_msg("view %d: rmse %g, max %g", n, gap.rmse, gap.max);
    }
    cw_mesh_free(&cubes);
    cw_volume_free(&v.volume);
}

static void threads_do_not_show(void **state)
{
    (void)state;
    for (int n = 0; n < SETTINGS; n++) {
        variant v;
        make_variant(&v, n);
        v.scene.volume = &v.volume;
        v.scene.transfer = &v.transfer;
        v.scene.width = 100; /* tiles cut off at the right and below */
        v.scene.threads = 1;
        cw_picture one = test_draw(cpu_renderer(), &v.scene);
        v.scene.threads = 7;
        cw_picture many = test_draw(cpu_renderer(), &v.scene);
        assert_memory_equal(one.pixels, many.pixels, 100 * SIZE * 4 * sizeof *one.pixels);
        cw_picture_free(&one);
        cw_picture_free(&many);
        cw_volume_free(&v.volume);
    }
}

/* Rays that end when they are opaque hide no more than that. */
static void opaque_samples_hide_little(void **state)
{
    (void)state;
    cw_volume blobs = {0};
    const cw_transfer tent = test_tent_transfer();
    test_field(&blobs, EDGE, EDGE, EDGE, cube, test_blobs);
    cw_scene scene = scene_of(&blobs, &tent, test_view(30, 25, 30, 50));
    scene.sampling.stop_opacity = 1;
    cw_picture whole = test_draw(cpu_renderer(), &scene);
    for (int n = 0; n < 2; n++) {
        scene.sampling.stop_opacity = n ? 0.9f : 0;
        cw_picture stopped = test_draw(cpu_renderer(), &scene);
        assert_true(test_compare(&stopped, &whole).max <= 255 * (n ? 0.1 : 1e-4) + 1e-3);
        cw_picture_free(&stopped);
    }
    cw_picture_free(&whole);
    cw_volume_free(&blobs);
}

/* A ray in the plane between two cells is in one of them, so that a box is as opaque as it is
 * thick wherever it is met. */
static void rays_between_cells_are_in_one(void **state)
{
    (void)state;
    cw_volume box = {0};
    const cw_transfer flat = test_flat_transfer();
    test_field(&box, 9, 9, 9, cube, test_constant);
    for (int axis = 0; axis < 3; axis++) {
        cw_scene scene = scene_of(&box, &flat, test_view(axis == 1 ? 90 : 0, 0, 0, 8));
        if (axis == 2)
            scene.camera = (cw_camera){.eye = {0, 0, 90}, .up = {0, 1, 0}, .height_mm = 8};
        scene.width = scene.height = 15; /* the middles of samples are on planes of voxels */
        scene.camera.height_mm = 7.5;
        cw_picture p = test_draw(cpu_renderer(), &scene);
        for (size_t n = 0; n < 15 * 15; n++)
            assert_near((double)p.pixels[4 * n + 3], 1 - pow(0.95, 8), 1e-4);
        cw_picture_free(&p);
    }
    cw_volume_free(&box);
}

/* AUTO draws by the CPU what software GL takes long for, and by GL what only that draws. */
static void auto_chooses_the_faster(void **state)
{
    (void)state;
    cw_renderer *any;
    cw_error err = {0};
    cw_mesh mesh = {0};
    variant v;
    make_variant(&v, LIT);
    v.scene.volume = &v.volume;
    v.scene.transfer = &v.transfer;
    test_make_cube(&mesh);
    assert_ok(cw_renderer_new(CW_BACKEND_AUTO, &any, &err), err);
    cw_picture p = test_draw(any, &v.scene), q = test_draw(cpu_renderer(), &v.scene);
    const bool is_software = strcmp(cw_renderer_name(any), "CPU") == 0;
    if (is_software)
        assert_memory_equal(p.pixels, q.pixels, SIZE * SIZE * 4 * sizeof *p.pixels);
    cw_picture_free(&p);
    cw_picture_free(&q);
    if (cwi_module_present("gl")) {
        v.scene.mesh = &mesh;
        v.scene.depth_cue = 0.5f;
        p = test_draw(any, &v.scene);
        assert_string_not_equal(cw_renderer_name(any), "CPU");
        cw_picture_free(&p);
    }
    cw_mesh_free(&mesh);
    cw_volume_free(&v.volume);
    cw_renderer_free(any);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_are_not_above_those_of_opengl),
        cmocka_unit_test(settings_agree_with_opengl),
        cmocka_unit_test(meshes_end_rays_as_with_opengl),
        cmocka_unit_test(threads_do_not_show),
        cmocka_unit_test(opaque_samples_hide_little),
        cmocka_unit_test(rays_between_cells_are_in_one),
        cmocka_unit_test(auto_chooses_the_faster),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
