/* Cuts a surface's triangles at the sharp edges and corners of a mesh [Kobbelt2001]
 * [Attene2005]. */
#include "extract/level_set/sharp_edges.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/closest_point.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"

#include <cubewright/quality.h>

#include <math.h>
#include <string.h>

enum { CHUNK = 1024, ROUNDS = 12 };

/* Limits as cosines: planes that meet at more than 30 degrees make an edge; a part of a
 * triangle does not turn away from all planes at the triangle's corners. */
static const double EDGE_COSINE = 0.866, FACING_COSINE = 0;
/* Minimum volume of the parallelepiped that three planes' normals span. */
static const double MIN_CORNER_VOLUME = 0.2;
/* Maxima, as fractions of a voxel: from the middle of the part that is cut to the cut; from a
 * vertex to its plane; off the surface. Minima: between vertices; a triangle's height. */
static const double MAX_CUT_REACH = 2.5, MAX_PLANE_DISTANCE = 0.5, MAX_SURFACE_DISTANCE = 0.02,
                    MIN_SPACING = 0.02, MIN_HEIGHT = 0.002;

/* Plane of the surface near a vertex: n . x = at. No normal: 0. */
typedef struct plane {
    double n[3], at;
} plane;

/* A vertex that may be added. */
typedef struct cut {
    bool is_on;
    float x[3], n[3];
    uint32_t vertex; /* its number */
} cut;

/* Points are numbered: vertices, then cuts of sides, then those of triangles. */
typedef struct sharpener {
    const cw_mesh *from;
    cw_mesh *mesh, made;
    double offset, voxel;
    cwi_boxes tree;
    plane *planes;
    size_t side_count;
    uint32_t *first, *upper; /* sides from each vertex to one with a higher number */
    cut *sides, *middles;
    float *positions;  /* of vertices */
    uint32_t *parent;  /* of the triangles made */
    uint32_t *changed; /* triangles with a side that is cut, or a corner that is moved */
    size_t changed_count;
} sharpener;

static void vertex_position(const cw_mesh *m, uint32_t v, double x[3])
{
    for (int a = 0; a < 3; a++)
        x[a] = (double)m->positions[3 * (size_t)v + a];
}

/* ---- planes ------------------------------------------------------------------------------ */

static bool scale_to_one(double n[3])
{
    const double length = cwi_length(n);
    for (int a = 0; a < 3; a++)
        n[a] = length > 0 ? n[a] / length : 0;
    return length > 0;
}

/* Finds the plane of the surface near x. At distance 0 the normal is a triangle's; else it is
 * along the shortest way. */
static plane plane_near(const sharpener *s, const double x[3])
{
    const cwi_closest c = cwi_closest_find(s->from, &s->tree, x);
    plane p = {0};
    if (s->offset == 0)
        cwi_mesh_normal(s->from, c.triangle, p.n);
    for (int a = 0; a < 3 && s->offset != 0; a++)
        p.n[a] = (x[a] - c.point[a]) * (s->offset < 0 ? -1 : 1);
    if (scale_to_one(p.n))
        p.at = cwi_dot(p.n, c.point) + s->offset;
    return p;
}

static bool is_on_surface(const sharpener *s, const double x[3])
{
    const cwi_closest c = cwi_closest_find(s->from, &s->tree, x);
    return fabs(cwi_distance(x, c.point) - fabs(s->offset)) <= MAX_SURFACE_DISTANCE * s->voxel;
}

static void find_planes(void *context, size_t chunk)
{
    sharpener *s = context;
    for (size_t v = chunk * CHUNK; v < (chunk + 1) * CHUNK && v < s->mesh->vertex_count; v++) {
        double x[3];
        vertex_position(s->mesh, (uint32_t)v, x);
        s->planes[v] = plane_near(s, x);
    }
}

/* ---- where planes meet ------------------------------------------------------------------- */

/* Finds the shortest way onto two planes that are `near_p` and `near_q` away along their
 * normals. */
static void meet_two(const plane *p, const plane *q, double near_p, double near_q,
                     double displacement[3])
{
    const double c = cwi_dot(p->n, q->n), d = 1 - c * c;
    const double along_p = (near_p - c * near_q) / d, along_q = (near_q - c * near_p) / d;
    for (int a = 0; a < 3; a++)
        displacement[a] = along_p * p->n[a] + along_q * q->n[a];
}

