/* Moves the vertices of a warped grid's surface to the mesh, as far as no triangles cross. */
#include "extract/level_set/feature_warp.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/closest_point.h"
#include "core/geometry/triangle_intersect.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

enum { CHUNK = 1024, ROUNDS = 5 };

/* Fractions of a voxel: vertices nearer than this to the mesh stay; those farther than this are
 * tangled; triangles are flat below this height. */
static const double NEAR_VOXELS = 0.02, TANGLED_VOXELS = 0.15, FLAT_VOXELS = 1e-4;

/* A vertex on its way: at `from` with share 0, at from + way with share 1. */
typedef struct mover {
    uint32_t vertex;
    float from[3], displacement[3], fraction;
    bool moved; /* in this round */
} mover;

typedef struct motion {
    const cw_mesh *mesh;
    cw_mesh *surface;
    cwi_boxes tree;
    mover *movers;
    size_t count;
    uint32_t *mover_of;        /* of vertices; UINT32_MAX: none */
    float (*displacements)[3]; /* of vertices, to the mesh */
    float (*means)[4];         /* of vertices' neighbours: sums, and how many */
    double voxel, far;         /* distance from which vertices are pulled */
    bool by_means;             /* pulled to the mesh from the mean of their neighbours */
} motion;

static float *vertex_position(const cw_mesh *m, uint32_t v)
{
    return m->positions + 3 * (size_t)v;
}

static void move_vertex(const motion *m, const mover *k)
{
    for (int a = 0; a < 3; a++)
        vertex_position(m->surface, k->vertex)[a] =
            k->from[a] + k->fraction * k->displacement[a];
}

static void add_mover(motion *m, uint32_t v, const float displacement[3])
{
    mover *k = m->movers + m->count;
    *k = (mover){.vertex = v,
                 .fraction = 1,
                 .moved = true,
                 .displacement = {displacement[0], displacement[1], displacement[2]}};
    memcpy(k->from, vertex_position(m->surface, v), sizeof k->from);
    m->mover_of[v] = (uint32_t)m->count++;
    move_vertex(m, k);
}

static void forget_movers(motion *m)
{
    memset(m->mover_of, 0xff, m->surface->vertex_count * sizeof *m->mover_of);
    m->count = 0;
}

/* ---- as far as nothing crosses ----------------------------------------------------------- */

/* State of the test of triangles that moved, for crossings. */
typedef struct settling {
    motion *motion;
    cwi_boxes tree;      /* of all triangles, wherever on their ways their corners stop */
    uint32_t *pending;   /* those that moved since they were last tested */
    uint8_t *is_pending; /* of triangles */
    uint8_t *crosses;    /* of triangles: 1 where they cross another */
    size_t pending_count;
} settling;

/* The test of one triangle. */
typedef struct look {
    const settling *s;
    uint32_t triangle;
    float box[6];
} look;

static const uint32_t *triangle_corners(const motion *m, size_t triangle)
{
    return m->surface->triangles + 3 * triangle;
}

static mover *mover_at(const motion *m, uint32_t vertex)
{
    const uint32_t k = m->mover_of[vertex];
    return k == UINT32_MAX ? NULL : m->movers + k;
}

/* Finds the box of a triangle's corners on their ways. Rounding keeps points between the ends
 * between them. */
static void box_of_paths(const motion *m, size_t triangle, float box[6])
{
    cwi_boxes_triangle(m->surface->positions, triangle_corners(m, triangle), box);
    for (int n = 0; n < 3; n++) {
        const mover *k = mover_at(m, triangle_corners(m, triangle)[n]);
        for (int a = 0; a < 3 && k; a++) {
            const float ends[2] = {k->from[a], k->from[a] + k->displacement[a]};
            box[a] = fminf(box[a], fminf(ends[0], ends[1]));
            box[a + 3] = fmaxf(box[a + 3], fmaxf(ends[0], ends[1]));
        }
    }
}

static void note_crossing(const settling *s, uint32_t triangle)
{
    __atomic_store_n(&s->crosses[triangle], 1, __ATOMIC_RELAXED);
}

/* Tests two triangles. If both are to be tested, only one of them does it. */
static void test_pair(const look *l, uint32_t other)
{
    const settling *s = l->s;
    const motion *m = s->motion;
    const float *points = m->surface->positions;
    if (other == l->triangle || (s->is_pending[other] && other < l->triangle))
        return;
    if (cwi_has_area(points, triangle_corners(m, other)) &&
        cwi_triangles_meet(points, triangle_corners(m, l->triangle),
                           triangle_corners(m, other))) {
        note_crossing(s, l->triangle);
        note_crossing(s, other);
    }
}

static bool meet_node(void *context, size_t node)
{
    const look *l = context;
    const cwi_boxes *tree = &l->s->tree;
    const unsigned meeting = cwi_boxes_meeting(&tree->nodes[node], l->box);
    for (size_t c = 0; meeting >> c; c++)
        if (meeting >> c & 1)
            test_pair(l, tree->order[node * CWI_WIDTH + c]);
    return true;
}

