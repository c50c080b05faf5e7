/* Tests every mode that draws light which is emitted and absorbed. */
#include "support/meshes.h"
#include "support/pictures.h"

#include <math.h>

static const double cube[3] = {1, 1, 1};

static const cw_mode modes[] = {CW_MODE_COMPOSITE, CW_MODE_TEXTURE,       CW_MODE_PROJECTION,
                                CW_MODE_SPLAT,     CW_MODE_SPLAT_TREE,    CW_MODE_VBUFFER,
                                CW_MODE_REFERENCE, CW_MODE_SHADED_TEXTURE};

enum { MODES = sizeof modes / sizeof *modes, SIDE = 16 };

/* From the front, on the middle of the volume alone: borders are another matter. Light from
 * everywhere, so that the mode that is always lit draws what the others do. */
static cw_scene scene_of(cw_mode mode, const cw_volume *volume, const cw_transfer *transfer)
{
    return (cw_scene){.mode = mode,
                      .volume = volume,
                      .transfer = transfer,
                      .camera = {.eye = {0, -500, 0}, .up = {0, 0, 1}, .height_mm = 10},
                      .material = {.ambient = 1},
                      .sampling.step_vox = 0.25,
                      .width = SIDE,
                      .height = SIDE};
}

/* By OpenGL what it draws, by the CPU the rest. */
static cw_picture draw(cw_scene scene)
{
    static cw_renderer *any;
    cw_error err = {0};
    test_renderer(); /* or skip */
    if (!any)
        assert_ok(cw_renderer_new(CW_BACKEND_AUTO, &any, &err), err);
    cw_renderer_forget(any);
    return test_draw(any, &scene);
}

/* Splats are blurred by a voxel where values end: their rays are as long but not as sharp. */
static void boxes_are_as_opaque_as_they_are_thick(void **state)
{
    (void)state;
    cw_volume box = {0};
    const cw_transfer flat = test_flat_transfer();
    test_field(&box, 24, 33, 20, cube, test_constant);
    const double alpha = 1 - pow(1 - 0.05, 32);
    for (int m = 0; m < MODES; m++) {
        cw_picture p = draw(scene_of(modes[m], &box, &flat));
        for (size_t n = 0; n < SIDE * SIDE; n++) {
            assert_near((double)p.pixels[4 * n + 3], alpha, 1.0 / 255);
            assert_near((double)p.pixels[4 * n], 0.8 * alpha, 1.0 / 255);
        }
        cw_picture_free(&p);
    }
    cw_volume_free(&box);
}

/* The colour of a box of one value behind a depth cue that starts and ends inside of it, by the
 * rendering integral of one line, in every mode. */
static void depth_cues_start_and_end_where_asked(void **state)
{
    (void)state;
    static const double ranges[3][2] = {{0.25, 0.75}, {0, 0}, {-0.5, 0.5}};
    cw_volume box = {0};
    const cw_transfer flat = test_flat_transfer();
    test_field(&box, 24, 33, 20, cube, test_constant);
    for (int n = 0; n < 6; n++) {
        const double *range = ranges[n / 2], end = range[1] == range[0] ? 1 : range[1];
        const double tau = -log(0.95) * 32 / 1000;
        double expected = 0;
        for (int i = 0; i < 1000; i++) {
            const double at = fmax((((double)i + 0.5) / 1000 - range[0]) / (end - range[0]), 0);
            const double kept = n & 1 ? pow(1 - 0.8, at) : 1 - 0.8 * fmin(at, 1);
            expected += (1 - exp(-tau)) * exp(-tau * i) * (0.8 * kept + 0.25 * (1 - kept));
        }
        for (int m = 0; m < MODES; m++) {
            cw_scene s = scene_of(modes[m], &box, &flat);
            s.depth_cue = 0.8f;
            s.cue_range[0] = range[0];
            s.cue_range[1] = range[1];
            s.cue_form = n & 1 ? CW_CUE_EXPONENTIAL : CW_CUE_LINEAR;
            s.background[0][0] = s.background[1][0] = 0.25f;
            cw_picture p = draw(s);
            for (size_t i = 0; i < SIDE * SIDE; i++)
                assert_near((double)p.pixels[4 * i], expected, 1.5 / 255);
            cw_picture_free(&p);
        }
    }
    cw_volume_free(&box);
}

static double along_y(const double p[3], const double q[3])
{
    (void)p;
    return q[1];
}

/* The opacity of a ramp, looked at along and across it. Across, each ray has one value; along,
 * extinction rises from 0 to that of 0.1: its depth is the integral of -ln(1 - 0.1 v). */