static void meet_three(const plane *const p[3], const double away[3], double displacement[3])
{
    double cross[3][3];
    for (int k = 0; k < 3; k++)
        cwi_cross(p[(k + 1) % 3]->n, p[(k + 2) % 3]->n, cross[k]);
    const double volume = cwi_dot(p[0]->n, cross[0]);
    for (int a = 0; a < 3; a++)
        displacement[a] =
            (away[0] * cross[0][a] + away[1] * cross[1][a] + away[2] * cross[2][a]) / volume;
}

/* Returns true if the way from x leads to the surface, and not too far: then there is the
 * cut. */
static bool accept_cut(const sharpener *s, const double x[3], const double displacement[3],
                       cut *c)
{
    const double to[3] = {x[0] + displacement[0], x[1] + displacement[1],
                          x[2] + displacement[2]};
    if (!(cwi_length(displacement) <= MAX_CUT_REACH * s->voxel) || !is_on_surface(s, to))
        return false;
    for (int a = 0; a < 3; a++)
        c->x[a] = (float)to[a];
    return true;
}

static void take_normal(const plane *const *p, int count, cut *c)
{
    double sum[3] = {0};
    for (int n = 0; n < count; n++)
        for (int a = 0; a < 3; a++)
            sum[a] += p[n]->n[a];
    scale_to_one(sum);
    for (int a = 0; a < 3; a++)
        c->n[a] = (float)sum[a];
}

static bool is_apart(const sharpener *s, const cut *c, const double x[3])
{
    const double displacement[3] = {(double)c->x[0] - x[0], (double)c->x[1] - x[1],
                                    (double)c->x[2] - x[2]};
    return cwi_dot(displacement, displacement) >=
           MIN_SPACING * MIN_SPACING * s->voxel * s->voxel;
}

static bool is_plane(const plane *p)
{
    return cwi_dot(p->n, p->n) > 0;
}

/* ---- sides ------------------------------------------------------------------------------- */

/* Cuts a side: goes from its middle to where the planes at its ends meet. */
static void cut_side(const sharpener *s, uint32_t u, uint32_t v, cut *c)
{
    const plane *p[2] = {s->planes + u, s->planes + v};
    double x[3], y[3], middle[3], displacement[3];
    if (!is_plane(p[0]) || !is_plane(p[1]) || cwi_dot(p[0]->n, p[1]->n) > EDGE_COSINE)
        return;
    vertex_position(s->mesh, u, x);
    vertex_position(s->mesh, v, y);
    cwi_midpoint(x, y, middle);
    meet_two(p[0], p[1], p[0]->at - cwi_dot(p[0]->n, middle),
             p[1]->at - cwi_dot(p[1]->n, middle), displacement);
    c->is_on = accept_cut(s, middle, displacement, c) && is_apart(s, c, x) && is_apart(s, c, y);
    take_normal(p, 2, c);
}

static void cut_sides(void *context, size_t chunk)
{
    const sharpener *s = context;
    for (size_t v = chunk * CHUNK; v < (chunk + 1) * CHUNK && v < s->mesh->vertex_count; v++)
        for (uint32_t n = s->first[v]; n < s->first[v + 1]; n++)
            cut_side(s, (uint32_t)v, s->upper[n], s->sides + n);
}

/* Lists sides. In a closed, oriented surface each side is traversed once from the lower vertex.
 * Counts, then ends, then fills from the ends: first[v] becomes the place where v's sides
 * begin. */
static void find_sides(sharpener *s)
{
    const cw_mesh *m = s->mesh;
    memset(s->first, 0, (m->vertex_count + 1) * sizeof *s->first);
    for (size_t c = 0; c < 3 * m->triangle_count; c++) {
        const uint32_t u = m->triangles[c], v = m->triangles[c % 3 < 2 ? c + 1 : c - 2];
        s->first[u] += u < v;
    }
    for (size_t v = 1; v <= m->vertex_count; v++)
        s->first[v] += s->first[v - 1];
    s->side_count = s->first[m->vertex_count];
    for (size_t c = 3 * m->triangle_count; c-- > 0;) {
        const uint32_t u = m->triangles[c], v = m->triangles[c % 3 < 2 ? c + 1 : c - 2];
        if (u < v)
            s->upper[--s->first[u]] = v;
    }
}

