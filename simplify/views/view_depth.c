/* Draws the depth of the nearest surface behind each pixel of a view, which shows what is
 * hidden. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_triangle.h"
#include "simplify/views/view_tolerance.h"

#include <math.h>
#include <string.h>

void cw_simplify_view_free(cw_simplify_view *view)
{
    if (!view)
        return;
    cwi_free(view->depth);
    view->depth = NULL;
}

static cw_status begin_depths(cw_simplify_view *view, cw_error *err)
{
    size_t pixels;
    if (view->depth)
        return CW_OK;
    view->width = view->width ? view->width : CWI_VIEW_WIDTH;
    view->height = view->height ? view->height : CWI_VIEW_HEIGHT;
    if (cwi_size_mul(view->width, view->height, &pixels))
        view->depth = cwi_alloc_array(pixels, sizeof *view->depth);
    if (!view->depth)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < pixels; n++)
        view->depth[n] = INFINITY;
    return CW_OK;
}

/* Between two triangles there is no gap for a pixel's middle to fall into, by rounding. */
static const double SLACK = 1e-6;

/* A corner in the picture; what is linear there: the depth, its inverse with a perspective. */
typedef struct spot {
    double x, y, linear;
} spot;

static double twice_area(const spot *a, const spot *b, double x, double y)
{
    return (b->x - a->x) * (y - a->y) - (b->y - a->y) * (x - a->x);
}

/* The pixels whose middles are in a triangle, whichever way it faces. */
static void fill_triangle(cw_simplify_view *view, const spot s[3])
{
    const bool perspective = view->camera.fov_deg > 0;
    const double area = twice_area(s, s + 1, s[2].x, s[2].y);
    const double width = (double)view->width, height = (double)view->height;
    const double left = fmax(ceil(fmin(s[0].x, fmin(s[1].x, s[2].x)) - 0.5), 0),
                 right = fmin(floor(fmax(s[0].x, fmax(s[1].x, s[2].x)) - 0.5), width - 1),
                 top = fmax(ceil(fmin(s[0].y, fmin(s[1].y, s[2].y)) - 0.5), 0),
                 bottom = fmin(floor(fmax(s[0].y, fmax(s[1].y, s[2].y)) - 0.5), height - 1);
    for (double y = top; y <= bottom && area != 0; y++)
        for (double x = left; x <= right; x++) {
            double weights[3], linear = 0;
            for (int k = 0; k < 3; k++) {
                weights[k] =
                    twice_area(s + (k + 1) % 3, s + (k + 2) % 3, x + 0.5, y + 0.5) / area;
                linear += weights[k] * s[k].linear;
            }
            float *at = view->depth + (size_t)y * view->width + (size_t)x;
            if (weights[0] >= -SLACK && weights[1] >= -SLACK && weights[2] >= -SLACK)
                *at = fminf(*at, (float)(perspective ? 1 / linear : linear));
        }
}

cw_status cw_simplify_view_draw(cw_simplify_view *view, const cw_mesh *mesh, cw_error *err)
{
    CWI_REQUIRE(err, view, mesh);
    cwi_view_tolerance v;
    cw_status st = cwi_view_init(&v, view, 1, err);
    if (st == CW_OK)
        st = begin_depths(view, err);
    for (size_t t = 0; t < mesh->triangle_count && st == CW_OK; t++) {
        spot s[3];
        bool whole = true;
        for (size_t k = 0; k < 3; k++) {
            double world[3], depth;
            cwi_mesh_world(mesh, mesh->triangles[3 * t + k], world);
            whole = cwi_view_project(&v, world, &s[k].x, &s[k].y, &depth) && whole;
            s[k].linear = view->camera.fov_deg > 0 ? 1 / depth : depth;
        }
        if (whole) /* what reaches behind the eye hides nothing */
            fill_triangle(view, s);
    }
    return st;
}
