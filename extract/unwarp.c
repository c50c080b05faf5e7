#include "extract/warp.h"

#include "core/layers.h"
#include "core/memory.h"
#include "core/status.h"
#include "core/vector.h"
#include "simplify/quality/closest.h"

#include <cubewright/quality.h>

#include <math.h>
#include <string.h>

enum { CHUNK = 1024, ROUNDS = 5 };

/* Of a voxel: vertices nearer to the mesh stay; what is farther is tangled; and triangles are
 * flat below such a height. */
static const double near = 0.02, tangled = 0.15, low = 1e-4;

/* A vertex on its way: at `from` with share 0, at from + way with share 1. */
typedef struct mover {
    uint32_t vertex;
    float from[3], way[3], share;
} mover;

typedef struct motion {
    const cw_mesh *mesh;
    cw_mesh *surface;
    cwi_boxes tree;
    mover *movers;
    size_t count;
    uint32_t *mover_of; /* of vertices; UINT32_MAX: none */
    float (*ways)[3];   /* of vertices, to the mesh */
    float (*means)[4];  /* of vertices' neighbours: sums, and how many */
    double voxel, far;  /* from where on vertices are pulled */
    bool by_means;      /* to the mesh from where neighbours are on average */
} motion;

static float *position(const cw_mesh *m, uint32_t v)
{
    return m->positions + 3 * (size_t)v;
}

static void place(const motion *m, const mover *k)
{
    for (int a = 0; a < 3; a++)
        position(m->surface, k->vertex)[a] = k->from[a] + k->share * k->way[a];
}

static void add_mover(motion *m, uint32_t v, const float way[3])
{
    mover *k = m->movers + m->count;
    *k = (mover){.vertex = v, .share = 1, .way = {way[0], way[1], way[2]}};
    memcpy(k->from, position(m->surface, v), sizeof k->from);
    m->mover_of[v] = (uint32_t)m->count++;
    place(m, k);
}

static void forget_movers(motion *m)
{
    memset(m->mover_of, 0xff, m->surface->vertex_count * sizeof *m->mover_of);
    m->count = 0;
}

/* ---- as far as nothing crosses ----------------------------------------------------------- */

/* Whether one of its corners could go back half of its way, or the last tenth. */
static bool hold_back(motion *m, size_t triangle)
{
    bool any = false;
    for (size_t n = 0; n < 3; n++) {
        const uint32_t k = m->mover_of[m->surface->triangles[3 * triangle + n]];
        if (k == UINT32_MAX || m->movers[k].share == 0)
            continue;
        m->movers[k].share = m->movers[k].share > 0.1f ? m->movers[k].share / 2 : 0;
        place(m, m->movers + k);
        any = true;
    }
    return any;
}

static bool is_flat(const motion *m, size_t triangle)
{
    const uint32_t *v = m->surface->triangles + 3 * triangle;
    double way[3][3], n[3], longest = 0;
    for (int k = 0; k < 3; k++) {
        for (int a = 0; a < 3; a++)
            way[k][a] = (double)position(m->surface, v[(k + 1) % 3])[a] -
                        (double)position(m->surface, v[k])[a];
        longest = fmax(longest, cwi_dot(way[k], way[k]));
    }
    cwi_cross(way[0], way[1], n);
    return !(cwi_dot(n, n) > longest * low * low * m->voxel * m->voxel);
}

/* With every vertex back at its start nothing crosses: so there is an end. */
static cw_status settle(motion *m, const cw_crossings_desc *how, cw_error *err)
{
    cw_status st = CW_OK;
    for (bool again = m->count; again && st == CW_OK;) {
        cw_crossings found = {0};
        again = false;
        for (size_t t = 0; t < m->surface->triangle_count; t++)
            if (is_flat(m, t))
                again |= hold_back(m, t);
        st = cw_self_intersections(m->surface, how, &found, err);
        for (size_t n = 0; n < 2 * found.count; n++)
            again |= hold_back(m, found.pairs[n]);
        cw_crossings_free(&found);
    }
    return st;
}

/* ---- where samples went ------------------------------------------------------------------ */

/* Trilinear between the moves of the samples around: on an edge of the grid, of its ends. */
static bool way_at(const cwi_warp *w, const double at[3], float way[3])
{
    double sum[3] = {0};
    bool any = false;
    for (int n = 0; n < 8; n++) {
        uint32_t corner[3];
        const double share = cwi_warp_corner(at, n, corner);
        const cwi_move *m = share > 1e-6 ? cwi_warp_find(w, corner) : NULL;
        for (int a = 0; a < 3 && m; a++)
            sum[a] += share * m->way[a];
        any |= m != NULL;
    }
    for (int a = 0; a < 3; a++)
        way[a] = (float)(w->voxel * sum[a]);
    return any;
}

