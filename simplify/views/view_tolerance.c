/* Computes how far a surface may move in the pictures of its cameras, by depth, field of view
 * and what hides it. */
#include "simplify/views/view_tolerance.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_triangle.h"

#include <math.h>

/* Nearer to the eye than this share of the way to the target nothing is asked for exactly: at
 * the eye itself a pixel has no size. */
static const double NEAREST = 1e-3;

/* --- one view ----------------------------------------------------------------------------- */

/* A way of t from a point in the picture, at a distance D = z / cos from the eye, moves it by
 * no more than t k / ((z - t) cos) pixels, where k pixels are as wide as far away; and cos is
 * least in the corner of the picture. So t = z a / (1 + a) with a = pixels cos / k. */
static void see_perspective(cwi_view_tolerance *v, const cw_camera *c, const double size[2],
                            double pixels)
{
    const double open = tan(c->fov_deg * CWI_PI / 360), k = size[1] / (2 * open);
    double away[3];
    for (int n = 0; n < 2; n++)
        v->slope[n] = (0.5 * size[n] + pixels) / k;
    const double corner = hypot(hypot(v->slope[0], v->slope[1]), 1), a = pixels / (k * corner);
    cwi_sub(c->target, c->eye, away);
    v->rate = a / (1 + a);
    v->pixel = 1 / k;
    v->nearest = NEAREST * cwi_length(away);
}

static void see_parallel(cwi_view_tolerance *v, const cw_camera *c, const double size[2],
                         double pixels)
{
    const double pixel = c->height_mm / size[1];
    for (int n = 0; n < 2; n++)
        v->half[n] = (0.5 * size[n] + pixels) * pixel;
    v->even = pixels * pixel;
    v->pixel = pixel;
    v->nearest = -INFINITY;
}

cw_status cwi_view_init(cwi_view_tolerance *v, const cw_simplify_view *from, double pixels,
                        cw_error *err)
{
    const cw_camera *c = &from->camera;
    const double size[2] = {(double)(from->width ? from->width : CWI_VIEW_WIDTH),
                            (double)(from->height ? from->height : CWI_VIEW_HEIGHT)};
    *v = (cwi_view_tolerance){
        .size = {size[0], size[1]}, .depth = from->depth, .unit = 1, .pixels = pixels};
    if (!(pixels > 0) || !isfinite(pixels))
        return cwi_fail(err, CW_ERR_ARGUMENT, "pixel_error is %g; it must be above 0", pixels);
    cw_status st = cw_camera_axes(c, v->axes[0], v->axes[1], v->axes[2], err);
    if (st != CW_OK)
        return st;
    for (int n = 0; n < 3; n++)
        v->eye[n] = c->eye[n];
    if (c->fov_deg > 0)
        see_perspective(v, c, size, pixels);
    else
        see_parallel(v, c, size, pixels);
    return CW_OK;
}

typedef struct view_point {
    double across[2], depth;
} view_point;

static view_point to_view(const cwi_view_tolerance *v, const double p[3])
{
    const double from_eye[3] = {p[0] - v->eye[0], p[1] - v->eye[1], p[2] - v->eye[2]};
    return (view_point){{cwi_dot(from_eye, v->axes[0]), cwi_dot(from_eye, v->axes[1])},
                        cwi_dot(from_eye, v->axes[2])};
}

static double pixel_at(const cwi_view_tolerance *v, double depth)
{
    return v->rate > 0 ? v->pixel * depth : v->pixel;
}

bool cwi_view_project(const cwi_view_tolerance *v, const double point[3], double *x, double *y,
                      double *depth)
{
    const view_point p = to_view(v, point);
    const double pixel = pixel_at(v, p.depth);
    *x = 0.5 * v->size[0] + p.across[0] / pixel;
    *y = 0.5 * v->size[1] - p.across[1] / pixel;
    *depth = p.depth;
    return p.depth > v->nearest;
}