/* Returns the cut of side k of a triangle. */
static cut *side_of(const sharpener *s, size_t t, size_t k)
{
    const uint32_t u = s->mesh->triangles[3 * t + k],
                   v = s->mesh->triangles[3 * t + (k + 1) % 3];
    uint32_t n = s->first[u < v ? u : v];
    while (s->upper[n] != (u < v ? v : u))
        n++;
    return s->sides + n;
}

/* ---- triangles --------------------------------------------------------------------------- */

/* Cuts a triangle at the point where three planes meet, if two of its sides are cut: beyond the
 * corner the third pair of planes may not meet on the surface. */
static void cut_triangle(const sharpener *s, size_t t, cut *c)
{
    const plane *p[3];
    double x[3], middle[3] = {0}, away[3], displacement[3], line[3];
    int cuts = 0;
    for (size_t k = 0; k < 3; k++) {
        const uint32_t v = s->mesh->triangles[3 * t + k];
        cuts += side_of(s, t, k)->is_on;
        p[k] = s->planes + v;
        vertex_position(s->mesh, v, x);
        for (int a = 0; a < 3; a++)
            middle[a] += x[a] / 3;
    }
    cwi_cross(p[0]->n, p[1]->n, line);
    if (cuts < 2 || fabs(cwi_dot(line, p[2]->n)) < MIN_CORNER_VOLUME)
        return;
    for (int k = 0; k < 3; k++)
        away[k] = p[k]->at - cwi_dot(p[k]->n, middle);
    meet_three(p, away, displacement);
    c->is_on = accept_cut(s, middle, displacement, c);
    take_normal(p, 3, c);
}

static void cut_triangles(void *context, size_t chunk)
{
    const sharpener *s = context;
    for (size_t t = chunk * CHUNK; t < (chunk + 1) * CHUNK && t < s->mesh->triangle_count; t++)
        cut_triangle(s, t, s->middles + t);
}

/* Moves a vertex onto its plane, if that is near and on the surface. Samples on both sides of
 * an edge put vertices off the surface. */
static void settle_vertex(const sharpener *s, uint32_t v)
{
    const plane *p = s->planes + v;
    double x[3];
    vertex_position(s->mesh, v, x);
    const double displacement = p->at - cwi_dot(p->n, x);
    for (int a = 0; a < 3; a++)
        x[a] += displacement * p->n[a];
    for (size_t a = 0;
         a < 3 && fabs(displacement) <= MAX_PLANE_DISTANCE * s->voxel && is_on_surface(s, x);
         a++)
        s->positions[3 * (size_t)v + a] = (float)x[a];
}

static void settle_ends(const sharpener *s)
{
    memcpy(s->positions, s->mesh->positions, 3 * s->mesh->vertex_count * sizeof *s->positions);
    for (size_t v = 0; v < s->mesh->vertex_count; v++)
        for (uint32_t n = s->first[v]; n < s->first[v + 1]; n++)
            if (s->sides[n].is_on) {
                settle_vertex(s, (uint32_t)v);
                settle_vertex(s, s->upper[n]);
            }
}

/* A corner of a part of a triangle. */
typedef struct point {
    double x[3];
    uint32_t vertex;
} point;

static point corner_point(const sharpener *s, uint32_t v)
{
    const float *x = s->positions + 3 * (size_t)v;
    return (point){{(double)x[0], (double)x[1], (double)x[2]}, v};
}

static point cut_point(const cut *c)
{
    return (point){{(double)c->x[0], (double)c->x[1], (double)c->x[2]}, c->vertex};
}

typedef struct part {
    const point *corner[3];
} part;

enum { MAX_PARTS = 6 };

/* Divides a triangle into parts around a point in it. */
static int divide_around(const point *c, const point v[3], const point *const m[3],
                         part parts[MAX_PARTS])
{
    const point *polygon[MAX_PARTS];
    int count = 0;
    for (int k = 0; k < 3; k++) {
        polygon[count++] = &v[k];
        if (m[k])
            polygon[count++] = m[k];
    }
    for (int n = 0; n < count; n++)
        parts[n] = (part){{polygon[n], polygon[(n + 1) % count], c}};
    return count;
}

/* Divides a triangle into parts between its corners v and the cuts m of its sides (NULL:
 * none). */
