/* Moves samples of a distance field to the right side of sharp edges, corners and thin
 * walls. */
#include "extract/level_set/feature_warp.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/closest_point.h"
#include "core/geometry/point_in_mesh.h"
#include "core/geometry/polygon_clip.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"
#include "extract/level_set/level_set.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FACE, EDGE, CORNER, JOINS = 6 };

/* Maximum cosines of normals: of faces that meet at less than 80 degrees, and of those that
 * meet at less than 120, which count where the part between them is thin. */
static const double SHARP_COSINE = -0.17, BENT_COSINE = 0.5;

/* Length of the mean of the normals around a corner, at most: a cube's is 0.58. */
static const double POINTED_MEAN = 0.55;

/* In voxels: the maximum thickness of thin walls and gaps; the minimum distance of a sample
 * that is moved; the distance from an edge at which its cube is determined. */
static const double MAX_THICKNESS = 2.4, MIN_DISTANCE = 0.01, EDGE_OFFSET = 0.01;

/* Pairs tried one after the other, in voxels: how deep a sample goes in from an edge or a face,
 * and how far from its old place along each axis. */
static const double DEPTHS[][2] = {{0.25, 0.45}, {0.1, 0.45},  {0.04, 0.45}, {0.1, 0.5},
                                   {0.04, 0.52}, {0.01, 0.51}, {0.001, 9}};

/* A sample that should be on a given side. */
typedef struct wish {
    uint32_t at[3];
    bool inside;
} wish;

typedef struct warping {
    cwi_warp *warp;
    const cw_mesh *mesh;
    const cw_volume *volume;
    cwi_boxes tree;
    cwi_lattice_map leaves; /* of the volume */
    double (*normals)[3];   /* of triangles */
    double (*corners)[4];   /* of vertices: normals around, weighted by angle; those weights */
    wish *wishes;           /* sorted; NULL: thin parts count */
    size_t wish_count, wish_capacity;
    bool out_of_memory;
} warping;

/* ---- samples ----------------------------------------------------------------------------- */

static float *voxel_at(const warping *g, const uint32_t at[3])
{
    return cwi_level_set_voxel(g->volume, &g->leaves, at);
}

/* Interpolates the distance trilinearly, in voxels; NaN beyond the band. */
static double distance_at(const warping *g, const double at[3])
{
    double sum = 0;
    for (int n = 0; n < 8; n++) {
        uint32_t corner[3];
        const double weight = cwi_warp_corner(at, n, corner);
        const float *v = voxel_at(g, corner);
        sum += v ? weight * (double)*v : (double)NAN;
    }
    return sum / g->warp->voxel;
}

static void nearest_sample(const double x[3], uint32_t at[3])
{
    for (int a = 0; a < 3; a++)
        at[a] = (uint32_t)floor(x[a] + 0.5);
}

static const float *vertex_position(const warping *g, uint32_t v)
{
    return g->mesh->positions + 3 * (size_t)v;
}

static void to_grid(const warping *g, uint32_t vertex, double at[3])
{
    for (int a = 0; a < 3; a++)
        at[a] =
            (g->mesh->origin[a] + (double)vertex_position(g, vertex)[a] - g->warp->corner[a]) /
            g->warp->voxel;
}

static void to_mesh(const warping *g, const double at[3], double p[3])
{
    for (int a = 0; a < 3; a++)
        p[a] = g->warp->corner[a] + g->warp->voxel * at[a] - g->mesh->origin[a];
}

static bool is_inside(const warping *g, const double p[3])
{
    return cwi_is_inside(g->mesh, &g->tree, (const double(*)[3])g->normals, p);
}

/* ---- moves ------------------------------------------------------------------------------- */

/* Returns true if the way from x on the surface, through what is inside or outside, soon leaves
 * it. */
static bool is_thin(const warping *g, const double x[3], const double in[3], bool inside)
{
    double at[3], p[3];
    cwi_add_scaled(x, MAX_THICKNESS, in, at);
    if (distance_at(g, at) * (inside ? -1 : 1) > 0.7 * MAX_THICKNESS)
        return false;
    to_mesh(g, at, p);
    return is_inside(g, p) != inside;
}

