/* Tests pictures of slices: colours, perspective, radiological orientation, hiding, and
 * clipping. */
#include "support/pictures.h"

#include "viewer/scene/slice.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 96 };

static const double uneven[3] = {1, 0.8, 1.5};

static double patient(const double p[3], const double q[3])
{
    (void)p;
    return 0.2 * q[0] + 0.3 * q[1] + 0.5 * q[2];
}

/* Colours that tell a value: red falls, green rises. */
static cw_transfer telling(void)
{
    return (cw_transfer){.color_count = 2, .colors = {{0, {1, 0, 0.5f}}, {1, {0, 1, 0.5f}}}};
}

static const float *pixel(const cw_picture *p, size_t x, size_t y)
{
    return p->pixels + 4 * (y * p->width + x);
}

/* The world point under the middle of a pixel of an orthographic picture, in the plane. */
static void point_of(const cw_camera *c, size_t x, size_t y, double world[3])
{
    double right[3], up[3], forward[3];
    cw_error err = {0};
    assert_ok(cw_camera_axes(c, right, up, forward, &err), err);
    const double u = (((double)x + 0.5) / SIDE - 0.5) * c->height_mm,
                 v = (0.5 - ((double)y + 0.5) / SIDE) * c->height_mm;
    for (int a = 0; a < 3; a++)
        world[a] = c->target[a] + u * right[a] + v * up[a];
}

/* Each pixel of a flat slice has the colour of the field there; a trilinear field is known. */
static void check_slice(const cw_volume *v, const cw_slice *slice, bool exact)
{
    cw_renderer *r = test_renderer();
    cw_error err = {0};
    const cw_transfer t = telling();
    cw_renderer_forget(r);
    cw_scene scene = {.mode = CW_MODE_SLICES,
                      .volume = v,
                      .transfer = &t,
                      .width = SIDE,
                      .height = SIDE,
                      .slices = {*slice},
                      .slice_count = 1,
                      .sampling.exact_filter = exact};
    const double *n = slice->normal, length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    size_t inside = 0, wrong = 0;
    assert_ok(cw_slice_camera(v, slice, 1, &scene.camera, &err), err);
    cw_picture picture = test_draw(r, &scene);
    for (size_t p = 0; p < (size_t)SIDE * SIDE; p++) {
        double world[3], index[3], q[3], off = INFINITY;
        const float *at = picture.pixels + 4 * p;
        point_of(&scene.camera, p % SIDE, p / SIDE, world);
        assert_ok(cw_volume_to_index(v, world, index, &err), err);
        for (int a = 0; a < 3; a++) {
            const double last = (double)v->dim[a] - 1;
            q[a] = index[a] / last;
            if (fabs(slice->normal[a]) < 0.999 * length)
                off = fmin(off, fmin(index[a], last - index[a]));
        }
        const double pixel_mm = scene.camera.height_mm / SIDE;
        if (off < -1e-3)
            wrong += at[3] != 0;
        if (off * 0.8 < 3.5 * pixel_mm) /* the frame */
            continue;
        inside++;
        const double value = patient(NULL, q);
        assert_near((double)at[0], 1 - value, 2e-3);
        assert_near((double)at[1], value, 2e-3);
        assert_near((double)at[3], 1, 0);
    }
    assert_int_equal(wrong, 0);
    assert_true(inside > SIDE * SIDE / 5);
    cw_picture_free(&picture);
}

static void slices_have_the_colours_of_their_values(void **state)
{
    (void)state;
    cw_volume v = {0};
    test_field(&v, 40, 48, 32, uneven, patient);
    static const cw_slice slices[] = {{{0, 0, 1}, 3.3},
                                      {{0, -2, 0}, 11},
                                      {{1, 0, 0}, -7},
                                      {{1, 1, 0.4}, 2},
                                      {{-0.2, 0.3, 1}, 1}};
    for (size_t n = 0; n < sizeof slices / sizeof *slices; n++)
        check_slice(&v, &slices[n], n % 2);
    /* in bricks the same */
    cw_renderer *r = test_renderer();
    const cw_transfer t = telling();
    cw_scene scene = {
        .mode = CW_MODE_SLICES, .volume = &v, .transfer = &t, .width = SIDE, .height = SIDE};
    cw_picture whole = test_draw(r, &scene);
    scene.sampling.texture_edge = 17;
    cw_picture parts = test_draw(r, &scene);
    assert_true(test_compare(&whole, &parts).max < 0.6);
    cw_picture_free(&whole);
    cw_picture_free(&parts);
    cw_volume_free(&v);
}