static int divide_by_cuts(const point v[3], const point *const m[3], part parts[MAX_PARTS])
{
    const int cuts = !!m[0] + !!m[1] + !!m[2];
    int k = 0; /* one cut: that one; two cuts: the first of them */
    while (cuts > 0 && cuts < 3 && !(m[k] && (cuts == 1 || m[(k + 1) % 3])))
        k++;
    const point *p = v + k, *q = v + (k + 1) % 3, *r = v + (k + 2) % 3;
    const point *pq = m[k], *qr = m[(k + 1) % 3], *rp = m[(k + 2) % 3];
    int n = 0;
    if (cuts == 0) {
        parts[n++] = (part){{p, q, r}};
    } else if (cuts == 1) {
        parts[n++] = (part){{p, pq, r}};
        parts[n++] = (part){{pq, q, r}};
    } else if (cuts == 2) {
        const bool is_short = cwi_distance_sq(p->x, qr->x) <= cwi_distance_sq(pq->x, r->x);
        parts[n++] = (part){{pq, q, qr}};
        parts[n++] = is_short ? (part){{p, pq, qr}} : (part){{p, pq, r}};
        parts[n++] = is_short ? (part){{p, qr, r}} : (part){{pq, qr, r}};
    } else {
        parts[n++] = (part){{p, pq, rp}};
        parts[n++] = (part){{q, qr, pq}};
        parts[n++] = (part){{r, rp, qr}};
        parts[n++] = (part){{pq, qr, rp}};
    }
    return n;
}

/* A triangle and its points. */
typedef struct division {
    point v[3], m[3], c;
    part parts[MAX_PARTS];
    int count;
} division;

static void divide_triangle(const sharpener *s, size_t t, division *d)
{
    const point *m[3] = {NULL};
    int cuts = 0;
    for (size_t k = 0; k < 3; k++) {
        const cut *side = side_of(s, t, k);
        d->v[k] = corner_point(s, s->mesh->triangles[3 * t + k]);
        d->m[k] = cut_point(side);
        m[k] = side->is_on ? &d->m[k] : NULL;
        cuts += side->is_on;
    }
    d->c = cut_point(s->middles + t);
    d->count = cuts >= 2 && s->middles[t].is_on ? divide_around(&d->c, d->v, m, d->parts)
                                                : divide_by_cuts(d->v, m, d->parts);
}

/* ---- what stays as it is ----------------------------------------------------------------- */

/* Returns true if a part is not a sliver, and faces as one of three planes does. */
static bool is_sound(const sharpener *s, const part *p, const plane *const planes[3])
{
    double u[3], v[3], n[3], longest = 0, best = -1;
    cwi_sub(p->corner[1]->x, p->corner[0]->x, u);
    cwi_sub(p->corner[2]->x, p->corner[0]->x, v);
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, cwi_distance_sq(p->corner[k]->x, p->corner[(k + 1) % 3]->x));
    cwi_cross(u, v, n);
    if (!(cwi_dot(n, n) > longest * MIN_HEIGHT * MIN_HEIGHT * s->voxel * s->voxel) ||
        !scale_to_one(n))
        return false;
    for (int k = 0; k < 3; k++)
        best = fmax(best, cwi_dot(n, planes[k]->n));
    return best >= FACING_COSINE;
}

/* Returns true if a corner of the triangle has moved. */
static bool has_moved(const sharpener *s, size_t t)
{
    bool has = false;
    for (size_t k = 0; k < 3; k++) {
        const size_t at = 3 * (size_t)s->mesh->triangles[3 * t + k];
        has |=
            memcmp(s->positions + at, s->mesh->positions + at, 3 * sizeof *s->positions) != 0;
    }
    return has;
}

/* Restores a triangle's corners and sides. */
static void restore_triangle(const sharpener *s, size_t t)
{
    for (size_t k = 0; k < 3; k++) {
        const size_t at = 3 * (size_t)s->mesh->triangles[3 * t + k];
        memcpy(s->positions + at, s->mesh->positions + at, 3 * sizeof *s->positions);
        side_of(s, t, k)->is_on = false;
    }
}

/* Restores the shortest of a triangle's cut sides, as least is lost there; without cut sides it
 * restores the corners. */
static void restore_some(const sharpener *s, size_t t, const division *d)
{
    cut *shortest = NULL;
    double shortest_sq = INFINITY;
    for (size_t k = 0; k < 3; k++) {
        cut *side = side_of(s, t, k);
        const double length_sq = cwi_distance_sq(d->v[k].x, d->v[(k + 1) % 3].x);
        if (side->is_on && length_sq < shortest_sq) {
            shortest_sq = length_sq;
            shortest = side;
        }
    }
    if (shortest)
        shortest->is_on = false;
    else
        restore_triangle(s, t);
}