/* By how much a position is beyond one of the five planes that a view sees up to. */
static double distance_beyond(const cwi_view_tolerance *v, const view_point *p, int plane)
{
    if (plane == 4)
        return v->nearest > 0 ? -p->depth : -INFINITY;
    const int n = plane / 2;
    const double out = plane % 2 ? -p->across[n] : p->across[n];
    return (out - v->half[n] - v->slope[n] * p->depth) / hypot(1, v->slope[n]);
}

/* Decides whether a part is seen: it is not, when all of its corners are beyond one plane. */
static bool is_seen(const cwi_view_tolerance *v, const view_point *p, int corners,
                    double margin)
{
    for (int plane = 0; plane < 5; plane++) {
        double min_distance = INFINITY;
        for (int c = 0; c < corners; c++)
            min_distance = fmin(min_distance, distance_beyond(v, p + c, plane));
        if (min_distance > margin)
            return false;
    }
    return true;
}

/* Decides whether a part is hidden: a surface is in front of it at all pixels around it. Each
 * of the two may move by `max_error`, and the other one's edge may be as far away in the picture. */
static bool is_hidden(const cwi_view_tolerance *v, const view_point *p, int corners,
                      double max_error, double margin)
{
    double nearest = INFINITY, low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int c = 0; c < corners; c++)
        nearest = fmin(nearest, p[c].depth);
    if (!v->depth || nearest - 2 * max_error - margin <= v->nearest)
        return false;
    const double around = 1 + 2 * v->pixels + (max_error + margin) / pixel_at(v, nearest);
    for (int c = 0; c < corners; c++) {
        const double pixel = pixel_at(v, p[c].depth),
                     at[2] = {0.5 * v->size[0] + p[c].across[0] / pixel,
                              0.5 * v->size[1] - p[c].across[1] / pixel};
        for (int a = 0; a < 2; a++) {
            low[a] = fmin(low[a], fmax(floor(at[a] - around), 0));
            high[a] = fmax(high[a], fmin(floor(at[a] + around), v->size[a] - 1));
        }
    }
    const double before = (nearest - 2 * max_error - margin) / v->unit;
    for (double y = low[1]; y <= high[1]; y++)
        for (double x = low[0]; x <= high[0]; x++)
            if ((double)v->depth[(size_t)(y * v->size[0] + x)] >= before)
                return false;
    return true;
}

static double limit_error(const cwi_view_tolerance *v, const view_point *p, int corners,
                          double max_error, double margin)
{
    double min_distance = INFINITY;
    if (!is_seen(v, p, corners, margin) || is_hidden(v, p, corners, max_error, margin))
        return min_distance;
    for (int c = 0; c < corners; c++) {
        const double depth = v->rate > 0 ? fmax(p[c].depth, v->nearest) : 0;
        min_distance = fmin(min_distance, v->even + v->rate * depth);
    }
    return min_distance;
}

/* --- all of them -------------------------------------------------------------------------- */

cw_status cwi_views_init(cwi_views *views, const cw_simplify_desc *d, cw_error *err)
{
    cw_status st = CW_OK;
    *views = (cwi_views){0};
    if (!d->view_count && d->pixel_error == 0)
        return CW_OK;
    if (!d->view_count)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "pixel_error is %g, and there are no views to hold it in",
                        d->pixel_error);
    if (!(d->error_mm > 0))
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "views need an error_mm: the error limit where none of them sees the surface");
    views->view = cwi_alloc_array(d->view_count, sizeof *views->view);
    if (!views->view)
        return cwi_fail_memory(err);
    views->count = d->view_count;
    for (size_t n = 0; n < d->view_count && st == CW_OK; n++)
        st = cwi_view_init(views->view + n, d->views + n, d->pixel_error, err);
    return st;
}

void cwi_views_free(cwi_views *views)
{
    cwi_free(views->view);
    *views = (cwi_views){0};
}