static void look_at_chunk(void *context, size_t chunk)
{
    const settling *s = context;
    const float *points = s->motion->surface->positions;
    for (size_t n = chunk * CHUNK; n < (chunk + 1) * CHUNK && n < s->pending_count; n++) {
        look l = {.s = s, .triangle = s->pending[n]};
        const uint32_t *v = triangle_corners(s->motion, l.triangle);
        if (!cwi_has_area(points, v))
            continue;
        cwi_boxes_triangle(points, v, l.box);
        cwi_boxes_visit(&s->tree, l.box, 0, meet_node, &l);
    }
}

/* Moves a triangle's corners back by half of their ways, or by the last tenth. */
static void hold_back(motion *m, size_t triangle)
{
    for (size_t n = 0; n < 3; n++) {
        mover *k = mover_at(m, triangle_corners(m, triangle)[n]);
        if (!k || k->fraction == 0)
            continue;
        k->fraction = k->fraction > 0.1f ? k->fraction / 2 : 0;
        k->moved = true;
        move_vertex(m, k);
    }
}

static bool is_flat(const motion *m, size_t triangle)
{
    const uint32_t *v = triangle_corners(m, triangle);
    double side[3][3], n[3], longest = 0;
    for (int k = 0; k < 3; k++) {
        for (int a = 0; a < 3; a++)
            side[k][a] = (double)vertex_position(m->surface, v[(k + 1) % 3])[a] -
                         (double)vertex_position(m->surface, v[k])[a];
        longest = fmax(longest, cwi_dot(side[k], side[k]));
    }
    cwi_cross(side[0], side[1], n);
    return !(cwi_dot(n, n) > longest * FLAT_VOXELS * FLAT_VOXELS * m->voxel * m->voxel);
}

static void hold_back_all(settling *s)
{
    motion *m = s->motion;
    for (size_t t = 0; t < m->surface->triangle_count; t++)
        if (s->crosses[t] || (s->is_pending[t] && is_flat(m, t)))
            hold_back(m, t);
}

/* Lists the triangles at vertices that moved, to be tested next. */
static void ask_moved(settling *s)
{
    motion *m = s->motion;
    const size_t count = m->surface->triangle_count;
    memset(s->crosses, 0, count);
    s->pending_count = 0;
    for (size_t t = 0; t < count; t++) {
        s->is_pending[t] = 0;
        for (int n = 0; n < 3; n++) {
            const mover *k = mover_at(m, triangle_corners(m, t)[n]);
            s->is_pending[t] |= k && k->moved;
        }
        if (s->is_pending[t])
            s->pending[s->pending_count++] = (uint32_t)t;
    }
    for (size_t k = 0; k < m->count; k++)
        m->movers[k].moved = false;
}

static cw_status find_bounds(settling *s, cw_error *err)
{
    const size_t count = s->motion->surface->triangle_count;
    float(*boxes)[6] = cwi_alloc_array(count, sizeof *boxes);
    s->pending = cwi_alloc_array(count, sizeof *s->pending);
    s->is_pending = cwi_alloc_array(count, sizeof *s->is_pending);
    s->crosses = cwi_alloc_array(count, sizeof *s->crosses);
    const bool ok = boxes && s->pending && s->is_pending && s->crosses;
    for (size_t t = 0; t < count && ok; t++)
        box_of_paths(s->motion, t, boxes[t]);
    const cw_status st = ok ? cwi_boxes_build(&s->tree, (const float(*)[6])boxes, count, err)
                            : cwi_fail_memory(err);
    cwi_free(boxes);
    return st;
}

/* Moves vertices back until no triangles cross. It ends: with every vertex back at its start
 * nothing crosses. */
static cw_status settle_vertices(motion *m, int threads, const cw_progress *progress,
                                 cw_error *err)
{
    settling s = {.motion = m};
    if (!m->count)
        return CW_OK;
    cw_status st = find_bounds(&s, err);
    if (st == CW_OK)
        ask_moved(&s);
    while (st == CW_OK && s.pending_count) {
        st = cwi_parallel_for((s.pending_count + CHUNK - 1) / CHUNK, 64 * CHUNK, threads,
                              progress, "edges", look_at_chunk, &s, err);
        hold_back_all(&s);
        ask_moved(&s);
    }
    cwi_boxes_free(&s.tree);
    cwi_free(s.pending);
    cwi_free(s.is_pending);
    cwi_free(s.crosses);
    return st;
}

/* ---- where samples went ------------------------------------------------------------------ */

/* Interpolates trilinearly between the moves of the samples around: on an edge of the grid, of
 * its ends. */
static bool displacement_at(const cwi_warp *w, const double at[3], float displacement[3])
{
    double sum[3] = {0};
    bool any = false;
    for (int n = 0; n < 8; n++) {
        uint32_t corner[3];
        const double weight = cwi_warp_corner(at, n, corner);
        const cwi_move *m = weight > 1e-6 ? cwi_warp_find(w, corner) : NULL;
        for (int a = 0; a < 3 && m; a++)
            sum[a] += weight * m->displacement[a];
        any |= m != NULL;
    }
    for (int a = 0; a < 3; a++)
        displacement[a] = (float)(w->voxel * sum[a]);
    return any;
}