/* Returns true if something had to be restored. */
static bool restore_unsound(const sharpener *s, size_t t)
{
    const plane *planes[3];
    division d;
    divide_triangle(s, t, &d);
    for (size_t k = 0; k < 3; k++)
        planes[k] = s->planes + s->mesh->triangles[3 * t + k];
    bool is_unsound = false;
    for (int n = 0; (d.count > 1 || has_moved(s, t)) && n < d.count; n++)
        is_unsound |= !is_sound(s, &d.parts[n], planes);
    if (is_unsound)
        restore_some(s, t, &d);
    return is_unsound;
}

/* Lists the triangles that changed. Others stay as they are: from here on nothing is cut or
 * moved, only put back. */
static void find_changed(sharpener *s)
{
    s->changed_count = 0;
    for (size_t t = 0; t < s->mesh->triangle_count; t++) {
        bool is_changed = has_moved(s, t);
        for (size_t k = 0; k < 3; k++)
            is_changed |= side_of(s, t, k)->is_on;
        if (is_changed)
            s->changed[s->changed_count++] = (uint32_t)t;
    }
}

static void restore_all_unsound(const sharpener *s)
{
    for (bool again = true; again;) {
        again = false;
        for (size_t n = 0; n < s->changed_count; n++)
            again |= restore_unsound(s, s->changed[n]);
    }
}

/* ---- the new mesh ------------------------------------------------------------------------ */

static void number_cuts(cut *cuts, size_t count, size_t *vertices)
{
    for (size_t n = 0; n < count; n++)
        if (cuts[n].is_on)
            cuts[n].vertex = (uint32_t)(*vertices)++;
}

static void put_cuts(const cut *cuts, size_t count, cw_mesh *m)
{
    for (size_t n = 0; n < count; n++)
        if (cuts[n].is_on) {
            memcpy(m->positions + 3 * (size_t)cuts[n].vertex, cuts[n].x, sizeof cuts[n].x);
            memcpy(m->normals + 3 * (size_t)cuts[n].vertex, cuts[n].n, sizeof cuts[n].n);
        }
}

/* Counts the parts. A triangle with two or more cut sides may be cut at a corner too: into five
 * parts or six. */
static size_t count_parts(const sharpener *s)
{
    size_t count = 0;
    for (size_t t = 0; t < s->mesh->triangle_count; t++) {
        division d;
        divide_triangle(s, t, &d);
        s->middles[t].is_on = d.count >= 5;
        count += (size_t)d.count;
    }
    return count;
}

static bool make_room_for(sharpener *s, size_t vertices, size_t triangles)
{
    cw_mesh *m = &s->made;
    cw_mesh_free(m);
    *m = (cw_mesh){.vertex_count = vertices, .triangle_count = triangles};
    m->positions = cwi_alloc_array(3 * vertices, sizeof *m->positions);
    m->normals = cwi_alloc_array(3 * vertices, sizeof *m->normals);
    m->triangles = cwi_alloc_array(3 * triangles, sizeof *m->triangles);
    cwi_free(s->parent);
    s->parent = cwi_alloc_array(triangles, sizeof *s->parent);
    return m->positions && m->normals && m->triangles && s->parent;
}

static cw_status make_sharp(sharpener *s, cw_error *err)
{
    const cw_mesh *m = s->mesh;
    const size_t triangles = count_parts(s);
    size_t vertices = m->vertex_count, n = 0;
    number_cuts(s->sides, s->side_count, &vertices);
    number_cuts(s->middles, m->triangle_count, &vertices);
    if (vertices > UINT32_MAX || !make_room_for(s, vertices, triangles))
        return cwi_fail_memory(err);
    memcpy(s->made.positions, s->positions, 3 * m->vertex_count * sizeof *m->positions);
    memcpy(s->made.normals, m->normals, 3 * m->vertex_count * sizeof *m->normals);
    put_cuts(s->sides, s->side_count, &s->made);
    put_cuts(s->middles, m->triangle_count, &s->made);
    for (size_t t = 0; t < m->triangle_count; t++) {
        division d;
        divide_triangle(s, t, &d);
        for (int p = 0; p < d.count; p++, n++) {
            s->parent[n] = (uint32_t)t;
            for (size_t k = 0; k < 3; k++)
                s->made.triangles[3 * n + k] = d.parts[p].corner[k]->vertex;
        }
    }
    return CW_OK;
}

