/* Simplified for pictures: nothing in them moves by more pixels than asked for. */
#include "support/surface.h"

#include "core/geometry/point_triangle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double uniform(double from, double to)
{
    return from + (to - from) * (double)rand() / (double)RAND_MAX;
}

static cw_volume noisy_gyroid(size_t n)
{
    const cw_field_desc field = {
        .field = CW_FIELD_GYROID, .dim = {n, n, n}, .type = CW_F32, .noise = 0.1};
    cw_volume volume;
    cw_error err = {0};
    assert_ok(cw_field_sample(&field, &volume, &err), err);
    return volume;
}

static cw_mesh surface(size_t n)
{
    cw_volume volume = noisy_gyroid(n);
    const cw_mesh mesh = test_extract(&volume, NULL, NULL);
    cw_volume_free(&volume);
    return mesh;
}

static double size_of(const cw_mesh *mesh, double middle[3])
{
    double low[3], high[3], square = 0;
    assert_true(cw_mesh_bounds(mesh, low, high));
    for (int a = 0; a < 3; a++) {
        middle[a] = 0.5 * (low[a] + high[a]);
        square += (high[a] - low[a]) * (high[a] - low[a]);
    }
    return sqrt(square);
}

/* Anywhere from inside to far away; every fourth one without perspective. */
static cw_simplify_view random_view(const cw_mesh *mesh, int round)
{
    cw_simplify_view view = {.width = 320, .height = 200};
    double middle[3];
    const double size = size_of(mesh, middle);
    for (int a = 0; a < 3; a++) {
        view.camera.target[a] = middle[a] + uniform(-0.2, 0.2) * size;
        view.camera.eye[a] = middle[a] + uniform(-2, 2) * size;
        view.camera.up[a] = uniform(-1, 1);
    }
    view.camera.fov_deg = round % 4 ? uniform(10, 100) : 0;
    view.camera.height_mm = uniform(0.2, 2) * size;
    return view;
}

static void corners_of(const cw_mesh *m, size_t t, const float *p[3])
{
    for (size_t k = 0; k < 3; k++)
        p[k] = m->positions + 3 * (size_t)m->triangles[3 * t + k];
}

static void random_point(const cw_mesh *m, double world[3])
{
    const float *p[3];
    double u = uniform(0, 1), v = uniform(0, 1);
    corners_of(m, (size_t)rand() % m->triangle_count, p);
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    for (int a = 0; a < 3; a++)
        world[a] = m->origin[a] + (1 - u - v) * (double)p[0][a] + u * (double)p[1][a] +
                   v * (double)p[2][a];
}

/* By looking at all triangles. */
static void nearest_point(const cw_mesh *m, const double world[3], double nearest[3])
{
    const double x[3] = {world[0] - m->origin[0], world[1] - m->origin[1],
                         world[2] - m->origin[2]};
    double best = INFINITY, share[3];
    const float *p[3];
    size_t at = 0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        corners_of(m, t, p);
        const double square = cwi_facet_distance_sq(p[0], p[1], p[2], x);
        at = square < best ? t : at;
        best = fmin(best, square);
    }
    corners_of(m, at, p);
    cwi_facet_nearest(p[0], p[1], p[2], x, share);
    for (int a = 0; a < 3; a++)
        nearest[a] = m->origin[a] + share[0] * (double)p[0][a] + share[1] * (double)p[1][a] +
                     share[2] * (double)p[2][a];
}