/* Moves to a place beside x on the wanted side, if there is one. */
static bool step_in(const warping *g, const double x[3], const double in[3], bool inside,
                    cwi_move *m)
{
    for (size_t n = 0; n < sizeof DEPTHS / sizeof *DEPTHS; n++) {
        double at[3], p[3];
        for (int a = 0; a < 3; a++)
            at[a] = fmax(m->at[a] - DEPTHS[n][1],
                         fmin(m->at[a] + DEPTHS[n][1], x[a] + DEPTHS[n][0] * in[a]));
        to_mesh(g, at, p);
        if (is_inside(g, p) != inside)
            continue;
        const cwi_closest c = cwi_closest_find(g->mesh, &g->tree, p);
        m->value =
            fmax(cwi_distance(p, c.point), MIN_DISTANCE * g->warp->voxel) * (inside ? -1 : 1);
        for (int a = 0; a < 3; a++)
            m->displacement[a] = at[a] - m->at[a];
        return true;
    }
    return false;
}

/* Considers moving a sample to x, on the surface. For a face only samples on the wrong side
 * move, for an edge or a corner all: they may be on the right side, but far from it. */
static void consider_move(warping *g, const uint32_t at[3], const double x[3],
                          const double in[3], bool inside, int rank)
{
    const float *voxel = voxel_at(g, at);
    const cwi_move *old = cwi_warp_find(g->warp, at);
    cwi_move m = {.at = {at[0], at[1], at[2]}, .rank = rank};
    for (int a = 0; a < 3; a++)
        m.distance_sq += (x[a] - at[a]) * (x[a] - at[a]);
    if (!voxel || (rank == FACE && (*voxel < 0) == inside))
        return;
    if (old && (old->rank > rank || (old->rank == rank && old->distance_sq <= m.distance_sq)))
        return;
    if (step_in(g, x, in, inside, &m))
        g->out_of_memory |= !cwi_warp_put(g->warp, &m);
}

/* ---- edges and corners ------------------------------------------------------------------- */

/* Considers the part of an edge that is in the cube of one sample. */
static void consider_part(warping *g, const double from[3], const double direction[3],
                          double begin, double end, const double in[3], bool inside,
                          bool always)
{
    const double margin = 0.05 * (end - begin);
    double x[3], along = 0;
    uint32_t at[3];
    for (int a = 0; a < 3; a++)
        x[a] = from[a] + (begin + end) / 2 * direction[a];
    nearest_sample(x, at);
    for (int a = 0; a < 3; a++)
        along += (at[a] - from[a]) * direction[a] / cwi_dot(direction, direction);
    along = fmax(begin + margin, fmin(end - margin, along));
    cwi_add_scaled(from, along, direction, x);
    if (always || is_thin(g, x, in, inside))
        consider_move(g, at, x, in, inside, EDGE);
}

/* Follows an edge from cube to cube. */
static void follow_edge(warping *g, const uint32_t ends[2], const double in[3], bool inside,
                        bool always)
{
    double from[3], direction[3], next[3], begin = 0;
    to_grid(g, ends[0], from);
    to_grid(g, ends[1], direction);
    for (int a = 0; a < 3; a++) {
        direction[a] -= from[a];
        from[a] += EDGE_OFFSET * in[a];
        const double side = floor(from[a] + 0.5) + (direction[a] > 0 ? 0.5 : -0.5);
        next[a] = direction[a] != 0 ? (side - from[a]) / direction[a] : INFINITY;
    }
    while (begin < 1) {
        const int a = next[0] <= next[1] && next[0] <= next[2] ? 0 : next[1] <= next[2] ? 1 : 2;
        const double end = fmin(next[a], 1);
        if (end > begin)
            consider_part(g, from, direction, begin, end, in, inside, always);
        begin = fmax(begin, end);
        next[a] += 1 / fabs(direction[a]);
    }
}

/* Considers the end of an edge as a corner, if it is one of the same kind as the edge: not
 * where an edge between faces that turn in ends in one that turns out. */
static void consider_corner(warping *g, uint32_t v, const double edge_in[3], bool inside,
                            bool always)
{
    const double *n = g->corners[v], length = cwi_length(n);
    const bool is_pointed = length < POINTED_MEAN * n[3];
    double x[3], in[3];
    uint32_t at[3];
    for (int a = 0; a < 3; a++)
        in[a] = length > 0 ? n[a] / length * (inside ? -1 : 1) : edge_in[a];
    if (!is_pointed && cwi_dot(in, edge_in) < 0.5)
        return;
    to_grid(g, v, x);
    for (int a = 0; a < 3; a++)
        x[a] += EDGE_OFFSET * in[a];
    nearest_sample(x, at);
    if (always || is_pointed || is_thin(g, x, in, inside))
        consider_move(g, at, x, in, inside, CORNER);
}