static void ramps_are_as_opaque_as_they_are(void **state)
{
    (void)state;
    cw_volume along = {0}, across = {0};
    const cw_transfer rising = {.opacity_count = 2, .opacities = {{0, 0}, {1, 0.1f}}};
    test_field(&along, 20, 33, 20, cube, along_y);
    test_field(&across, 33, 20, 20, cube, test_ramp);
    const double depth = 32 * (0.9 * log(0.9) + 0.1) / 0.1;
    for (int m = 0; m < MODES; m++) {
        cw_picture a = draw(scene_of(modes[m], &along, &rising));
        cw_picture b = draw(scene_of(modes[m], &across, &rising));
        for (size_t n = 0; n < SIDE * SIDE; n++) {
            const double x = ((double)(n % SIDE) + 0.5) / SIDE * 10 - 5, v = x / 32 + 0.5;
            assert_near((double)a.pixels[4 * n + 3], 1 - exp(-depth), 1.0 / 255);
            assert_near((double)b.pixels[4 * n + 3], 1 - pow(1 - 0.1 * v, 19), 1.0 / 255);
        }
        cw_picture_free(&a);
        cw_picture_free(&b);
    }
    cw_volume_free(&along);
    cw_volume_free(&across);
}

/* A plate across the volume's middle hides what is behind it. */
static void make_plate(cw_mesh *plate)
{
    double low[3], high[3];
    test_make_cube(plate);
    assert_true(cw_mesh_bounds(plate, low, high));
    for (size_t n = 0; n < 3 * plate->vertex_count; n++) {
        const double size = n % 3 == 1 ? 1 : 60,
                     p = plate->origin[n % 3] + (double)plate->positions[n];
        plate->positions[n] =
            (float)(size * ((p - low[n % 3]) / (high[n % 3] - low[n % 3]) - 0.5) -
                    plate->origin[n % 3]);
    }
}

static void meshes_hide_what_is_behind(void **state)
{
    (void)state;
    cw_volume box = {0};
    cw_mesh plate = {0};
    const cw_transfer flat = test_flat_transfer();
    test_field(&box, 24, 33, 20, cube, test_constant);
    make_plate(&plate);
    const double alpha = 1 - pow(1 - 0.05, 15.5);
    cw_scene scene = scene_of(CW_MODE_MESH, NULL, NULL);
    scene.material = (cw_material){0};
    scene.mesh = &plate;
    cw_picture alone = draw(scene);
    for (int m = 0; m < MODES; m++) {
        scene = scene_of(modes[m], &box, &flat);
        scene.material = (cw_material){0};
        scene.mesh = &plate;
        if (modes[m] == CW_MODE_SHADED_TEXTURE) /* whose light is not the others' */
            continue;
        /* a sheet of splats is in front of the plate or behind: half a voxel */
        const bool is_splatted = modes[m] == CW_MODE_SPLAT || modes[m] == CW_MODE_SPLAT_TREE;
        cw_picture p = draw(scene);
        for (size_t n = 0; n < SIDE * SIDE; n++) {
            const double expected = 0.8 * alpha + (1 - alpha) * (double)alone.pixels[4 * n];
            assert_near((double)p.pixels[4 * n + 3], 1, 1e-3);
            assert_near((double)p.pixels[4 * n], expected, is_splatted ? 0.02 : 1.0 / 255);
        }
        cw_picture_free(&p);
    }
    cw_picture_free(&alone);
    cw_mesh_free(&plate);
    cw_volume_free(&box);
}

/* The same scene, larger and smaller by a thousand, with opacities per voxel: the
 * same picture. */
static void size_does_not_matter(void **state)
{
    (void)state;
    const cw_transfer soft = test_soft_transfer();
    for (int m = 0; m < MODES; m++) {
        cw_picture pictures[3];
        for (int n = 0; n < 3; n++) {
            cw_volume v = {0};
            const double unit = (double[]){1, 1e-3, 1e3}[n],
                         spacing[3] = {unit, 2 * unit, unit};
            test_field(&v, 24, 12, 24, spacing, test_blobs);
            cw_scene s = scene_of(modes[m], &v, &soft);
            s.camera = (cw_camera){
                .eye = {20 * unit, -70 * unit, 15 * unit}, .up = {0, 0, 1}, .fov_deg = 25};
            pictures[n] = draw(s);
            cw_volume_free(&v);
        }
        assert_true(test_compare(&pictures[0], &pictures[1]).max < 0.1);
        assert_true(test_compare(&pictures[0], &pictures[2]).max < 0.1);
        for (int n = 0; n < 3; n++)
            cw_picture_free(&pictures[n]);
    }
}

