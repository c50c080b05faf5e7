/* Finds triangles of a label map that cross, from where their vertices may be.
 *
 * A vertex stays strictly inside of its cube, so a polygon stays strictly inside of the box of the
 * cubes around its edge, and only polygons with a cube in common can meet.
 *
 * Most need no test. Take an edge from voxel p to voxel q, and the polygon around it, with a vertex in
 * each of the cells around the edge: cubes or, in cubes with several vertices, prisms or tetrahedra. The
 * segment between vertices of two cells passes through the face between them, in a point f. In each of
 * the two cells, the triangle p, q, f and the cell's vertex span a tetrahedron. Those around the edge
 * are its envelope. The triangles p, q, f of different edges lie side by side on the faces of a cell, and
 * all tetrahedra in a cell have their apex in its vertex. So envelopes have at most faces in common
 * [JuUdeshi2006].
 *
 * A cell is convex, so segments pass through the square between two cubes. If that is two faces, as one
 * of the cubes has several vertices, they may miss: this is tested.
 *
 * If p is strictly below the planes of all triangles of the polygon and q strictly above them, the
 * polygon is the graph of a function, seen along the edge. Cut it by the half plane from the edge through
 * one of its points. From its boundary, which is in the envelope, the cut runs towards the point in which
 * the plane of its first triangle meets the edge; where it enters the next triangle it is on the way
 * there, in the envelope, and so on. Then the polygon lies in its envelope, and touches the envelope's
 * surface in its own sides alone. Such polygons are sound: two of them meet in common sides and vertices
 * only. Nearly all others of four corners are sound if they are cut along their other diagonal, and so
 * they are; of two sound ones the shorter. */
#include "extract/labels/label_crossings.h"

#include "extract/labels/label_planes.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/triangle_intersect.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

enum {
    PART = 1 << 14,  /* triangles */
    QUEUE_PART = 64, /* polygons */
    SEEN = 128,      /* polygons that a search remembers */
    FAR = 8          /* polygons around vertices, which are on pages far from each other */
};

/* The edge passes through a sound polygon at least this fraction of its length from its ends. That
 * is far above the rounding errors of doubles. */
static const double MIN_CLEARANCE = 1e-4;

static const uint32_t *corners_of(const cwi_label_crossings *c, size_t triangle)
{
    return c->mesh->triangles + 3 * triangle;
}

/* Lists a polygon's corners. */
static int list_corners(const cwi_label_crossings *c, size_t polygon,
                        uint32_t corners[CWI_POLYGON_CORNERS])
{
    return cwi_polygon_corners(c->net, c->mesh, polygon, corners);
}

/* Returns true if a vertex is where it was before smoothing. */
static bool is_back(const cwi_label_crossings *c, uint32_t vertex)
{
    return (c->net->kinds[vertex] & CWI_NET_BACK) != 0;
}

/* A polygon, and where it lies in the grid. */
typedef struct sector {
    int count; /* of corners */
    uint32_t corners[CWI_POLYGON_CORNERS];
    double points[CWI_POLYGON_CORNERS][3];
    double cubes[CWI_POLYGON_CORNERS][3]; /* of corners: the lowest voxel */
    double p[3], q[3];                    /* ends of the edge */
} sector;

/* Finds the ends of the edge around which a polygon lies. Its cubes are beside it along the axes
 * along which it does not run. */
static void find_edge(const cwi_label_crossings *c, int edge, sector *s)
{
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
        low[a] = s->cubes[0][a];
        for (int n = 1; n < s->count; n++)
            low[a] = fmax(low[a], s->cubes[n][a]);
        high[a] = low[a] + (edge >> a & 1);
    }
    c->to_point(c->context, low, s->p);
    c->to_point(c->context, high, s->q);
}

static void load_sector(const cwi_label_crossings *c, size_t polygon, sector *s)
{
    s->count = list_corners(c, polygon, s->corners);
    for (int n = 0; n < s->count; n++)
        for (size_t a = 0; a < 3; a++) {
            const size_t at = 3 * (size_t)s->corners[n] + a;
            s->points[n][a] = (double)c->mesh->positions[at];
            s->cubes[n][a] = floor((double)c->originals[at]);
        }
    find_edge(c, c->net->polygons[polygon], s);
}