/* A triangle's side. */
typedef struct side {
    uint32_t ends[2], triangle; /* the lower end first */
} side;

static int compare_sides(const void *a, const void *b)
{
    const side *s = a, *t = b;
    for (int n = 0; n < 2; n++)
        if (s->ends[n] != t->ends[n])
            return s->ends[n] < t->ends[n] ? -1 : 1;
    return (s->triangle > t->triangle) - (s->triangle < t->triangle);
}

/* Returns true if the other corner of the one triangle is below the other's plane. */
static bool is_convex(const warping *g, const side *s, const side *t)
{
    const uint32_t *v = g->mesh->triangles + 3 * (size_t)t->triangle;
    const double *n = g->normals[s->triangle];
    double height = 0;
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++)
            height += n[a] * ((double)vertex_position(g, v[k])[a] -
                              (double)vertex_position(g, s->ends[0])[a]);
    return height < 0;
}

static void consider_edge(warping *g, const side *s, const side *t)
{
    const double *m = g->normals[s->triangle], *n = g->normals[t->triangle];
    const double cosine = cwi_dot(m, n);
    if (!(cosine <= BENT_COSINE))
        return;
    const bool inside = is_convex(g, s, t), always = cosine <= SHARP_COSINE;
    double in[3] = {m[0] + n[0], m[1] + n[1], m[2] + n[2]};
    const double length = cwi_length(in);
    if (!(length > 1e-6))
        return;
    for (int a = 0; a < 3; a++)
        in[a] /= inside ? -length : length;
    follow_edge(g, s->ends, in, inside, always);
    for (int k = 0; k < 2; k++)
        consider_corner(g, s->ends[k], in, inside, always);
}

/* Considers all edges. In a closed mesh each side has two triangles. */
static void consider_edges(warping *g)
{
    const cw_mesh *m = g->mesh;
    const size_t count = 3 * m->triangle_count;
    side *sides = cwi_alloc_array(count, sizeof *sides);
    g->out_of_memory |= !sides;
    for (size_t c = 0; c < count && sides; c++) {
        const uint32_t u = m->triangles[c], v = m->triangles[c % 3 < 2 ? c + 1 : c - 2];
        sides[c] = (side){{u < v ? u : v, u < v ? v : u}, (uint32_t)(c / 3)};
    }
    if (sides)
        qsort(sides, count, sizeof *sides, compare_sides);
    for (size_t n = 0; n + 1 < count && sides; n += 2)
        consider_edge(g, sides + n, sides + n + 1);
    cwi_free(sides);
}

/* ---- wishes: what joins samples that were moved with
 * others ------------------------------- */

static int compare_wishes(const void *a, const void *b)
{
    const wish *s = a, *t = b;
    const int order = memcmp(s->at, t->at, sizeof s->at);
    return order ? order : (int)s->inside - (int)t->inside;
}

static bool is_wished(const warping *g, const uint32_t at[3], bool inside)
{
    const wish key = {{at[0], at[1], at[2]}, inside};
    return bsearch(&key, g->wishes, g->wish_count, sizeof key, compare_wishes);
}

static bool is_on_side(const warping *g, const uint32_t at[3], bool inside)
{
    const cwi_move *m = cwi_warp_find(g->warp, at);
    const float *v = m ? NULL : voxel_at(g, at);
    return m ? (m->value < 0) == inside : v && (*v < 0) == inside;
}

static void add_wish(warping *g, const uint32_t at[3], bool inside)
{
    void *grown =
        cwi_grow_array(g->wishes, g->wish_count, &g->wish_capacity, sizeof *g->wishes);
    g->out_of_memory |= !grown;
    if (!grown)
        return;
    g->wishes = grown;
    g->wishes[g->wish_count++] = (wish){{at[0], at[1], at[2]}, inside};
}

static void step_along(const uint32_t at[3], int a, int by, uint32_t to[3])
{
    memcpy(to, at, 3 * sizeof *to);
    to[a] += (uint32_t)by;
}

/* Wishes to join, of four samples in a square, two of one side across from each other: where
 * they touch, marching cubes may separate them. */