/* In perspective each pixel shows the nearest of the three planes that its ray meets. */
static void perspective_shows_what_the_ray_meets(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_volume v = {0};
    cw_error err = {0};
    const cw_transfer t = telling();
    cw_fit_desc fit = {
        .view = "iso", .fov_deg = 40, .min = {-20, -20, -24}, .max = {20, 20, 24}};
    cw_scene scene = {
        .mode = CW_MODE_SLICES, .volume = &v, .transfer = &t, .width = SIDE, .height = SIDE};
    double right[3], up[3], forward[3];
    size_t checked = 0;
    test_field(&v, 40, 48, 32, uneven, patient);
    assert_ok(cw_camera_fit(&fit, &scene.camera, &err), err);
    assert_ok(cw_camera_axes(&scene.camera, right, up, forward, &err), err);
    cw_renderer_forget(r);
    cw_picture picture = test_draw(r, &scene);
    for (size_t p = 0; p < (size_t)SIDE * SIDE; p++) {
        const double slope = tan(20 * PI / 180);
        const double x = (((double)(p % SIDE) + 0.5) / SIDE * 2 - 1) * slope;
        const double y = (1 - ((double)(p / SIDE) + 0.5) / SIDE * 2) * slope;
        double nearest = INFINITY, second = INFINITY, value = 0, off = 0;
        bool is_close = false;
        for (int plane = 0; plane < 3; plane++) { /* all go through 0 */
            double d[3], world[3], index[3], edge = INFINITY, q[3];
            for (int a = 0; a < 3; a++)
                d[a] = forward[a] + x * right[a] + y * up[a];
            const double along = -scene.camera.eye[plane] / d[plane];
            for (int a = 0; a < 3; a++)
                world[a] = scene.camera.eye[a] + along * d[a];
            assert_ok(cw_volume_to_index(&v, world, index, &err), err);
            for (int a = 0; a < 3; a++) {
                const double last = (double)v.dim[a] - 1;
                q[a] = index[a] / last;
                if (a != plane)
                    edge = fmin(edge, fmin(index[a], last - index[a]));
            }
            is_close = is_close || fabs(edge) < 5; /* the frame is there, or not */
            if (edge < 0)
                continue;
            second = fmin(second, fmax(nearest, along));
            if (along < nearest) {
                nearest = along;
                value = patient(NULL, q);
                off = edge;
            }
        }
        if (is_close || !(off > 0) || second - nearest < 1e-3)
            continue;
        checked++;
        assert_near((double)picture.pixels[4 * p], 1 - value, 2e-3);
        assert_near((double)picture.pixels[4 * p + 1], value, 2e-3);
    }
    assert_true(checked > SIDE * SIDE / 20);
    cw_picture_free(&picture);
    cw_volume_free(&v);
}

/* The patient's right is on the left, where radiologists have it; values rise to the left, the
 * back and the head (LPS). */