static void follow_samples(const cwi_warp *w, motion *m)
{
    forget_movers(m);
    for (uint32_t v = 0; v < m->surface->vertex_count; v++) {
        const float *p = position(m->surface, v);
        double at[3];
        float way[3];
        for (int a = 0; a < 3; a++)
            at[a] = (m->surface->origin[a] + (double)p[a] - w->corner[a]) / w->voxel;
        if (way_at(w, at, way))
            add_mover(m, v, way);
    }
}

/* ---- on to the mesh ---------------------------------------------------------------------- */

static void find_means(motion *m)
{
    const cw_mesh *s = m->surface;
    memset(m->means, 0, s->vertex_count * sizeof *m->means);
    for (size_t c = 0; c < 3 * s->triangle_count; c++) {
        const float *next = position(s, s->triangles[c % 3 < 2 ? c + 1 : c - 2]);
        float *mean = m->means[s->triangles[c]];
        for (int a = 0; a < 3; a++)
            mean[a] += next[a];
        mean[3]++;
    }
}

static double find_way(const motion *m, const double x[3], const double y[3], float way[3])
{
    const cwi_closest c = cwi_closest_find(m->mesh, &m->tree, y);
    double square = 0;
    for (int a = 0; a < 3; a++) {
        way[a] = (float)(c.point[a] - x[a]);
        square += (c.point[a] - x[a]) * (c.point[a] - x[a]);
    }
    return sqrt(square);
}

static void find_ways(void *context, size_t chunk)
{
    motion *m = context;
    for (size_t v = chunk * CHUNK; v < (chunk + 1) * CHUNK && v < m->surface->vertex_count;
         v++) {
        const float *p = position(m->surface, (uint32_t)v), *mean = m->means[v];
        double x[3], y[3];
        for (int a = 0; a < 3; a++) {
            x[a] = m->surface->origin[a] + (double)p[a] - m->mesh->origin[a];
            y[a] = x[a] + (double)mean[a] / (double)mean[3] - (double)p[a];
        }
        if (!(find_way(m, x, x, m->ways[v]) > m->far * m->voxel))
            memset(m->ways[v], 0, sizeof m->ways[v]);
        else if (m->by_means)
            find_way(m, x, y, m->ways[v]);
    }
}

/* To the closest points of the mesh; every other time only what is tangled, from where its
 * neighbours are on average: that frees it. */
static cw_status pull(motion *m, bool by_means, int threads, const cw_progress *progress,
                      cw_error *err)
{
    const size_t count = m->surface->vertex_count;
    m->by_means = by_means;
    m->far = by_means ? tangled : near;
    find_means(m);
    cw_status st = cwi_each_layer((count + CHUNK - 1) / CHUNK, 64 * CHUNK, threads, progress,
                                  "edges", find_ways, m, err);
    forget_movers(m);
    for (uint32_t v = 0; v < count && st == CW_OK; v++)
        if (m->ways[v][0] != 0 || m->ways[v][1] != 0 || m->ways[v][2] != 0)
            add_mover(m, v, m->ways[v]);
    return st;
}

/* ---- all of it --------------------------------------------------------------------------- */

static bool make_room(motion *m)
{
    const size_t n = m->surface->vertex_count;
    m->movers = cwi_alloc_array(n, sizeof *m->movers);
    m->mover_of = cwi_alloc_array(n, sizeof *m->mover_of);
    m->ways = cwi_alloc_array(n, sizeof *m->ways);
    m->means = cwi_alloc_array(n, sizeof *m->means);
    return m->movers && m->mover_of && m->ways && m->means;
}

cw_status cwi_unwarp(const cwi_warp *w, const cw_mesh *mesh, int threads,
                     const cw_progress *progress, cw_mesh *surface, cw_error *err)
{
    const cw_crossings_desc how = {.threads = threads, .progress = *progress};
    motion m = {.mesh = mesh, .surface = surface, .voxel = w->voxel};
    cw_status st = make_room(&m)
                       ? cwi_closest_build(mesh, &m.tree, err)
                       : cw_fail(err, CW_ERR_NO_MEMORY, "no memory to move %zu vertices",
                                 surface->vertex_count);
    if (st == CW_OK) {
        follow_samples(w, &m);
        st = settle(&m, &how, err);
    }
    for (int round = 0; round < ROUNDS && st == CW_OK; round++) {
        st = pull(&m, round % 2, threads, progress, err);
        if (st == CW_OK)
            st = settle(&m, &how, err);
    }
    cwi_boxes_free(&m.tree);
    cwi_free(m.movers);
    cwi_free(m.mover_of);
    cwi_free(m.ways);
    cwi_free(m.means);
    return st;
}