static void wish_across(warping *g, const cwi_move *m, int a, int by, int other_by)
{
    const int b = (a + 1) % 3;
    const bool inside = m->value < 0;
    uint32_t first[3], second[3], across[3];
    step_along(m->at, a, by, first);
    step_along(m->at, b, other_by, second);
    step_along(first, b, other_by, across);
    if (!is_on_side(g, across, inside) || is_on_side(g, first, inside) ||
        is_on_side(g, second, inside))
        return;
    add_wish(g, first, inside);
    add_wish(g, second, inside);
}

/* Wishes the sample between two samples of one side to be on that side: else it would be a
 * hole. */
static void wish_between(warping *g, const cwi_move *m, int a, int by)
{
    const bool inside = m->value < 0;
    uint32_t next[3], far[3];
    step_along(m->at, a, by, next);
    step_along(next, a, by, far);
    if (!is_on_side(g, next, inside) && is_on_side(g, far, inside))
        add_wish(g, next, inside);
}

static bool is_alone(const warping *g, const cwi_move *m)
{
    bool alone = true;
    for (int n = 0; n < 6 && alone; n++) {
        uint32_t next[3];
        step_along(m->at, n / 2, n % 2 ? 1 : -1, next);
        alone = !is_on_side(g, next, m->value < 0);
    }
    return alone;
}

static void wish_around(warping *g, const cwi_move *m)
{
    const bool alone = is_alone(g, m);
    for (int n = 0; n < 6; n++) {
        uint32_t next[3];
        step_along(m->at, n / 2, n % 2 ? 1 : -1, next);
        if (alone)
            add_wish(g, next, m->value < 0);
        wish_between(g, m, n / 2, n % 2 ? 1 : -1);
        wish_across(g, m, n / 2, n % 2 ? 1 : -1, 1);
        wish_across(g, m, n / 2, n % 2 ? 1 : -1, -1);
    }
}

/* ---- faces ------------------------------------------------------------------------------- */

static void clip_to_cubes(const cwi_polygon *in, int a, double middle, cwi_polygon *out)
{
    cwi_polygon half;
    cwi_polygon_clip(in, a, middle - 0.5, -1, &half);
    cwi_polygon_clip(&half, a, middle + 0.5, 1, out);
}

/* Finds the samples whose cubes a polygon is in, along an axis. */
static void polygon_range(const cwi_polygon *p, int a, double *low, double *high)
{
    *low = INFINITY;
    *high = -INFINITY;
    for (int n = 0; n < p->count; n++) {
        *low = fmin(*low, p->p[n][a]);
        *high = fmax(*high, p->p[n][a]);
    }
    *low = floor(*low + 0.5);
    *high = floor(*high + 0.5);
}

static bool has_area(const cwi_polygon *p)
{
    double sum[3] = {0};
    for (int n = 1; n + 1 < p->count; n++) {
        double c[3];
        cwi_triangle_normal(p->p[0], p->p[n], p->p[n + 1], c);
        for (int a = 0; a < 3; a++)
            sum[a] += c[a];
    }
    return cwi_dot(sum, sum) > 1e-8;
}

/* Considers the part of a triangle that is in the cube of one sample. */
static void consider_piece(warping *g, const cwi_polygon *p, const double cube[3],
                           const double n[3])
{
    const uint32_t at[3] = {(uint32_t)cube[0], (uint32_t)cube[1], (uint32_t)cube[2]};
    const float *voxel = voxel_at(g, at);
    double x[3] = {0}, in[3];
    if (!voxel || !has_area(p))
        return;
    const bool inside = !(*voxel < 0);
    for (int a = 0; a < 3; a++) {
        for (int k = 0; k < p->count; k++)
            x[a] += p->p[k][a] / p->count;
        in[a] = inside ? -n[a] : n[a];
    }
    if (g->wishes ? is_wished(g, at, inside) : is_thin(g, x, in, inside))
        consider_move(g, at, x, in, inside, FACE);
}

/* Considers a face from cube to cube: last along the axis that the triangle faces most, along
 * which it is in few cubes. */