/* Returns the side of a triangle on which p is, if q is on the other side: 1 or -1; 0 if not. */
static int find_side(const double x[3], const double y[3], const double z[3], const double p[3],
                     const double q[3])
{
    double u[3], v[3], normal[3];
    cwi_sub(y, x, u);
    cwi_sub(z, x, v);
    cwi_cross(u, v, normal);
    cwi_sub(p, x, u);
    cwi_sub(q, x, v);
    const double hp = cwi_dot(normal, u), hq = cwi_dot(normal, v),
                 clearance = MIN_CLEARANCE * fabs(hp - hq);
    return hp < -clearance && hq > clearance ? -1 : hp > clearance && hq < -clearance;
}

/* Returns six times the volume of a tetrahedron: its sign tells on which side of the line from a to b
 * the line from c to d passes. */
static double find_passage(const double a[3], const double b[3], const double c[3],
                           const double d[3])
{
    double ab[3], ac[3], ad[3], normal[3];
    cwi_sub(b, a, ab);
    cwi_sub(c, a, ac);
    cwi_sub(d, a, ad);
    cwi_cross(ab, ac, normal);
    return cwi_dot(normal, ad);
}

/* Returns true if the segment from a vertex that shares its cube to one of a cube beside passes through
 * the half of the face on its side of the diagonal. */
static bool passes_half(const cwi_label_crossings *c, const sector *s, int shared, int beside)
{
    double low[3], high[3], ends[2][3], at[3], first[3], mirrored[3], across[3];
    for (int a = 0; a < 3; a++) {
        const double step = s->cubes[beside][a] - s->cubes[shared][a];
        at[a] = (double)c->originals[3 * (size_t)s->corners[shared] + (size_t)a];
        low[a] = fmax(s->cubes[beside][a], s->cubes[shared][a]);
        high[a] = low[a] + (step == 0);
        mirrored[a] = step == 0 ? at[a] : 2 * low[a] - at[a];
    }
    c->to_point(c->context, at, first);
    c->to_point(c->context, low, ends[0]);
    c->to_point(c->context, high, ends[1]);
    c->to_point(c->context, mirrored, across);
    const double here = find_passage(ends[0], ends[1], s->points[shared], s->points[beside]),
                 straight = find_passage(ends[0], ends[1], first, across);
    return straight > 0 ? here > MIN_CLEARANCE * straight : here < MIN_CLEARANCE * straight;
}

/* Returns true if the segments between a polygon's corners pass through the faces between their
 * tetrahedra, prisms or cubes. */
static bool passes_faces(const cwi_label_crossings *c, const sector *s)
{
    for (int n = 0; n < s->count; n++)
        for (int turns = 0; turns < 2; turns++) {
            const int m = (n + 1) % s->count, from = turns ? m : n, to = turns ? n : m;
            if (c->net->kinds[s->corners[from]] & CWI_NET_FIXED &&
                memcmp(s->cubes[from], s->cubes[to], sizeof s->cubes[to]) != 0 &&
                !passes_half(c, s, from, to))
                return false;
        }
    return true;
}

/* Returns true if the ends of the edge are on both sides of all triangles of a polygon, cut from a
 * corner to the others. */
static bool is_parted(const sector *s, int first)
{
    int side = 0;
    for (int n = 1; n + 1 < s->count; n++) {
        const int this_side = find_side(s->points[first], s->points[(first + n) % s->count],
                                        s->points[(first + n + 1) % s->count], s->p, s->q);
        if (!this_side || (side && this_side != side))
            return false;
        side = this_side;
    }
    return true;
}

/* Cuts a polygon of four corners along its other diagonal. */
static void turn_diagonal(const cwi_label_crossings *c, size_t polygon, const uint32_t v[4])
{
    uint32_t *t = c->mesh->triangles + 3 * polygon;
    const bool flips = t[4] != t[2];
    const uint32_t cut[2][6] = {{v[1], v[2], v[3], v[1], v[3], v[0]},
                                {v[1], v[3], v[2], v[1], v[0], v[3]}};
    memcpy(t, cut[flips], sizeof cut[flips]);
}

/* Returns true if a polygon is sound, as above. With may_turn one of four corners is cut along its
 * shorter diagonal, or along the longer one if it is sound only so. */
