/* Places, hits and drags the six handles of a clip box, and finds its visible edges. */
#include "viewer/interact/clip_box_handles.h"

#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

static bool project_point(const cwi_handle_view *v, const double point[3], double pixel[2],
                          double *depth)
{
    return cw_camera_project(&v->camera, v->width, v->height, point, pixel, depth);
}

static void find_middle(const cwi_world_box *box, int handle, double middle[3])
{
    const int axis = handle / 2;
    for (int a = 0; a < 3; a++)
        middle[a] = box->low[a] / 2 + box->high[a] / 2;
    middle[axis] = handle % 2 ? box->high[axis] : box->low[axis];
}

/* Returns true if the face of a handle is seen from inside of the box. */
static bool faces_away(const cwi_handle_view *v, const cwi_world_box *box, int handle)
{
    const cw_camera *c = &v->camera;
    const int axis = handle / 2;
    const double face = handle % 2 ? box->high[axis] : box->low[axis];
    const double to_eye = c->fov_deg > 0 ? c->eye[axis] - face : c->eye[axis] - c->target[axis];
    return !(handle % 2 ? to_eye > 0 : to_eye < 0);
}

void cwi_handles_place(const cwi_handle_view *view, const cwi_world_box *box,
                       cwi_handle handles[CWI_HANDLES])
{
    for (int n = 0; n < CWI_HANDLES; n++) {
        cwi_handle h = {.faces_away = faces_away(view, box, n)};
        double middle[3];
        find_middle(box, n, middle);
        h.shown = project_point(view, middle, h.pixel, &h.depth_mm);
        handles[n] = h.shown ? h : (cwi_handle){0};
    }
}

int cwi_handles_hit(const cwi_handle handles[CWI_HANDLES], const double pixel[2],
                    double radius_px)
{
    int found = CWI_HANDLE_NONE;
    for (int n = 0; n < CWI_HANDLES; n++) {
        const cwi_handle *h = &handles[n];
        if (h->shown && hypot(h->pixel[0] - pixel[0], h->pixel[1] - pixel[1]) <= radius_px &&
            (found == CWI_HANDLE_NONE || h->depth_mm < handles[found].depth_mm))
            found = n;
    }
    return found;
}

/* Finds where the line through a point along an axis comes closest to a ray: the coordinate,
 * and the distance along the ray. Returns false when they are nearly parallel. */
static bool meet_axis(const double point[3], int axis, const double origin[3],
                      const double direction[3], double *coordinate, double *distance)
{
    static const double MIN_SIN_SQ = 0.0027; /* sin^2 of 3 degrees */
    const double w[3] = {origin[0] - point[0], origin[1] - point[1], origin[2] - point[2]};
    const double lean = direction[axis], along = cwi_dot(w, direction);
    const double sin_sq = 1 - lean * lean;
    if (!(sin_sq > MIN_SIN_SQ))
        return false;
    const double displacement = (w[axis] - lean * along) / sin_sq;
    *coordinate = point[axis] + displacement;
    *distance = lean * displacement - along;
    return isfinite(*coordinate);
}

static double clamp_between(double x, double low, double high)
{
    return fmax(low, fmin(x, high));
}

static void move_face(const cwi_world_box *bounds, double thickness_mm, int handle, double to,
                      cwi_world_box *box)
{
    const int a = handle / 2;
    if (handle % 2)
        box->high[a] = clamp_between(to, fmin(box->low[a] + thickness_mm, bounds->high[a]),
                                     bounds->high[a]);
    else
        box->low[a] = clamp_between(to, bounds->low[a],
                                    fmax(box->high[a] - thickness_mm, bounds->low[a]));
}

bool cwi_handles_drag(const cwi_handle_view *view, const cwi_world_box *bounds,
                      double thickness_mm, int handle, const double pixel[2],
                      cwi_world_box *box)
{
    double middle[3], origin[3], direction[3], to, distance;
    if (handle < 0 || handle >= CWI_HANDLES)
        return false;
    find_middle(box, handle, middle);
    if (cw_camera_ray(&view->camera, view->width, view->height, pixel, origin, direction,
                      NULL) != CW_OK ||
        !meet_axis(middle, handle / 2, origin, direction, &to, &distance) ||
        (view->camera.fov_deg > 0 && !(distance > 0)))
        return false;
    move_face(bounds, thickness_mm, handle, to, box);
    return true;
}

/* Returns the distance of a point in front of the eye; for an orthographic camera all points
 * are in front. */
static double depth_of(const cwi_handle_view *v, const double forward[3], const double p[3])
{
    const double *eye = v->camera.eye;
    const double d[3] = {p[0] - eye[0], p[1] - eye[1], p[2] - eye[2]};
    return v->camera.fov_deg > 0 ? cwi_dot(d, forward) : 1;
}

/* Keeps the part of a line that is in front of the eye, by a little of its own length. */
static bool cut_line(const cwi_handle_view *v, const double forward[3], double ends[2][3])
{
    const double depth[2] = {depth_of(v, forward, ends[0]), depth_of(v, forward, ends[1])};
    const double near = 1e-3 * fmax(depth[0], depth[1]);
    if (!(near > 0))
        return false;
    for (int e = 0; e < 2; e++) {
        const double fraction = (near - depth[e]) / (depth[1 - e] - depth[e]);
        for (int a = 0; a < 3 && depth[e] < near; a++)
            ends[e][a] += fraction * (ends[1 - e][a] - ends[e][a]);
    }
    return true;
}

/* Finds the ends of an edge. Edge 4 a + s runs along axis a; bits of s: at the high side of the
 * two axes after a. */
static void edge_ends(const cwi_world_box *box, int edge, double ends[2][3])
{
    const int axis = edge / 4, b = (axis + 1) % 3, c = (axis + 2) % 3;
    for (int e = 0; e < 2; e++) {
        ends[e][axis] = e ? box->high[axis] : box->low[axis];
        ends[e][b] = edge & 1 ? box->high[b] : box->low[b];
        ends[e][c] = edge & 2 ? box->high[c] : box->low[c];
    }
}

static cwi_box_edge see_edge(const cwi_handle_view *v, const cwi_world_box *box,
                             const double forward[3], int edge)
{
    const int b = (edge / 4 + 1) % 3, c = (edge / 4 + 2) % 3;
    cwi_box_edge seen = {.is_behind = faces_away(v, box, 2 * b + (edge & 1)) &&
                                      faces_away(v, box, 2 * c + (edge >> 1 & 1))};
    double ends[2][3];
    edge_ends(box, edge, ends);
    seen.shown = cut_line(v, forward, ends) &&
                 project_point(v, ends[0], seen.pixels[0], NULL) &&
                 project_point(v, ends[1], seen.pixels[1], NULL);
    return seen;
}

void cwi_handles_edges(const cwi_handle_view *view, const cwi_world_box *box,
                       cwi_box_edge edges[CWI_BOX_EDGES])
{
    double axes[3][3];
    memset(edges, 0, CWI_BOX_EDGES * sizeof *edges);
    if (cw_camera_axes(&view->camera, axes[0], axes[1], axes[2], NULL) != CW_OK)
        return;
    for (int n = 0; n < CWI_BOX_EDGES; n++)
        edges[n] = see_edge(view, box, axes[2], n);
}