/* Makes the mesh without the parts that cross, until nothing crosses; *is_clear is false if
 * that fails. */
static cw_status make_clear(sharpener *s, const cw_offset_desc *desc, bool *is_clear,
                            cw_error *err)
{
    const cw_crossings_desc how = {.threads = desc->threads, .progress = desc->progress};
    cw_status st = CW_OK;
    *is_clear = false;
    for (int round = 0; round < ROUNDS && st == CW_OK && !*is_clear; round++) {
        cw_crossings found = {0};
        restore_all_unsound(s);
        st = make_sharp(s, err);
        if (st == CW_OK)
            st = cw_self_intersections(&s->made, &how, &found, err);
        *is_clear = st == CW_OK && !found.count;
        for (size_t n = 0; n < 2 * found.count; n++)
            restore_triangle(s, s->parent[found.pairs[n]]);
        cw_crossings_free(&found);
    }
    return st;
}

/* ---- all of it --------------------------------------------------------------------------- */

static bool ensure_capacity(sharpener *s)
{
    const size_t n = s->mesh->vertex_count, t = s->mesh->triangle_count;
    s->planes = cwi_alloc_array(n, sizeof *s->planes);
    s->positions = cwi_alloc_array(3 * n, sizeof *s->positions);
    s->first = cwi_alloc_array(n + 1, sizeof *s->first);
    s->upper = cwi_alloc_array(3 * t / 2 + 1, sizeof *s->upper);
    s->sides = cwi_alloc_zeroed(3 * t / 2 + 1, sizeof *s->sides);
    s->middles = cwi_alloc_zeroed(t, sizeof *s->middles);
    s->changed = cwi_alloc_array(t, sizeof *s->changed);
    return s->planes && s->positions && s->first && s->upper && s->sides && s->middles &&
           s->changed;
}

static void free_room(sharpener *s)
{
    cwi_free(s->planes);
    cwi_free(s->positions);
    cwi_free(s->first);
    cwi_free(s->upper);
    cwi_free(s->sides);
    cwi_free(s->middles);
    cwi_free(s->parent);
    cwi_free(s->changed);
    cwi_boxes_free(&s->tree);
    cw_mesh_free(&s->made);
}

static size_t chunks_of(size_t count)
{
    return (count + CHUNK - 1) / CHUNK;
}

static cw_status find_cuts(sharpener *s, const cw_offset_desc *d, cw_error *err)
{
    static void (*const steps[])(void *, size_t) = {find_planes, cut_sides, cut_triangles};
    const size_t vertices = chunks_of(s->mesh->vertex_count),
                 triangles = chunks_of(s->mesh->triangle_count);
    find_sides(s);
    cw_status st = cwi_closest_build(s->from, &s->tree, err);
    for (int n = 0; n < 3 && st == CW_OK; n++)
        st = cwi_parallel_for(n < 2 ? vertices : triangles, 64 * CHUNK, d->threads,
                              &d->progress, "sharpening", steps[n], s, err);
    if (st != CW_OK)
        return st;
    settle_ends(s);
    find_changed(s);
    return CW_OK;
}

static void hand_over(sharpener *s)
{
    cw_mesh *m = s->mesh, was = *m;
    m->vertex_count = s->made.vertex_count;
    m->triangle_count = s->made.triangle_count;
    m->positions = s->made.positions;
    m->normals = s->made.normals;
    m->triangles = s->made.triangles;
    s->made.positions = was.positions;
    s->made.normals = was.normals;
    s->made.triangles = was.triangles;
}

cw_status cwi_sharpen(const cw_mesh *from, const cw_offset_desc *desc, double voxel_mm,
                      cw_mesh *mesh, cw_error *err)
{
    sharpener s = {.from = from, .mesh = mesh, .offset = desc->offset_mm, .voxel = voxel_mm};
    bool is_clear = false;
    cw_status st = CW_OK;
    if (!ensure_capacity(&s))
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = find_cuts(&s, desc, err);
    if (st == CW_OK)
        st = make_clear(&s, desc, &is_clear, err);
    if (is_clear)
        hand_over(&s);
    free_room(&s);
    return st;
}
