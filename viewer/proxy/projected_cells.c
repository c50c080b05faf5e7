/* Projects the faces of a box, and overlays front and back faces into convex pieces
 * [Wilhelms1991]. */
#include "viewer/proxy/projected_cells.h"

#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

enum { MAX_SIDES = 16, MAX_FACES = 7 };

/* Faces seen more edge-on than this cover nothing: slopes, or distances in voxels. */
static const double EDGE_ON = 1e-9;

typedef struct polygon {
    int count;
    double at[MAX_SIDES][2];
} polygon;

/* A face on the picture. plane: depth, in perspective 1 / depth, is plane[0] x + plane[1] y +
 * plane[2] at a point of the picture. */
typedef struct face {
    polygon outline;
    double plane[3];
} face;

typedef struct faces {
    int count;
    face all[MAX_FACES];
} faces;

typedef struct solid {
    const cwi_frame *frame;
    double corners[8][3]; /* eye space; bit a of the number: high along axis a */
    bool is_cut;          /* by the near plane */
    double depth[2];      /* least and greatest */
    faces front, back;
    polygon cap; /* where the near plane cuts it; corners in no order */
} solid;

static void project_point(const cwi_frame *f, const double p[3], double at[2])
{
    const double scale = f->perspective ? -1 / p[2] : 1;
    at[0] = p[0] * scale;
    at[1] = p[1] * scale;
}

static void add_corner(polygon *p, const double at[2])
{
    if (p->count < MAX_SIDES)
        memcpy(p->at[p->count++], at, 2 * sizeof *at);
}

/* Finds the four corners of a face, one after the other around it. */
static void face_corners(int axis, int side, int out[4])
{
    const int b = 1 << (axis + 1) % 3, c = 1 << (axis + 2) % 3;
    const int around[4] = {0, b, b | c, c};
    for (int n = 0; n < 4; n++)
        out[n] = around[n] | side << axis;
}

/* Draws a face's outline, without the part in front of the near plane. */
static void draw_outline(solid *s, int axis, int side, polygon *out)
{
    const cwi_frame *f = s->frame;
    double at[2];
    int corner[4];
    face_corners(axis, side, corner);
    out->count = 0;
    for (int n = 0; n < 4; n++) {
        const double *p = s->corners[corner[n]], *q = s->corners[corner[(n + 1) % 4]];
        const double a = -p[2] - f->near, b = -q[2] - f->near;
        if (!s->is_cut || a >= 0) {
            project_point(f, p, at);
            add_corner(out, at);
        }
        if (!s->is_cut || (a >= 0) == (b >= 0))
            continue;
        double cut[3];
        cwi_lerp(p, q, a / (a - b), cut);
        project_point(f, cut, at);
        add_corner(out, at);
        if (axis == 2 || (axis == 1 && (corner[n] ^ corner[(n + 1) % 4]) == 4))
            add_corner(&s->cap, at); /* each edge once */
    }
}

/* Returns a number above 0 if the face looks at the eye: in perspective the voxels by which the
 * eye is in front of it, else the slope of index space along the view. */
static double find_facing(const solid *s, const double low[3], const double high[3], int axis,
                          int side)
{
    const double *row = s->frame->index_from_eye + (ptrdiff_t)4 * axis;
    if (s->frame->perspective)
        return side ? row[3] - high[axis] : low[axis] - row[3];
    return side ? row[2] : -row[2];
}

static void find_plane(const solid *s, int axis, double offset, double plane[3])
{
    const double *row = s->frame->index_from_eye + (ptrdiff_t)4 * axis;
    const double scale = s->frame->perspective ? 1 / (offset - row[3]) : 1 / row[2];
    plane[0] = row[0] * scale;
    plane[1] = row[1] * scale;
    plane[2] = (s->frame->perspective ? -row[2] : row[3] - offset) * scale;
}