static bool is_sound(const cwi_label_crossings *c, size_t polygon, bool may_turn)
{
    sector s;
    load_sector(c, polygon, &s);
    const bool turns = may_turn && s.count == 4;
    const int first = turns && cwi_distance_sq(s.points[1], s.points[3]) <
                                   cwi_distance_sq(s.points[0], s.points[2]);
    int from = first;
    bool is_sound_so = passes_faces(c, &s);
    if (is_sound_so && !is_parted(&s, from)) {
        from = 1 - first;
        is_sound_so = turns && is_parted(&s, from);
    }
    if (is_sound_so && from == 1)
        turn_diagonal(c, polygon, s.corners);
    return is_sound_so;
}

static void judge_polygon(cwi_label_crossings *c, size_t polygon, bool may_turn)
{
    c->flags[polygon] = is_sound(c, polygon, may_turn) ? CWI_POLYGON_SOUND : CWI_POLYGON_QUEUED;
}

static void judge_part(void *context, size_t n)
{
    cwi_label_crossings *c = context;
    for (size_t t = n * PART; t < (n + 1) * PART && t < c->mesh->triangle_count; t++) {
        if (c->net->polygons[t])
            judge_polygon(c, t, true);
        cwi_label_trim(t);
    }
}

cw_status cwi_label_crossings_init(cwi_label_crossings *c, const cw_labels_desc *desc,
                                   cw_error *err)
{
    const cw_mesh *mesh = c->mesh;
    const size_t parts = (mesh->triangle_count + PART - 1) / PART;
    c->flags = cwi_alloc_zeroed(mesh->triangle_count, 1);
    c->queue = cwi_alloc_large(mesh->triangle_count, sizeof *c->queue);
    c->hits = cwi_alloc_zeroed(mesh->vertex_count, 1);
    if (!c->flags || !c->queue || !c->hits)
        return cwi_fail_memory(err);
    cw_status st = cwi_parallel_for(parts, 8 * PART, desc->threads, &desc->progress,
                                    "looking for crossings", judge_part, c, err);
    for (size_t t = 0; t < mesh->triangle_count && st == CW_OK; t++) {
        if (c->flags[t] & CWI_POLYGON_QUEUED)
            c->queue[c->queued++] = (uint32_t)t;
        cwi_memory_trim_at(t);
    }
    return st;
}

static bool boxes_are_apart(const float *points, const uint32_t a[3], const uint32_t b[3])
{
    for (int axis = 0; axis < 3; axis++) {
        const float *p = points + axis;
        float low[2], high[2];
        for (int n = 0; n < 2; n++) {
            const uint32_t *v = n ? b : a;
            const float x = p[3 * (size_t)v[0]], y = p[3 * (size_t)v[1]],
                        z = p[3 * (size_t)v[2]];
            low[n] = x < y ? (x < z ? x : z) : (y < z ? y : z);
            high[n] = x > y ? (x > z ? x : z) : (y > z ? y : z);
        }
        if (low[0] > high[1] || low[1] > high[0])
            return true;
    }
    return false;
}

static void hit_triangle(cwi_label_crossings *c, const uint32_t v[3])
{
    for (int n = 0; n < 3; n++)
        __atomic_store_n(&c->hits[v[n]], 1, __ATOMIC_RELAXED);
}

static bool all_back(const cwi_label_crossings *c, const uint32_t v[3])
{
    return is_back(c, v[0]) && is_back(c, v[1]) && is_back(c, v[2]);
}

/* Tests two triangles; where they were at first, none crossed. */
static void test_pair(cwi_label_crossings *c, size_t s, size_t t)
{
    const float *points = c->mesh->positions;
    const uint32_t *a = corners_of(c, s), *b = corners_of(c, t);
    if ((all_back(c, a) && all_back(c, b)) || boxes_are_apart(points, a, b) ||
        !cwi_has_area(points, a) || !cwi_has_area(points, b) ||
        !cwi_triangles_meet(points, a, b))
        return;
    hit_triangle(c, a);
    hit_triangle(c, b);
}

/* Tests the triangles of a polygon: with each other, and whether they have an area. */
static void test_inside(cwi_label_crossings *c, size_t polygon, cwi_label_planes *planes)
{
    const size_t count = (size_t)planes->count - 2;
    const uint64_t pairs = cwi_label_planes_pairs(planes, planes);
    for (size_t s = 0; s < count; s++) {
        const uint32_t *v = corners_of(c, polygon + s);
        if (!cwi_label_planes_has_area(planes, (int)s) && !all_back(c, v) &&
            !cwi_has_area(c->mesh->positions, v))
            hit_triangle(c, v);
        for (size_t t = s + 1; t < count; t++)
            if (pairs >> (8 * s + t) & 1)
                test_pair(c, polygon + s, polygon + t);
    }
}