static double apart(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* Whether something is before what a picture shows there. */
static bool is_hidden(const cw_simplify_view *view, const double pixel[2], double depth)
{
    const size_t x = (size_t)pixel[0], y = (size_t)pixel[1];
    return view->depth && x < view->width && y < view->height &&
           depth > (double)view->depth[y * view->width + x] + 1e-3;
}

/* How many pixels lie between two points; 0 where the first is not in the picture, hidden, or
 * too near to the eye. */
static double pixels_between(const cw_simplify_view *view, const double a[3], const double b[3])
{
    const cw_camera *c = &view->camera;
    double p[2], q[2], depth;
    if (!cw_camera_project(c, view->width, view->height, a, p, &depth) || p[0] < 0 ||
        p[1] < 0 || p[0] > (double)view->width || p[1] > (double)view->height ||
        (c->fov_deg > 0 && depth < 1e-3 * apart(c->eye, c->target)) ||
        is_hidden(view, p, depth))
        return 0;
    if (!cw_camera_project(c, view->width, view->height, b, q, NULL))
        return INFINITY;
    return hypot(p[0] - q[0], p[1] - q[1]);
}

static void hold(const cw_mesh *a, const cw_mesh *b, const cw_simplify_desc *d, double *most)
{
    for (int n = 0; n < 300; n++) {
        double point[3], near[3];
        random_point(a, point);
        nearest_point(b, point, near);
        assert_true(apart(point, near) <= 1.0001 * d->error_mm);
        for (size_t v = 0; v < d->view_count; v++) {
            const double pixels = pixels_between(d->views + v, point, near);
            *most = fmax(*most, pixels);
            if (pixels > 1.0001 * d->pixel_error)
                fail_msg("%g pixels where %g are promised", pixels, d->pixel_error);
        }
    }
}

static void no_picture_is_off_by_more_pixels(void **state)
{
    (void)state;
    cw_mesh mesh = surface(14);
    double middle[3], most = 0;
    const double size = size_of(&mesh, middle);
    test_seed(7);
    for (int round = 0; round < 4; round += test_is_short() ? 3 : 1) {
        cw_simplify_view views[2] = {random_view(&mesh, round), random_view(&mesh, round + 1)};
        const cw_simplify_desc desc = {.error_mm = 0.03 * size,
                                       .views = views,
                                       .view_count = 1 + (size_t)round % 2,
                                       .pixel_error = uniform(0.3, 2)};
        cw_mesh out;
        cw_error err = {0};
        assert_ok(cw_simplify(&mesh, &desc, &out, NULL, &err), err);
        assert_true(out.triangle_count < mesh.triangle_count);
        test_assert_sound(&mesh, &out);
        hold(&mesh, &out, &desc, &most);
        hold(&out, &mesh, &desc, &most);
        cw_mesh_free(&out);
    }
    assert_true(most > 0.3); /* and what is promised is made use of */
    cw_mesh_free(&mesh);
}

/* The depths that are drawn are those of the nearest crossing of rays. */
static void depths_are_those_of_rays(void **state)
{
    (void)state;
    cw_volume volume = test_sample(CW_FIELD_SPHERE, 24, CW_F32);
    cw_mesh mesh = test_extract(&volume, &(cw_extract_desc){.inside_is_low = true}, NULL);
    double middle[3];
    const double size = size_of(&mesh, middle);
    cw_error err = {0};
    for (int round = 0; round < 2; round++) {
        cw_simplify_view view = {.width = 64, .height = 48};
        view.camera = (cw_camera){.up = {0, 0, 1}, .fov_deg = round ? 30 : 0};
        view.camera.height_mm = size;
        memcpy(view.camera.target, middle, sizeof middle);
        memcpy(view.camera.eye, middle, sizeof middle);
        view.camera.eye[1] -= 3 * size;
        assert_ok(cw_simplify_view_draw(&view, &mesh, &err), err);
        size_t covered = 0;
        for (size_t n = 0; n < view.width * view.height; n += 5) {
            const double pixel[2] = {(double)(n % view.width) + 0.5,
                                     (double)(n / view.width) + 0.5};
            double o[3], d[3], p[2], depth, point[3], near[3];
            if (!isfinite(view.depth[n]))
                continue;
            assert_ok(cw_camera_ray(&view.camera, view.width, view.height, pixel, o, d, &err),
                      err);
            const double along = round ? (double)view.depth[n] / d[1] : (double)view.depth[n];
            for (int a = 0; a < 3; a++)
                point[a] = o[a] + along * d[a];
            nearest_point(&mesh, point, near);
            assert_true(apart(point, near) < 1e-4 * size);
            assert_true(point[1] < middle[1]); /* the front, not the back */
            assert_true(
                cw_camera_project(&view.camera, view.width, view.height, point, p, &depth));
            assert_near(depth, (double)view.depth[n], 1e-4 * size);
            covered++;
        }
        assert_true(covered > 40);
        cw_simplify_view_free(&view);
    }
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
}

/* Hidden parts are coarser, and what is seen is not. */
static void what_is_hidden_is_coarser(void **state)
{
    (void)state;
    cw_volume volume = test_sample(CW_FIELD_SPHERE, test_is_short() ? 16 : 24, CW_F32);
    cw_mesh mesh = test_extract(&volume, &(cw_extract_desc){.inside_is_low = true}, NULL);
    double middle[3], most = 0;
    const double size = size_of(&mesh, middle);
    test_seed(11);
    for (int round = 0; round < 2; round++) {
        cw_simplify_view view = random_view(&mesh, round);
        cw_simplify_desc desc = {
            .error_mm = 0.01 * size, .views = &view, .view_count = 1, .pixel_error = 0.2};
        cw_mesh all, out;
        cw_error err = {0};
        for (int a = 0; a < 3; a++) { /* from outside */
            view.camera.target[a] = middle[a];
            view.camera.eye[a] = middle[a] + (a == round % 3 ? 1.5 : 0.2) * size;
        }
        assert_ok(cw_simplify(&mesh, &desc, &all, NULL, &err), err);
        assert_ok(cw_simplify_view_draw(&view, &mesh, &err), err);
        assert_ok(cw_simplify(&mesh, &desc, &out, NULL, &err), err);
        assert_true(out.triangle_count < all.triangle_count);
        test_assert_sound(&mesh, &out);
        hold(&mesh, &out, &desc, &most);
        cw_mesh_free(&all);
        cw_mesh_free(&out);
        cw_simplify_view_free(&view);
    }
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
}

/* With little room for normals the seen side of a sphere keeps what the other one loses. */
static void what_is_seen_keeps_its_shading(void **state)
{
    (void)state;
    cw_volume volume = test_sample(CW_FIELD_SPHERE, test_is_short() ? 30 : 40, CW_F32);
    cw_mesh mesh = test_extract(&volume, &(cw_extract_desc){.inside_is_low = true}, NULL), out;
    double middle[3];
    const double size = size_of(&mesh, middle);
    size_t count[2][2] = {{0}};
    cw_error err = {0};
    cw_simplify_view view = {
        .camera = {.up = {0, 0, 1}, .height_mm = size}, .width = 400, .height = 400};
    memcpy(view.camera.target, middle, sizeof middle);
    memcpy(view.camera.eye, middle, sizeof middle);
    view.camera.eye[1] -= 2 * size;
    assert_ok(cw_simplify_view_draw(&view, &mesh, &err), err);
    for (int kept = 0; kept < 2; kept++) {
        const cw_simplify_desc desc = {.error_mm = 0.01 * size,
                                       .views = &view,
                                       .view_count = 1,
                                       .pixel_error = 4,
                                       .normal_deg = kept ? 1 : 0};
        assert_ok(cw_simplify(&mesh, &desc, &out, NULL, &err), err);
        for (size_t v = 0; v < out.vertex_count; v++) {
            const double y = out.origin[1] + (double)out.positions[3 * v + 1] - middle[1];
            count[kept][0] += y < -0.2 * size;
            count[kept][1] += y > 0.2 * size;
        }
        cw_mesh_free(&out);
    }
    assert_true(count[1][0] > 5 * count[0][0]);
    assert_true(4 * count[1][0] > 5 * count[1][1]); /* which grade from fine to coarse */
    cw_simplify_view_free(&view);
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
}

/* Vertices above and below a height, each by itself. */
static void count_sides(const cw_mesh *m, double z, double count[2])
{
    count[0] = count[1] = 0;
    for (size_t v = 0; v < m->vertex_count; v++)
        count[m->origin[2] + (double)m->positions[3 * v + 2] > z]++;
}

/* A picture of the upper half: there the surface is as if all of it were seen, below as if
 * there were no picture. */
static void what_no_view_sees_is_coarser(void **state)
{
    (void)state;
    cw_mesh mesh = surface(20), half, coarse;
    double middle[3], seen[2], unseen[2];
    const double size = size_of(&mesh, middle);
    cw_error err = {0};
    cw_simplify_view view = {
        .camera = {.up = {0, 0, 1}, .height_mm = size}, .width = 400, .height = 400};
    memcpy(view.camera.target, middle, sizeof middle);
    view.camera.target[2] += 0.5 * size;
    memcpy(view.camera.eye, view.camera.target, sizeof view.camera.eye);
    view.camera.eye[1] -= size;
    cw_simplify_desc desc = {
        .error_mm = 0.02 * size, .views = &view, .view_count = 1, .pixel_error = 1};
    assert_ok(cw_simplify(&mesh, &desc, &half, NULL, &err), err);
    desc = (cw_simplify_desc){.error_mm = desc.error_mm};
    assert_ok(cw_simplify(&mesh, &desc, &coarse, NULL, &err), err);
    count_sides(&half, middle[2], seen);
    count_sides(&coarse, middle[2], unseen);
    assert_true(seen[1] > 2 * unseen[1]);
    assert_true(seen[1] > 2 * seen[0]);
    cw_mesh_free(&coarse);
    cw_mesh_free(&half);
    cw_mesh_free(&mesh);
}

/* In tandem with extraction, where nothing is known of the slabs to come. */
static cw_mesh by_slabs(const cw_volume *volume, const cw_simplify_desc *desc, int threads)
{
    cw_simplify_desc d = *desc;
    cw_simplifier *simplifier;
    cw_mesh out;
    cw_error err = {0};
    d.threads = threads;
    assert_ok(cw_simplifier_new(&d, &simplifier, &err), err);
    assert_ok(cw_extract_slabs(volume, NULL, 2000,
                               (cw_slab_sink){cw_simplifier_take, simplifier}, NULL, &err),
              err);
    assert_ok(cw_simplifier_finish(simplifier, &out, NULL, &err), err);
    cw_simplifier_free(simplifier);
    return out;
}

static void slabs_keep_it_too_for_any_number_of_threads(void **state)
{
    (void)state;
    cw_volume volume = noisy_gyroid(test_is_short() ? 18 : 28);
    cw_mesh mesh = test_extract(&volume, NULL, NULL);
    double middle[3], most = 0;
    const double size = size_of(&mesh, middle);
    test_seed(3);
    cw_simplify_view views[2] = {random_view(&mesh, 0), random_view(&mesh, 1)};
    const cw_simplify_desc desc = {
        .error_mm = 0.01 * size, .views = views, .view_count = 2, .pixel_error = 1};
    cw_mesh one = by_slabs(&volume, &desc, 1), three = by_slabs(&volume, &desc, 3);
    test_assert_same_mesh(&one, &three);
    assert_true(one.triangle_count < mesh.triangle_count);
    hold(&one, &mesh, &desc, &most);
    cw_mesh_free(&one);
    cw_mesh_free(&three);
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
}

static bool is_seen(const cw_simplify_view *view, const double point[3])
{
    double error;
    cw_error err = {0};
    assert_ok(cw_simplify_view_error(view, 1, point, &error, &err), err);
    return isfinite(error);
}

/* Every place of the surface that a view sees is still there, and what is in no
 * picture went. */
static void what_no_view_sees_is_left_out(void **state)
{
    (void)state;
    const cw_mesh full = surface(24);
    size_t went = 0;
    test_seed(7);
    for (int round = 0; round < 6; round++) {
        cw_simplify_view views[2] = {random_view(&full, round), random_view(&full, round + 1)};
        cw_volume volume = noisy_gyroid(24);
        cw_mesh culled = test_extract(&volume, NULL, NULL);
        cw_error err = {0};
        size_t dropped, kept = 0;
        if (round % 2)
            for (int n = 0; n < 2; n++)
                assert_ok(cw_simplify_view_draw(views + n, &full, &err), err);
        assert_ok(cw_simplify_cull(&culled, views, 2, 1, 0, &dropped, &err), err);
        assert_int_equal(culled.triangle_count + dropped, full.triangle_count);
        went += dropped;
        for (size_t t = 0; t < full.triangle_count; t++) {
            double middle[3];
            const float *p[3], *q[3] = {0};
            corners_of(&full, t, p);
            for (int a = 0; a < 3; a++)
                middle[a] =
                    full.origin[a] + ((double)p[0][a] + (double)p[1][a] + (double)p[2][a]) / 3;
            bool there = kept < culled.triangle_count;
            if (there)
                corners_of(&culled, kept, q);
            for (size_t k = 0; k < 3 && there; k++)
                there = memcmp(p[k], q[k], 3 * sizeof(float)) == 0;
            kept += there; /* in the order that they were in */
            if (!there)
                assert_false(is_seen(views, middle) || is_seen(views + 1, middle));
        }
        assert_int_equal(kept, culled.triangle_count);
        for (int n = 0; n < 2; n++)
            cw_simplify_view_free(views + n);
        cw_mesh_free(&culled);
        cw_volume_free(&volume);
    }
    assert_true(went > full.triangle_count / 2);
    cw_mesh mesh = full;
    cw_error err = {0};
    const cw_simplify_view view = random_view(&full, 1), none = {.width = 0};
    bool seen;
    assert_fails(cw_simplify_cull(&mesh, &view, 1, 0, 0, NULL, &err), CW_ERR_ARGUMENT,
                 "pixel_error is 0", err);
    assert_fails(cw_simplify_cull(&mesh, &none, 1, 1, 0, NULL, &err), CW_ERR_ARGUMENT, "eye",
                 err);
    assert_fails(cw_simplify_view_sees(&view, 1, full.origin, 0, &seen, &err), CW_ERR_ARGUMENT,
                 "1 to 8", err);
    mesh = full;
    cw_mesh_free(&mesh);
}

/* In perspective only what is before the eye is seen, however wide; without it there is
 * no eye. */
static void nothing_is_seen_behind_the_eye(void **state)
{
    (void)state;
    cw_simplify_view view = {.camera = {.up = {0, 0, 1}, .target = {0, 9, 0}, .fov_deg = 40}};
    for (int flat = 0; flat < 2; flat++)
        for (int side = -1; side <= 1; side += 2) {
            const double y = side * 2, hull[9] = {-9, y, -9, 9, y, -9, 0, y, 9};
            cw_error err = {0};
            bool seen;
            view.camera.fov_deg = flat ? 0 : 40;
            view.camera.height_mm = 5;
            assert_ok(cw_simplify_view_sees(&view, 1, hull, 3, &seen, &err), err);
            assert_int_equal(seen, flat || side > 0);
        }
}

/* A sheet of 20 x 20 mm, at a depth below an eye at zero, with bumps of 0.2 mm. */
static cw_mesh bumpy_sheet(double depth)
{
    enum { SIDE = 24 };
    cw_mesh m = {.vertex_count = SIDE * SIDE, .triangle_count = 2 * (SIDE - 1) * (SIDE - 1)};
    m.positions = malloc(3 * m.vertex_count * sizeof *m.positions);
    m.triangles = malloc(3 * m.triangle_count * sizeof *m.triangles);
    assert_true(m.positions && m.triangles);
    uint32_t *t = m.triangles;
    for (uint32_t n = 0; n < SIDE * SIDE; n++) {
        const uint32_t x = n % SIDE, y = n / SIDE, corners[] = {0, 1, SIDE, 1, SIDE + 1, SIDE};
        m.positions[3 * (size_t)n] = 20.0f * (float)x / (SIDE - 1) - 10;
        m.positions[3 * (size_t)n + 1] = 20.0f * (float)y / (SIDE - 1) - 10;
        m.positions[3 * (size_t)n + 2] = (float)(-depth - 0.2 * ((x * 7 + y * 13) % 5 / 4.0));
        for (size_t c = 0; c < 6 && x + 1 < SIDE && y + 1 < SIDE; c++)
            *t++ = n + corners[c];
    }
    return m;
}

/* With an error of 1 mm: what is up to 2 mm behind what is seen may come before it. */
static void what_is_just_behind_is_not_hidden(void **state)
{
    (void)state;
    enum { SIZE = 64 };
    static float depths[SIZE * SIZE];
    size_t left[3];
    for (size_t n = 0; n < SIZE * SIZE; n++)
        depths[n] = 50;
    for (int n = 0; n < 3; n++) { /* no depths; too near, far enough behind them */
        const cw_simplify_view view = {
            .camera = {.up = {0, 1, 0}, .target = {0, 0, -9}, .height_mm = 32},
            .width = SIZE,
            .height = SIZE,
            .depth = n ? depths : NULL};
        const cw_simplify_desc desc = {
            .error_mm = 1, .views = &view, .view_count = 1, .pixel_error = 0.1};
        cw_mesh mesh = bumpy_sheet(n < 2 ? 51.7 : 54), out;
        cw_error err = {0};
        assert_ok(cw_simplify(&mesh, &desc, &out, NULL, &err), err);
        left[n] = out.triangle_count;
        cw_mesh_free(&mesh);
        cw_mesh_free(&out);
    }
    assert_int_equal(left[1], left[0]);
    assert_true(left[2] < left[0] / 2);
}

/* No voxel outside the box is in a picture; the box is no larger than its bricks must be. */
static void the_box_of_views_holds_all_that_they_see(void **state)
{
    (void)state;
    cw_volume v = noisy_gyroid(41);
    cw_mesh mesh = test_extract(&v, NULL, NULL);
    size_t smaller = 0;
    for (int round = 0; round < 60; round++) {
        cw_simplify_view views[2] = {random_view(&mesh, round), random_view(&mesh, round + 1)};
        cw_box box;
        cw_error err = {0};
        const size_t count = 1 + (size_t)round % 2;
        for (int n = 0; n < 2; n++) { /* of a part of the volume */
            views[n].camera.fov_deg /= 5;
            views[n].camera.height_mm /= 5;
        }
        const cw_status st = cw_simplify_views_box(&v, views, count, &box, &err);
        if (st != CW_OK)
            assert_int_equal(st, CW_ERR_EMPTY);
        for (size_t a = 0; a < 3 && st == CW_OK; a++) {
            assert_true(box.count[a] > 0 && box.first[a] + box.count[a] <= 41);
            smaller += box.count[a] < 41;
        }
        for (int n = 0; n < 500; n++) {
            double index[3], world[3];
            bool inside = st == CW_OK;
            for (int a = 0; a < 3; a++) {
                index[a] = uniform(0, 40);
                inside = inside && index[a] >= (double)box.first[a] &&
                         index[a] <= (double)(box.first[a] + box.count[a] - 1);
            }
            cw_volume_to_world(&v, index, world);
            for (size_t i = 0; i < count; i++)
                assert_true(inside || !is_seen(views + i, world));
        }
    }
    assert_true(smaller > (test_seed_is_other() ? 0 : 20));
    cw_volume_free(&v);
    cw_mesh_free(&mesh);
}

/* The bound at eight corners is that of any point between them: it grows with the depth. */
static void the_widest_error_bounds_every_point(void **state)
{
    (void)state;
    cw_volume v = noisy_gyroid(9);
    cw_mesh mesh = test_extract(&v, NULL, NULL);
    double corners[8][3];
    cw_volume_corners(&v, corners);
    for (int round = 0; round < 50; round++) {
        const cw_simplify_view view = random_view(&mesh, round);
        double widest, here, index[3], world[3];
        cw_error err = {0};
        assert_ok(cw_simplify_views_error(&view, 1, 2, corners[0], 8, &widest, &err), err);
        for (int n = 0; n < 200; n++) {
            for (int a = 0; a < 3; a++)
                index[a] = uniform(0, 8);
            cw_volume_to_world(&v, index, world);
            assert_ok(cw_simplify_view_error(&view, 2, world, &here, &err), err);
            assert_true(isinf(here) || here <= widest * (1 + 1e-9));
        }
    }
    cw_volume_free(&v);
    cw_mesh_free(&mesh);
}

static void distances_become_pixels_where_they_are_seen(void **state)
{
    (void)state;
    cw_mesh mesh = surface(12);
    cw_error err = {0};
    float *distance = calloc(mesh.vertex_count, sizeof *distance);
    assert_non_null(distance);
    for (int round = 0; round < 20; round++) {
        const cw_simplify_view view = random_view(&mesh, round);
        double pixels, expected = 0, allowed;
        for (size_t v = 0; v < mesh.vertex_count; v++) {
            double world[3];
            distance[v] = (float)uniform(0, 1);
            for (size_t a = 0; a < 3; a++)
                world[a] = mesh.origin[a] + (double)mesh.positions[3 * v + a];
            assert_ok(cw_simplify_view_error(&view, 1, world, &allowed, &err), err);
            expected = fmax(expected, (double)distance[v] / allowed);
        }
        assert_ok(cw_simplify_view_distance(&view, &mesh, distance, &pixels, &err), err);
        assert_near(pixels, expected, 1e-12 * expected);
    }
    free(distance);
    cw_mesh_free(&mesh);
}

static void views_that_are_none_are_refused(void **state)
{
    (void)state;
    cw_mesh mesh = surface(8), out;
    cw_error err = {0};
    cw_simplify_view view = random_view(&mesh, 1);
    cw_simplify_desc d = {.error_mm = 1, .views = &view, .view_count = 1};
    assert_fails(cw_simplify(&mesh, &d, &out, NULL, &err), CW_ERR_ARGUMENT, "pixel_error is 0",
                 err);
    d.pixel_error = NAN;
    assert_fails(cw_simplify(&mesh, &d, &out, NULL, &err), CW_ERR_ARGUMENT, "pixel_error", err);
    d.pixel_error = 1;
    d.view_count = 0;
    assert_fails(cw_simplify(&mesh, &d, &out, NULL, &err), CW_ERR_ARGUMENT, "no views", err);
    d.view_count = 1;
    d.error_mm = 0;
    d.ratio = 0.5;
    assert_fails(cw_simplify(&mesh, &d, &out, NULL, &err), CW_ERR_ARGUMENT, "error_mm", err);
    d.error_mm = 1;
    d.normal_deg = 181;
    assert_fails(cw_simplify(&mesh, &d, &out, NULL, &err), CW_ERR_ARGUMENT, "normal_deg", err);
    d.normal_deg = 0;
    memcpy(view.camera.eye, view.camera.target, sizeof view.camera.eye);
    assert_fails(cw_simplify(&mesh, &d, &out, NULL, &err), CW_ERR_ARGUMENT, "apart", err);
    cw_volume v = noisy_gyroid(8);
    cw_box box;
    const double point[3] = {0, 0, 0};
    double error;
    assert_fails(cw_simplify_views_box(&v, &view, 1, &box, &err), CW_ERR_ARGUMENT, "apart",
                 err);
    assert_fails(cw_simplify_views_error(&view, 1, 1, point, 1, &error, &err), CW_ERR_ARGUMENT,
                 "apart", err);
    cw_volume_free(&v);
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_seen_keeps_its_shading),
        cmocka_unit_test(no_picture_is_off_by_more_pixels),
        cmocka_unit_test(what_no_view_sees_is_coarser),
        cmocka_unit_test(depths_are_those_of_rays),
        cmocka_unit_test(what_is_hidden_is_coarser),
        cmocka_unit_test(slabs_keep_it_too_for_any_number_of_threads),
        cmocka_unit_test(what_no_view_sees_is_left_out),
        cmocka_unit_test(nothing_is_seen_behind_the_eye),
        cmocka_unit_test(what_is_just_behind_is_not_hidden),
        cmocka_unit_test(the_box_of_views_holds_all_that_they_see),
        cmocka_unit_test(the_widest_error_bounds_every_point),
        cmocka_unit_test(distances_become_pixels_where_they_are_seen),
        cmocka_unit_test(views_that_are_none_are_refused),
    };
    return cw_simplify_available() ? cmocka_run_group_tests(tests, NULL, NULL) : 0;
}