static void slices_are_seen_as_in_radiology(void **state)
{
    (void)state;
    cw_volume v = {0};
    cw_error err = {0};
    test_field(&v, 8, 8, 8, uneven, patient);
    static const struct {
        cw_slice slice;
        double right[3], up[3];
    } rows[] = {
        {{{0, 0, 1}, 0}, {1, 0, 0}, {0, -1, 0}}, {{{0, 0, -1}, 0}, {1, 0, 0}, {0, -1, 0}},
        {{{0, 3, 0}, 0}, {1, 0, 0}, {0, 0, 1}},  {{{0, -1, 0}, 0}, {1, 0, 0}, {0, 0, 1}},
        {{{1, 0, 0}, 0}, {0, 1, 0}, {0, 0, 1}},  {{{-1, 0, 0}, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cw_camera c;
        double right[3], up[3], forward[3];
        assert_ok(cw_slice_camera(&v, &rows[n].slice, 2, &c, &err), err);
        assert_ok(cw_camera_axes(&c, right, up, forward, &err), err);
        for (int a = 0; a < 3; a++) {
            assert_near(right[a], rows[n].right[a], 1e-12);
            assert_near(up[a], rows[n].up[a], 1e-12);
        }
    }
    cw_camera c;
    assert_fails(cw_slice_camera(&v, &(cw_slice){{0, 0, 1}, 99}, 1, &c, &err), CW_ERR_ARGUMENT,
                 "misses", err);
    assert_fails(cw_slice_camera(&v, &(cw_slice){{0, 0, 0}, 0}, 1, &c, &err), CW_ERR_ARGUMENT,
                 "direction", err);
    assert_fails(cw_slice_camera(&v, &(cw_slice){{0, 0, 1}, 0}, 0, &c, &err), CW_ERR_ARGUMENT,
                 "wide", err);
    cw_volume_free(&v);
}

/* Two slices cross: on each side of their line the nearer is seen; a mesh between hides. */
static void slices_hide_each_other_rightly(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_volume v = {0};
    const cw_transfer t = telling();
    test_field(&v, 33, 33, 33, (const double[3]){1, 1, 1}, test_ramp);
    cw_mesh sheet = {.vertex_count = 3, .triangle_count = 1};
    float corners[9] = {-99, -4, -99, 99, -4, -99, 0, -4, 160};
    uint32_t order[3] = {0, 1, 2};
    cw_renderer_forget(r);
    sheet.positions = corners;
    sheet.triangles = order;
    const cw_scene scene = {.mode = CW_MODE_SLICES,
                            .volume = &v,
                            .transfer = &t,
                            .mesh = &sheet,
                            .camera = {.eye = {0, -300, 0}, .up = {0, 0, 1}, .height_mm = 36},
                            .width = SIDE,
                            .height = SIDE,
                            .slices = {{{0, 1, 0}, 0}, {{1, 1, 0}, 0}},
                            .slice_count = 2,
                            .mesh_look.color = {0, 0, 1, 1},
                            .material = {1, 0, 0, 1}};
    cw_picture picture = test_draw(r, &scene);
    for (size_t x = 0; x < SIDE; x++) {
        const double world = (((double)x + 0.5) / SIDE - 0.5) * 36;
        const float *at = pixel(&picture, x, SIDE / 2);
        const double value = (world + 16) / 32;
        if (fabs(world) > 15 || fabs(world) < 0.5 || fabs(world - 4) < 0.5)
            continue;
        /* the oblique one is at y = -x: in front of the other for x > 0, of the mesh for x
         * > 4 */
        const bool is_mesh = world < 4;
        assert_near((double)at[0], is_mesh ? 0 : 1 - value, 2e-3);
        assert_near((double)at[2], is_mesh ? 1 : 0.5, 2e-3);
    }
    cw_picture_free(&picture);
    cw_volume_free(&v);
}

/* A plane that clips halves another slice; one that lies in it stays, whichever side
 * is kept. */
static void slices_are_clipped_but_not_by_their_own_plane(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_volume v = {0};
    const cw_transfer t = telling();
    test_field(&v, 33, 33, 33, (const double[3]){1, 1, 1}, test_ramp);
    static const struct {
        cw_clip clip;
        bool away;
        double share;
    } rows[] = {{{{0.3, -1, 0}, -3.1}, false, 0.5}, {{{0.3, -1, 0}, -3.1}, true, 0.5},
                {{{0, 2, 0}, 6.2}, false, 1},       {{{0, 2, 0}, 6.2}, true, 1},
                {{{0, -2, 0}, -6.2}, false, 1},     {{{0, -2, 0}, -6.2}, true, 1}};
    cw_renderer_forget(r);
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        const cw_scene scene = {
            .mode = CW_MODE_SLICES,
            .volume = &v,
            .transfer = &t,
            .camera = {.eye = {0, -300, 0}, .up = {0, 0, 1}, .height_mm = 33},
            .width = SIDE,
            .height = SIDE,
            .slices = {{{0, 1, 0}, 3.1}},
            .slice_count = 1,
            .clips = {rows[n].clip},
            .clip_count = 1,
            .cut_away = rows[n].away};
        cw_picture picture = test_draw(r, &scene);
        size_t covered = 0;
        for (size_t p = 0; p < (size_t)SIDE * SIDE; p++)
            covered += picture.pixels[4 * p + 3] > 0;
        const double whole = 32.0 * 32 / 33 / 33 * SIDE * SIDE;
        assert_within((double)covered, whole * rows[n].share, 0.04);
        cw_picture_free(&picture);
    }
    cw_volume_free(&v);
}

/* Three frames in their colours; what has no value is open. */
static void frames_tell_and_gaps_show(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_volume v = {0};
    cw_error err = {0};
    const cw_transfer t = telling();
    test_field(&v, 33, 33, 33, (const double[3]){1, 1, 1}, test_ramp);
    float *voxels = cw_volume_voxels(&v);
    for (size_t n = 0; n < (size_t)33 * 33 * 33; n++)
        if (n % 33 > 20)
            voxels[n] = NAN;
    cw_renderer_forget(r);
    for (int n = 0; n < 4; n++) {
        cw_slice slice = {.distance_mm = 0.5};
        double color[3];
        slice.normal[n < 3 ? n : 0] = 1;
        slice.normal[2] += n == 3;
        cw_scene scene = {.mode = CW_MODE_SLICES,
                          .volume = &v,
                          .transfer = &t,
                          .width = SIDE,
                          .height = SIDE,
                          .slices = {slice},
                          .slice_count = 1};
        assert_ok(cw_slice_camera(&v, &slice, 1, &scene.camera, &err), err);
        cwi_slice_color(
            &(cw_slice){{n == 3 ? sqrt(0.5) : n == 0, n == 1, n == 3 ? sqrt(0.5) : n == 2}, 0},
            color);
        cw_picture picture = test_draw(r, &scene);
        size_t framed = 0, open = 0;
        for (size_t p = 0; p < (size_t)SIDE * SIDE; p++) {
            const float *at = picture.pixels + 4 * p;
            framed += at[3] == 1 && fabs((double)at[0] - color[0]) < 1e-5 &&
                      fabs((double)at[1] - color[1]) < 1e-5;
            open += at[3] == 0;
        }
        assert_in_range(framed, 3 * SIDE, 9 * SIDE);
        if (n > 0) /* a third has no values; in x = 0.5 all have */
            assert_in_range(open, SIDE * SIDE / 4, SIDE * SIDE * 2 / 3);
        cw_picture_free(&picture);
    }
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slices_have_the_colours_of_their_values),
        cmocka_unit_test(perspective_shows_what_the_ray_meets),
        cmocka_unit_test(slices_are_seen_as_in_radiology),
        cmocka_unit_test(slices_hide_each_other_rightly),
        cmocka_unit_test(slices_are_clipped_but_not_by_their_own_plane),
        cmocka_unit_test(frames_tell_and_gaps_show),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