static void consider_face(warping *g, size_t t)
{
    const double *n = g->normals[t];
    double low[3], high[3], i[3];
    cwi_polygon all = {.count = 3}, slice, column, piece;
    int a = 0;
    for (int k = 1; k < 3; k++)
        a = fabs(n[k]) > fabs(n[a]) ? k : a;
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    for (size_t k = 0; k < 3; k++)
        to_grid(g, g->mesh->triangles[3 * t + k], all.p[k]);
    polygon_range(&all, b, &low[b], &high[b]);
    for (i[b] = low[b]; i[b] <= high[b]; i[b]++) {
        clip_to_cubes(&all, b, i[b], &slice);
        polygon_range(&slice, c, &low[c], &high[c]);
        for (i[c] = low[c]; i[c] <= high[c]; i[c]++) {
            clip_to_cubes(&slice, c, i[c], &column);
            polygon_range(&column, a, &low[a], &high[a]);
            for (i[a] = low[a]; i[a] <= high[a]; i[a]++) {
                clip_to_cubes(&column, a, i[a], &piece);
                consider_piece(g, &piece, i, n);
            }
        }
    }
}

static void consider_faces(warping *g)
{
    for (size_t t = 0; t < g->mesh->triangle_count; t++)
        consider_face(g, t);
}

static void join_samples(warping *g)
{
    for (int round = 0; round < JOINS; round++) {
        const size_t before = g->warp->count;
        g->wish_count = 0;
        for (size_t n = 0; n < before; n++)
            wish_around(g, g->warp->moves + n);
        if (!g->wish_count)
            return;
        qsort(g->wishes, g->wish_count, sizeof *g->wishes, compare_wishes);
        consider_faces(g);
        if (g->warp->count == before)
            return;
    }
}

/* ---- all of it --------------------------------------------------------------------------- */

static double angle_between(const double u[3], const double v[3])
{
    double n[3];
    cwi_cross(u, v, n);
    return atan2(cwi_length(n), cwi_dot(u, v));
}

static void find_normal(warping *g, size_t t)
{
    const uint32_t *v = g->mesh->triangles + 3 * t;
    double sides[3][3], *n = g->normals[t];
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++)
            sides[k][a] = (double)vertex_position(g, v[(k + 1) % 3])[a] -
                          (double)vertex_position(g, v[k])[a];
    cwi_cross(sides[0], sides[1], n);
    const double length = cwi_length(n);
    for (int a = 0; a < 3; a++)
        n[a] = length > 0 ? n[a] / length : 0;
    for (int k = 0; k < 3; k++) {
        const double *last = sides[(k + 2) % 3], back[3] = {-last[0], -last[1], -last[2]};
        const double weight = angle_between(sides[k], back);
        for (int a = 0; a < 3; a++)
            g->corners[v[k]][a] += weight * n[a];
        g->corners[v[k]][3] += weight;
    }
}

static bool ensure_capacity(warping *g)
{
    g->normals = cwi_alloc_array(g->mesh->triangle_count, sizeof *g->normals);
    g->corners = cwi_alloc_zeroed(g->mesh->vertex_count, sizeof *g->corners);
    return g->normals && g->corners && cwi_level_set_leaves(g->volume, &g->leaves);
}

/* Writes the moves into the volume. Samples that are joined with none stay. */
static void apply_moves(const warping *g)
{
    for (size_t n = 0; n < g->warp->count; n++) {
        cwi_move *m = g->warp->moves + n;
        if (is_alone(g, m))
            memset(m->displacement, 0, sizeof m->displacement);
        else
            *voxel_at(g, m->at) = (float)m->value;
    }
}

cw_status cwi_warp_init(cwi_warp *warp, const cw_mesh *mesh, cw_volume *volume, cw_error *err)
{
    warping g = {.warp = warp, .mesh = mesh, .volume = volume};
    *warp = (cwi_warp){.voxel = volume->affine[0][0]};
    for (int a = 0; a < 3; a++)
        warp->corner[a] = volume->affine[a][3];
    cw_status st = cwi_closest_build(mesh, &g.tree, err);
    g.out_of_memory = st == CW_OK && !ensure_capacity(&g);
    if (st == CW_OK && !g.out_of_memory) {
        for (size_t t = 0; t < mesh->triangle_count; t++)
            find_normal(&g, t);
        consider_faces(&g);
        consider_edges(&g);
        join_samples(&g);
        apply_moves(&g);
    }
    if (g.out_of_memory)
        st = cwi_fail_memory(err);
    cwi_boxes_free(&g.tree);
    cwi_lattice_free(&g.leaves);
    cwi_free(g.normals);
    cwi_free(g.corners);
    cwi_free(g.wishes);
    return st;
}