enum { CHANGES = 14 };

/* Changes one thing of a scene, so that a picture differs from the last one in nothing else. */
static void change_scene(int change, cw_scene *s, cw_volume *v, cw_transfer *t)
{
    switch (change) {
    case 1:
        t->unit_mm = 3;
        break;
    case 2: /* the spacing, with opacities that are per millimetre since the last change */
        for (int n = 0; n < 12; n++)
            v->affine[n / 4][n % 4] *= 1.5;
        break;
    case 3:
        t->opacities[0].opacity += 0.05f;
        break;
    case 4:
        t->colors[0].color[1] = 0.9f;
        break;
    case 5:
        v->slope = -1;
        break;
    case 6: /* with the slope, from 0 to 1 again */
        v->intercept = 1;
        break;
    case 7:
        v->has_nodata = true;
        v->nodata = cw_volume_value(v, 7, 6, 7) * v->slope - v->intercept * v->slope;
        break;
    case 8: /* other voxels, of the same number */
        v->data = (const char *)v->data + v->stride[2];
        break;
    case 9:
        v->dim[0] -= 3;
        break;
    case 10:
        v->affine[0][3] += 1;
        break;
    case 11:
        s->lit = true;
        break;
    case 12:
        s->sampling.step_vox = 1;
        break;
    case 13:
        s->sampling.no_preintegration = true;
        break;
    default:
        break;
    }
}

/* Draws a scene changed up to here; returns false for what the renderer does not draw. */
static bool draw_changed(cw_renderer *r, cw_mode mode, const cw_volume *field, int changes,
                         cw_picture *picture)
{
    cw_volume v = *field;
    cw_transfer soft = test_soft_transfer();
    cw_scene s = scene_of(mode, &v, &soft);
    cw_error err = {0};
    s.camera.height_mm = 24;
    s.width = s.height = SIDE / 2;
    s.intensity.threshold = 0.5;
    for (int change = 1; change <= changes; change++)
        change_scene(change, &s, &v, &soft);
    const cw_status st = cw_render(r, &s, picture, &err);
    assert_true(st == CW_OK || st == CW_ERR_UNSUPPORTED);
    return st == CW_OK;
}

/* Returns how many pictures the renderer draws of a mode. */
static int check_kept_state(cw_renderer *r, cw_mode mode, const cw_volume *field)
{
    cw_picture kept[CHANGES] = {{0}}, alone;
    int drawn = 0;
    cw_renderer_forget(r);
    while (drawn < CHANGES && draw_changed(r, mode, field, drawn, &kept[drawn]))
        drawn++;
    for (int n = 0; n < drawn; n++) {
        cw_renderer_forget(r);
        assert_true(draw_changed(r, mode, field, n, &alone));
        const test_gap gap = test_compare(&kept[n], &alone);
        if (gap.max > 1e-3)
            fail_msg("%s, change %d: %g of 255 off", cw_mode_name(mode), n, gap.max);
        cw_picture_free(&alone);
        cw_picture_free(&kept[n]);
    }
    return drawn;
}

/* A renderer keeps tables, textures and trees. With any one thing changed it draws what a renderer
 * draws that keeps nothing: first the CPU's, then that of OpenGL. */
static void pictures_do_not_depend_on_those_before(void **state)
{
    (void)state;
    cw_volume field = {0};
    cw_renderer *cpu;
    cw_error err = {0};
    int drawn = 0;
    test_field(&field, 14, 13, 16, (const double[]){1, 1.2, 0.9}, test_blobs);
    field.dim[2]--; /* room to move by a slice */
    assert_ok(cw_renderer_new(CW_BACKEND_CPU, &cpu, &err), err);
    for (int mode = CW_MODE_COMPOSITE; mode < CW_MODE_COUNT; mode++)
        drawn += check_kept_state(cpu, (cw_mode)mode, &field);
    assert_int_equal(drawn, 7 * CHANGES);
    cw_renderer_free(cpu);
    for (int mode = CW_MODE_COMPOSITE; mode < CW_MODE_COUNT; mode++)
        check_kept_state(test_renderer(), (cw_mode)mode, &field);
    cw_volume_free(&field);
}

/* The distance to the middle, from -1 there. */
static double ball(const double p[3], const double q[3])
{
    (void)q;
    return hypot(hypot(p[0] - 11, p[1] - 11), p[2] - 11) / 10 - 1;
}