/* Sorts the corners of a convex polygon in their order around its middle. */
static void sort_around(polygon *p)
{
    double middle[2] = {0};
    for (int n = 0; n < p->count; n++)
        for (int a = 0; a < 2; a++)
            middle[a] += p->at[n][a] / p->count;
    for (int n = 1; n < p->count; n++)
        for (int m = n; m > 0; m--) {
            double *a = p->at[m - 1], *b = p->at[m];
            const double x[2] = {a[0], a[1]};
            if (atan2(a[1] - middle[1], a[0] - middle[0]) <=
                atan2(b[1] - middle[1], b[0] - middle[0]))
                break;
            memcpy(a, b, sizeof x);
            memcpy(b, x, sizeof x);
        }
}

static void find_corners(solid *s, const double low[3], const double high[3])
{
    s->depth[0] = INFINITY;
    s->depth[1] = -INFINITY;
    for (int n = 0; n < 8; n++) {
        const double p[3] = {n & 1 ? high[0] : low[0], n & 2 ? high[1] : low[1],
                             n & 4 ? high[2] : low[2]};
        cwi_affine_apply(s->frame->eye_from_index, p, s->corners[n]);
        s->depth[0] = cwi_lesser(s->depth[0], -s->corners[n][2]);
        s->depth[1] = cwi_greater(s->depth[1], -s->corners[n][2]);
    }
    s->is_cut = s->frame->perspective && s->depth[0] < s->frame->near;
    if (s->is_cut)
        s->depth[0] = s->frame->near;
}

static void find_faces(solid *s, const double low[3], const double high[3])
{
    for (int axis = 0; axis < 3; axis++)
        for (int side = 0; side < 2; side++) {
            const double to_eye = find_facing(s, low, high, axis, side);
            faces *to = to_eye > 0 ? &s->front : &s->back;
            face *f = &to->all[to->count];
            draw_outline(s, axis, side, &f->outline);
            if (fabs(to_eye) <= EDGE_ON || f->outline.count < 3)
                continue;
            find_plane(s, axis, side ? high[axis] : low[axis], f->plane);
            to->count++;
        }
    if (s->cap.count >= 3) {
        face *f = &s->front.all[s->front.count++];
        sort_around(&s->cap);
        *f = (face){s->cap, {0, 0, 1 / s->frame->near}};
    }
}