static void follow_samples(const cwi_warp *w, motion *m)
{
    forget_movers(m);
    for (uint32_t v = 0; v < m->surface->vertex_count; v++) {
        const float *p = vertex_position(m->surface, v);
        double at[3];
        float displacement[3];
        for (int a = 0; a < 3; a++)
            at[a] = (m->surface->origin[a] + (double)p[a] - w->corner[a]) / w->voxel;
        if (displacement_at(w, at, displacement))
            add_mover(m, v, displacement);
    }
}

/* ---- on to the mesh ---------------------------------------------------------------------- */

static void find_means(motion *m)
{
    const cw_mesh *s = m->surface;
    memset(m->means, 0, s->vertex_count * sizeof *m->means);
    for (size_t c = 0; c < 3 * s->triangle_count; c++) {
        const float *next = vertex_position(s, s->triangles[c % 3 < 2 ? c + 1 : c - 2]);
        float *mean = m->means[s->triangles[c]];
        for (int a = 0; a < 3; a++)
            mean[a] += next[a];
        mean[3]++;
    }
}

static double find_displacement(const motion *m, const double x[3], const double y[3],
                                float displacement[3])
{
    const cwi_closest c = cwi_closest_find(m->mesh, &m->tree, y);
    double distance_sq = 0;
    for (int a = 0; a < 3; a++) {
        displacement[a] = (float)(c.point[a] - x[a]);
        distance_sq += (c.point[a] - x[a]) * (c.point[a] - x[a]);
    }
    return sqrt(distance_sq);
}

static void find_displacements(void *context, size_t chunk)
{
    motion *m = context;
    for (size_t v = chunk * CHUNK; v < (chunk + 1) * CHUNK && v < m->surface->vertex_count;
         v++) {
        const float *p = vertex_position(m->surface, (uint32_t)v), *mean = m->means[v];
        double x[3], y[3];
        for (int a = 0; a < 3; a++) {
            x[a] = m->surface->origin[a] + (double)p[a] - m->mesh->origin[a];
            y[a] = x[a] + (double)mean[a] / (double)mean[3] - (double)p[a];
        }
        if (!(find_displacement(m, x, x, m->displacements[v]) > m->far * m->voxel))
            memset(m->displacements[v], 0, sizeof m->displacements[v]);
        else if (m->by_means)
            find_displacement(m, x, y, m->displacements[v]);
    }
}

/* Pulls vertices to the closest points of the mesh. Every other time it pulls only tangled
 * ones, from the mean of their neighbours: that frees them. */
static cw_status pull_vertices(motion *m, bool by_means, int threads,
                               const cw_progress *progress, cw_error *err)
{
    const size_t count = m->surface->vertex_count;
    m->by_means = by_means;
    m->far = by_means ? TANGLED_VOXELS : NEAR_VOXELS;
    find_means(m);
    cw_status st = cwi_parallel_for((count + CHUNK - 1) / CHUNK, 64 * CHUNK, threads, progress,
                                    "edges", find_displacements, m, err);
    forget_movers(m);
    for (uint32_t v = 0; v < count && st == CW_OK; v++)
        if (m->displacements[v][0] != 0 || m->displacements[v][1] != 0 ||
            m->displacements[v][2] != 0)
            add_mover(m, v, m->displacements[v]);
    return st;
}

/* ---- all of it --------------------------------------------------------------------------- */

static bool ensure_capacity(motion *m)
{
    const size_t n = m->surface->vertex_count;
    m->movers = cwi_alloc_array(n, sizeof *m->movers);
    m->mover_of = cwi_alloc_array(n, sizeof *m->mover_of);
    m->displacements = cwi_alloc_array(n, sizeof *m->displacements);
    m->means = cwi_alloc_array(n, sizeof *m->means);
    return m->movers && m->mover_of && m->displacements && m->means;
}

cw_status cwi_unwarp(const cwi_warp *w, const cw_mesh *mesh, int threads,
                     const cw_progress *progress, cw_mesh *surface, cw_error *err)
{
    motion m = {.mesh = mesh, .surface = surface, .voxel = w->voxel};
    cw_status st =
        ensure_capacity(&m) ? cwi_closest_build(mesh, &m.tree, err) : cwi_fail_memory(err);
    if (st == CW_OK) {
        follow_samples(w, &m);
        st = settle_vertices(&m, threads, progress, err);
    }
    for (int round = 0; round < ROUNDS && st == CW_OK; round++) {
        st = pull_vertices(&m, round % 2, threads, progress, err);
        if (st == CW_OK)
            st = settle_vertices(&m, threads, progress, err);
    }
    cwi_boxes_free(&m.tree);
    cwi_free(m.movers);
    cwi_free(m.mover_of);
    cwi_free(m.displacements);
    cwi_free(m.means);
    return st;
}