static double brightness(cw_scene scene, bool one_sided, double z)
{
    scene.one_sided = one_sided;
    scene.light_count = 1;
    scene.lights[0] = (cw_light){{0, 0, z}, {1, 1, 1}};
    cw_picture p = draw(scene);
    double sum = 0;
    for (size_t n = 0; n < SIDE * SIDE; n++)
        sum += (double)p.pixels[4 * n] / SIDE / SIDE;
    cw_picture_free(&p);
    return sum;
}

/* A ball of high values in low ones is lit by a light from the eye, and dark by one from behind;
 * a ball of low values in high ones the other way round. Both sides lit, both are bright.
 * Mirrored volumes and voxels that fall where values rise are no exceptions. */
static void one_sided_light_falls_from_the_side_of_low_values(void **state)
{
    (void)state;
    for (int kind = 0; kind < 8; kind++) {
        const bool is_low = kind & 1; /* values inside */
        cw_volume v = {0};
        const cw_transfer t =
            is_low ? (cw_transfer){.opacity_count = 2, .opacities = {{-0.5, 0.9f}, {-0.3, 0}}}
                   : (cw_transfer){.opacity_count = 2, .opacities = {{0.3, 0}, {0.5, 0.9f}}};
        test_field(&v, 23, 23, 23, cube, ball);
        if (kind & 2)
            test_shear(&v);
        const bool falls = kind & 4;
        float *voxels = cw_volume_voxels(&v);
        for (size_t n = 0; n < 23 * 23 * 23; n++)
            voxels[n] *= is_low != falls ? 1 : -1;
        v.slope = falls ? -1 : 1;
        for (int m = 0; m < MODES; m++) {
            cw_scene s = scene_of(modes[m], &v, &t);
            s.lit = true;
            s.material = (cw_material){.diffuse = 1, .shininess = 1};
            s.camera.height_mm = 6;
            const double front = brightness(s, true, 1), back = brightness(s, true, -1);
            const double both = brightness(s, false, 1);
            if (!((is_low ? back : front) > 0.6 && (is_low ? front : back) < 0.02))
                fail_msg("%s, kind %d: %g from the front, %g from behind",
                         cw_mode_name(modes[m]), kind, front, back);
            assert_near(both, front + back, 0.03);
        }
        cw_volume_free(&v);
    }
}

/* Every mode that is lit is as near to the reference with one side lit as with both. */
static void one_sided_light_is_the_references(void **state)
{
    (void)state;
    cw_volume v = {0};
    const cw_transfer soft = test_soft_transfer();
    test_field(&v, 40, 40, 40, cube, test_blobs);
    for (int m = 0; m < MODES; m++) {
        double rmse[2];
        for (int one = 0; one < 2; one++) {
            cw_scene s = scene_of(modes[m], &v, &soft);
            s.lit = true;
            s.one_sided = one;
            s.material = (cw_material){
                .ambient = 0.1f, .diffuse = 0.9f, .specular = 0.3f, .shininess = 8};
            s.light_count = 2;
            s.lights[0] = (cw_light){{1, 1, 1}, {1, 0.9f, 0.8f}};
            s.lights[1] = (cw_light){{-1, 0.5, -1}, {0.3f, 0.3f, 0.5f}};
            s.camera = (cw_camera){.eye = {30, -80, 25}, .up = {0, 0, 1}, .fov_deg = 25};
            s.width = s.height = 48;
            cw_picture p = draw(s);
            s.mode = CW_MODE_REFERENCE;
            cw_picture exact = draw(s);
            rmse[one] = test_compare(&p, &exact).rmse;
            cw_picture_free(&p);
            cw_picture_free(&exact);
        }
        if (!(rmse[1] <= 1.3 * rmse[0] + 0.05))
            fail_msg("%s: rmse %g with one side lit, %g with both", cw_mode_name(modes[m]),
                     rmse[1], rmse[0]);
    }
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_are_as_opaque_as_they_are_thick),
        cmocka_unit_test(depth_cues_start_and_end_where_asked),
        cmocka_unit_test(ramps_are_as_opaque_as_they_are),
        cmocka_unit_test(meshes_hide_what_is_behind),
        cmocka_unit_test(size_does_not_matter),
        cmocka_unit_test(pictures_do_not_depend_on_those_before),
        cmocka_unit_test(one_sided_light_falls_from_the_side_of_low_values),
        cmocka_unit_test(one_sided_light_is_the_references),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