static double cross_in_plane(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static double twice_area(const polygon *p)
{
    double sum = 0;
    for (int n = 2; n < p->count; n++)
        sum += cross_in_plane(p->at[0], p->at[n - 1], p->at[n]);
    return sum;
}

/* Cuts off the part to the right of the line from a to b [Sutherland1974]; corners within
 * rounding of the line stay unchanged. */
static void cut_polygon(polygon *p, const double a[2], const double b[2], double rounding)
{
    polygon out;
    double at[2], d[MAX_SIDES];
    bool any_left = false, any_right = false;
    for (int n = 0; n < p->count; n++) {
        d[n] = cross_in_plane(a, b, p->at[n]);
        if (fabs(d[n]) <= rounding)
            d[n] = 0;
        any_left = any_left || d[n] > 0;
        any_right = any_right || d[n] < 0;
    }
    out.count = 0;
    if (!any_right || !any_left) {
        p->count = any_right ? 0 : p->count;
        return;
    }
    for (int n = 0; n < p->count; n++) {
        const int next = (n + 1) % p->count;
        if (d[n] >= 0)
            add_corner(&out, p->at[n]);
        if (!((d[n] > 0 && d[next] < 0) || (d[n] < 0 && d[next] > 0)))
            continue;
        for (int c = 0; c < 2; c++)
            at[c] = p->at[n][c] + d[n] / (d[n] - d[next]) * (p->at[next][c] - p->at[n][c]);
        add_corner(&out, at);
    }
    p->count = out.count;
    memcpy(p->at, out.at, (size_t)out.count * sizeof *out.at);
}

static double depth_at(const solid *s, const double plane[3], const double at[2])
{
    const double w = plane[0] * at[0] + plane[1] * at[1] + plane[2];
    const double depth = s->frame->perspective ? 1 / w : w;
    return cwi_lesser(cwi_greater(depth, s->depth[0]), s->depth[1]);
}

/* Returns a vertex's number. A vertex is used again only if both depths are the same, too: on a
 * face seen almost edge-on, points that coincide on the picture are apart in depth. */
static uint8_t add_vertex(cwi_pieces *out, const cwi_piece_vertex *v, double size, double thick)
{
    for (size_t n = 0; n < out->vertex_count; n++) {
        const cwi_piece_vertex *u = &out->vertices[n];
        if (fabs(u->at[0] - v->at[0]) <= 1e-9 * size &&
            fabs(u->at[1] - v->at[1]) <= 1e-9 * size &&
            fabs(u->front - v->front) <= 1e-6 * thick &&
            fabs(u->back - v->back) <= 1e-6 * thick)
            return (uint8_t)n;
    }
    if (out->vertex_count == CWI_PIECE_VERTICES)
        return 0;
    out->vertices[out->vertex_count] = *v;
    return (uint8_t)out->vertex_count++;
}

/* Returns the corner that is farthest along a direction that no edge of a lattice is likely to
 * have. So polygons are cut into the same triangles as the view turns. */
static int choose_first(const polygon *p)
{
    int first = 0;
    double max = -INFINITY;
    for (int n = 0; n < p->count; n++) {
        const double along = 0.8391 * p->at[n][0] + 0.5440 * p->at[n][1];
        if (along > max) {
            max = along;
            first = n;
        }
    }
    return first;
}

static void add_polygon(const solid *s, const polygon *p, const face *front, const face *back,
                        double size, cwi_pieces *out)
{
    uint8_t number[MAX_SIDES];
    const int first = choose_first(p);
    const double thick = s->depth[1] - s->depth[0];
    for (int n = 0; n < p->count; n++) {
        const double *at = p->at[(first + n) % p->count];
        cwi_piece_vertex v = {.at = {at[0], at[1]}, .front = depth_at(s, front->plane, at)};
        v.back = cwi_greater(depth_at(s, back->plane, at), v.front);
        number[n] = add_vertex(out, &v, size, thick);
    }
    for (int n = 2; n < p->count && out->index_count + 3 <= CWI_PIECE_INDICES; n++) {
        const uint8_t corners[3] = {number[0], number[n - 1], number[n]};
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
            continue;
        memcpy(out->indices + out->index_count, corners, sizeof corners);
        out->index_count += 3;
    }
    out->polygon_count++;
}

static void overlay_faces(const solid *s, const face *front, const face *back, double size,
                          cwi_pieces *out)
{
    polygon p = front->outline;
    const polygon *b = &back->outline;
    const bool backward = twice_area(b) < 0;
    for (int n = 0; n < b->count && p.count >= 3; n++) {
        const double *from = b->at[n], *to = b->at[(n + 1) % b->count];
        cut_polygon(&p, backward ? to : from, backward ? from : to, 1e-13 * size * size);
    }
    if (p.count >= 3 && fabs(twice_area(&p)) > 1e-12 * size * size)
        add_polygon(s, &p, front, back, size, out);
}

/* Returns the extent of the visible part. */
static double size_of(const faces *f)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int n = 0; n < f->count; n++)
        for (int c = 0; c < f->all[n].outline.count; c++)
            for (int a = 0; a < 2; a++) {
                low[a] = cwi_lesser(low[a], f->all[n].outline.at[c][a]);
                high[a] = cwi_greater(high[a], f->all[n].outline.at[c][a]);
            }
    return cwi_greater(high[0] - low[0], high[1] - low[1]);
}

void cwi_pieces_make(const cwi_frame *frame, const double low[3], const double high[3],
                     cwi_pieces *pieces)
{
    solid s;
    s.frame = frame;
    s.front.count = s.back.count = s.cap.count = 0;
    pieces->polygon_count = pieces->vertex_count = pieces->index_count = 0;
    find_corners(&s, low, high);
    if (frame->perspective && s.depth[1] <= frame->near)
        return;
    find_faces(&s, low, high);
    const double size = size_of(&s.front);
    for (int f = 0; f < s.front.count; f++)
        for (int b = 0; b < s.back.count; b++)
            overlay_faces(&s, &s.front.all[f], &s.back.all[b], size, pieces);
}