void cwi_views_place(cwi_views *views, const double origin[3], double scale)
{
    for (size_t i = 0; i < views->count; i++) {
        cwi_view_tolerance *v = &views->view[i];
        for (int n = 0; n < 3; n++)
            v->eye[n] = scale * (v->eye[n] - origin[n]);
        for (int n = 0; n < 2; n++)
            v->half[n] *= scale;
        v->even *= scale;
        v->unit *= scale;
        v->pixel *= v->rate > 0 ? 1 : scale;
        v->nearest *= scale;
    }
}

double cwi_views_limit(const cwi_views *views, const cw_mesh *mesh, size_t t, double max_error,
                       double margin)
{
    double corners[3][3], min_distance = INFINITY;
    for (size_t c = 0; c < 3; c++)
        for (size_t a = 0; a < 3; a++)
            corners[c][a] = (double)cwi_mesh_point(mesh, t, c)[a];
    for (size_t i = 0; i < views->count; i++) {
        const cwi_view_tolerance *v = &views->view[i];
        view_point p[3];
        for (int c = 0; c < 3; c++)
            p[c] = to_view(v, corners[c]);
        min_distance = fmin(min_distance, limit_error(v, p, 3, max_error, margin));
    }
    return min_distance;
}

cw_status cw_simplify_view_sees(const cw_simplify_view *view, double pixels,
                                const double *points, size_t count, bool *seen, cw_error *err)
{
    CWI_REQUIRE(err, view);
    CWI_REQUIRE_ARRAY(err, points, count);
    CWI_REQUIRE_ARRAY(err, seen, count);
    cwi_view_tolerance v;
    view_point p[CWI_VIEW_HULL];
    cw_status st = cwi_view_init(&v, view, pixels, err);
    if (st == CW_OK && (count < 1 || count > CWI_VIEW_HULL))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "a hull of %zu points; 1 to %d were expected",
                      count, CWI_VIEW_HULL);
    if (st != CW_OK)
        return st;
    for (size_t n = 0; n < count; n++)
        p[n] = to_view(&v, points + 3 * n);
    *seen = isfinite(limit_error(&v, p, (int)count, 0, 0));
    return CW_OK;
}

static void mark_unseen(const cwi_views *views, const cw_mesh *m, double margin, bool *unseen,
                        size_t *count)
{
    *count = 0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        unseen[t] = !isfinite(cwi_views_limit(views, m, t, margin, margin));
        *count += unseen[t];
    }
}

cw_status cw_simplify_cull(cw_mesh *mesh, const cw_simplify_view *views, size_t count,
                           double pixels, double margin_mm, size_t *dropped, cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    CWI_REQUIRE_ARRAY(err, views, count);
    /* the error is never looked at */
    const cw_simplify_desc desc = {
        .error_mm = 1, .views = views, .view_count = count, .pixel_error = pixels};
    cwi_views all = {0};
    size_t unseen;
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK)
        st = cwi_views_init(&all, &desc, err);
    bool *marks = cwi_alloc_array(mesh->triangle_count, sizeof *marks);
    if (st == CW_OK && !marks)
        st = cwi_fail_memory(err);
    if (st == CW_OK) {
        cwi_views_place(&all, mesh->origin, 1);
        mark_unseen(&all, mesh, margin_mm, marks, &unseen);
        st = cwi_mesh_drop_marked(mesh, marks, err);
    }
    if (st == CW_OK && dropped)
        *dropped = unseen;
    cwi_free(marks);
    cwi_views_free(&all);
    return st;
}

cw_status cw_simplify_view_error(const cw_simplify_view *view, double pixels,
                                 const double point[3], double *error_mm, cw_error *err)
{
    CWI_REQUIRE(err, view, point, error_mm);
    cwi_view_tolerance v;
    cw_status st = cwi_view_init(&v, view, pixels, err);
    *error_mm = 0;
    if (st != CW_OK)
        return st;
    const view_point p = to_view(&v, point);
    *error_mm = limit_error(&v, &p, 1, 0, 0);
    return CW_OK;
}