static void test_polygons(cwi_label_crossings *c, size_t one, cwi_label_planes *planes,
                          size_t other)
{
    cwi_label_planes others;
    cwi_label_planes_load(&others, c->net, c->mesh, other);
    const uint64_t pairs = cwi_label_planes_pairs(planes, &others);
    for (size_t n = 0; pairs >> n && n < 64; n++)
        if (pairs >> n & 1)
            test_pair(c, one + n / 8, other + n % 8);
}

/* Returns true if two vertices are in one cube. */
static bool share_cube(const cwi_label_crossings *c, uint32_t v, uint32_t w)
{
    const float *p = c->originals + 3 * (size_t)v, *q = c->originals + 3 * (size_t)w;
    return floorf(p[0]) == floorf(q[0]) && floorf(p[1]) == floorf(q[1]) &&
           floorf(p[2]) == floorf(q[2]);
}

/* Tests a polygon of the queue against those with a cube in common. A polygon has vertices in all
 * cubes around its edge. Vertices of one cube follow each other. */
static void test_around(cwi_label_crossings *c, size_t polygon)
{
    cwi_label_planes planes;
    uint32_t seen[SEEN];
    const uint8_t flags = c->flags[polygon];
    int seen_count = 0;
    cwi_label_planes_load(&planes, c->net, c->mesh, polygon);
    test_inside(c, polygon, &planes);
    for (int n = 0; n < planes.count; n++) {
        uint32_t first = planes.corners[n], end = first + 1;
        const bool is_alone = !(c->net->kinds[first] & CWI_NET_FIXED);
        while (!is_alone && first > 0 && share_cube(c, first - 1, first))
            first--;
        while (!is_alone && end < c->mesh->vertex_count && share_cube(c, end, first))
            end++;
        for (uint32_t k = c->net->firsts[first]; k < c->net->firsts[end]; k++) {
            const uint32_t other = c->net->around[k];
            const uint8_t its = c->flags[other];
            int i = 0;
            if (other == polygon || (its & flags & CWI_POLYGON_SOUND) ||
                (its & CWI_POLYGON_QUEUED && other < polygon)) /* it tests this one */
                continue;
            while (i < seen_count && seen[i] != other)
                i++;
            if (i < seen_count)
                continue;
            if (seen_count < SEEN)
                seen[seen_count++] = other;
            test_polygons(c, polygon, &planes, other);
        }
    }
}

static void test_part(void *context, size_t n)
{
    cwi_label_crossings *c = context;
    for (size_t i = n * QUEUE_PART; i < (n + 1) * QUEUE_PART && i < c->queued; i++) {
        test_around(c, c->queue[i]);
        if (i % FAR == 0)
            cwi_memory_trim();
    }
}

cw_status cwi_label_crossings_find(cwi_label_crossings *c, const cw_labels_desc *desc,
                                   cw_error *err)
{
    return cwi_parallel_for((c->queued + QUEUE_PART - 1) / QUEUE_PART, 64 * QUEUE_PART,
                            desc->threads, &desc->progress, "looking for crossings", test_part,
                            c, err);
}

void cwi_label_crossings_renew(cwi_label_crossings *c)
{
    for (size_t n = 0; n < c->queued; n++) {
        c->flags[c->queue[n]] &= (uint8_t)~CWI_POLYGON_QUEUED;
        cwi_memory_trim_at(n);
    }
    c->queued = 0;
    for (size_t v = 0; v < c->mesh->vertex_count; v++) {
        for (uint32_t k = c->net->firsts[v]; k < c->net->firsts[v + 1] && c->hits[v]; k++) {
            const uint32_t polygon = c->net->around[k];
            if (c->flags[polygon] & CWI_POLYGON_QUEUED)
                continue;
            judge_polygon(c, polygon, false);
            c->flags[polygon] |= CWI_POLYGON_QUEUED;
            c->queue[c->queued++] = polygon;
        }
        if (c->hits[v] && c->queued % FAR == 0)
            cwi_memory_trim();
        c->hits[v] = 0;
        cwi_label_trim(v);
    }
}

void cwi_label_crossings_free(cwi_label_crossings *c)
{
    cwi_free(c->flags);
    cwi_free(c->queue);
    cwi_free(c->hits);
}
