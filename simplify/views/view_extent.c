/* Extents that cameras see of a volume and of the vertices of a mesh, in voxels and in
 * pixels. */
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <cubewright/simplify.h>

#include <math.h>

/* Finds the distance that a view allows on its axis at the depth of a point. */
static cw_status error_at(const cw_simplify_view *view, double pixels, const double at[3],
                          double *error_mm, cw_error *err)
{
    cw_simplify_view bare = *view;
    double axes[3][3], depth = 0, point[3];
    bare.depth = NULL;
    cw_status st = cw_camera_axes(&view->camera, axes[0], axes[1], axes[2], err);
    for (int a = 0; a < 3; a++)
        depth += axes[2][a] * (at[a] - view->camera.eye[a]);
    for (int a = 0; a < 3; a++)
        point[a] = view->camera.eye[a] + fmax(depth, 0) * axes[2][a];
    return st == CW_OK ? cw_simplify_view_error(&bare, pixels, point, error_mm, err) : st;
}

cw_status cw_simplify_views_error(const cw_simplify_view *views, size_t view_count,
                                  double pixels, const double *points, size_t count,
                                  double *error_mm, cw_error *err)
{
    CWI_REQUIRE(err, error_mm);
    CWI_REQUIRE_ARRAY(err, points, count);
    CWI_REQUIRE_ARRAY(err, views, view_count);
    cw_status st = CW_OK;
    *error_mm = 0;
    for (size_t n = 0; n < view_count * count && st == CW_OK; n++) {
        double here = 0;
        st = error_at(views + n / count, pixels, points + 3 * (n % count), &here, err);
        *error_mm = isfinite(here) ? fmax(*error_mm, here) : *error_mm;
    }
    return st;
}

/* --- bricks of voxels --------------------------------------------------------------------- */

enum {
    BRICK = 8, /* cells along a side */
    AROUND = 2 /* voxels around the bricks, for gradients at their faces */
};

/* Finds the corners of a brick, as far as the volume goes. */
static void place_brick(const cw_volume *v, const size_t first[3], double points[8][3])
{
    for (int n = 0; n < 8; n++) {
        double index[3];
        for (int a = 0; a < 3; a++) {
            const size_t end = first[a] + BRICK < v->dim[a] ? first[a] + BRICK : v->dim[a] - 1;
            index[a] = (double)(n >> a & 1 ? end : first[a]);
        }
        cw_volume_to_world(v, index, points[n]);
    }
}

static cw_status see_brick(const cw_simplify_view *views, size_t count, double points[8][3],
                           bool *seen, cw_error *err)
{
    cw_status st = CW_OK;
    *seen = false;
    for (size_t n = 0; n < count && st == CW_OK && !*seen; n++) {
        cw_simplify_view bare = views[n];
        bare.depth = NULL;
        st = cw_simplify_view_sees(&bare, 1, points[0], 8, seen, err);
    }
    return st;
}

static cw_status find_seen(const cw_volume *v, const cw_simplify_view *views, size_t count,
                           size_t low[3], size_t high[3], cw_error *err)
{
    size_t at[3];
    cw_status st = CW_OK;
    for (int a = 0; a < 3; a++) {
        low[a] = SIZE_MAX;
        high[a] = 0;
    }
    for (at[2] = 0; at[2] + 1 < v->dim[2]; at[2] += BRICK)
        for (at[1] = 0; at[1] + 1 < v->dim[1]; at[1] += BRICK)
            for (at[0] = 0; at[0] + 1 < v->dim[0] && st == CW_OK; at[0] += BRICK) {
                double points[8][3];
                bool seen;
                place_brick(v, at, points);
                st = see_brick(views, count, points, &seen, err);
                for (int a = 0; a < 3 && seen; a++) {
                    low[a] = at[a] < low[a] ? at[a] : low[a];
                    high[a] = at[a] + BRICK > high[a] ? at[a] + BRICK : high[a];
                }
            }
    return st;
}

cw_status cw_simplify_views_box(const cw_volume *volume, const cw_simplify_view *views,
                                size_t view_count, cw_box *box, cw_error *err)
{
    CWI_REQUIRE(err, volume, box);
    CWI_REQUIRE_ARRAY(err, views, view_count);
    size_t low[3], high[3];
    cw_status st = cwi_volume_expect_dense(volume, "bricks", err);
    if (st == CW_OK)
        st = find_seen(volume, views, view_count, low, high, err);
    if (st == CW_OK && low[0] == SIZE_MAX)
        st = cwi_fail(err, CW_ERR_EMPTY, "no camera sees anything of the volume");
    for (int a = 0; a < 3 && st == CW_OK; a++) {
        box->first[a] = low[a] > AROUND ? low[a] - AROUND : 0;
        const size_t end = high[a] + AROUND + 1;
        box->count[a] = (end < volume->dim[a] ? end : volume->dim[a]) - box->first[a];
    }
    return st;
}

/* --- vertices ----------------------------------------------------------------------------- */

cw_status cw_simplify_view_distance(const cw_simplify_view *view, const cw_mesh *mesh,
                                    const float *distance_mm, double *pixels, cw_error *err)
{
    CWI_REQUIRE(err, view, mesh, distance_mm, pixels);
    cw_status st = CW_OK;
    *pixels = 0;
    for (size_t v = 0; v < mesh->vertex_count && st == CW_OK; v++) {
        const float *p = mesh->positions + 3 * v;
        const double world[3] = {mesh->origin[0] + (double)p[0], mesh->origin[1] + (double)p[1],
                                 mesh->origin[2] + (double)p[2]};
        double pixel_mm = INFINITY;
        st = cw_simplify_view_error(view, 1, world, &pixel_mm, err);
        *pixels = fmax(*pixels, (double)distance_mm[v] / pixel_mm);
    }
    return st;
}
