/* Finds triangles of a label map that cross, from where their vertices may be.
 *
 * A vertex stays strictly inside of its cube, so a polygon stays strictly inside of the box of the
 * cubes around its edge, and only polygons with a cube in common can meet.
 *
 * Most need no test. Take an edge from voxel p to voxel q, and a polygon around it with one vertex
 * in each of its four cubes. The segment between vertices of two cubes passes through the face
 * between them, in a point f. In each of the two cubes, the triangle p, q, f and the cube's vertex
 * span a tetrahedron. The eight tetrahedra around the edge are its envelope. The triangles p, q, f
 * of different edges lie side by side on the faces of a cube, and all tetrahedra in a cube have
 * their apex in its vertex. So envelopes have at most faces in common [JuUdeshi2006].
 *
 * The polygon is two triangles. If p is strictly below both of their planes and q strictly above
 * both, the edge passes through one of them, and their common side through the triangle that p and
 * q span with the fourth vertex. Then the polygon is cut into triangles that each lie in a
 * tetrahedron of the envelope, and touch its surface in the sides of the polygon alone. Such
 * polygons are sound: two of them meet in common sides and vertices only. Nearly all others are sound
 * if they are cut along their other diagonal, and so they are; of two sound ones the shorter. */
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
    return (c->net->kinds[vertex] & (CWI_NET_FIXED | CWI_NET_BACK)) != 0;
}

/* Finds the ends of the edge around which a polygon of four cubes lies, along an axis. */
static void find_edge(const cwi_label_crossings *c, const uint32_t v[3], int axis, double p[3],
                      double q[3])
{
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
        const float x = c->originals[3 * (size_t)v[0] + (size_t)a];
        const float y = c->originals[3 * (size_t)v[1] + (size_t)a];
        const float z = c->originals[3 * (size_t)v[2] + (size_t)a];
        low[a] = high[a] = (double)(x > y ? (x > z ? x : z) : (y > z ? y : z)) - 0.5;
    }
    high[axis] += 1;
    c->to_point(c->context, low, p);
    c->to_point(c->context, high, q);
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

/* Returns true if a polygon of four corners is sound, as above, cut from one corner to the one across. */
static bool is_sound_from(double x[4][3], int first, const double p[3], const double q[3])
{
    const double *a = x[first], *b = x[first + 1], *c = x[first + 2], *d = x[(first + 3) % 4];
    const int side = find_side(a, b, c, p, q);
    return side && find_side(a, c, d, p, q) == side;
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

/* Returns true if a polygon is sound, as above. With may_turn it is cut along its shorter diagonal, or
 * along the longer one if it is sound only so. */
static bool is_sound(const cwi_label_crossings *c, size_t polygon, bool may_turn)
{
    const int edge = c->net->polygons[polygon];
    uint32_t v[CWI_POLYGON_CORNERS];
    double p[3], q[3], x[4][3];
    if ((edge != 1 && edge != 2 && edge != 4) || list_corners(c, polygon, v) != 4)
        return false;
    for (int n = 0; n < 4; n++)
        if (c->net->kinds[v[n]] & CWI_NET_FIXED) /* others in its cube */
            return false;
    find_edge(c, v, edge >> 1, p, q);
    for (int n = 0; n < 4; n++)
        for (int a = 0; a < 3; a++)
            x[n][a] = (double)c->mesh->positions[3 * (size_t)v[n] + (size_t)a];
    const int first = may_turn && cwi_distance_sq(x[1], x[3]) < cwi_distance_sq(x[0], x[2]);
    int from = first;
    bool is_sound_so = is_sound_from(x, from, p, q);
    if (!is_sound_so && may_turn) {
        from = 1 - first;
        is_sound_so = is_sound_from(x, from, p, q);
    }
    if (is_sound_so && from == 1)
        turn_diagonal(c, polygon, v);
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
