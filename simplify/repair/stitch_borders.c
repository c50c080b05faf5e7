/* Stitches borders: open edges that lie along each other become one, and vertices on an open edge split it. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/bvh.h"
#include "core/geometry/triangle.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"
#include "core/mesh/mesh.h"
#include "simplify/repair/border_list.h"
#include "simplify/repair/repair_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Edges that are split lie in one round beside each other in triangles: each triangle is split at one edge a round. */
enum { ROUNDS = 8 };

/* Steps of the last digit of the largest coordinate within which borders always meet. */
static const double FLOOR_STEPS = 4;

/* Where fewer than half of all edges have a partner, the distances must leap by this to say that those lie apart by
 * mistake: the rim of a narrow triangle that is missing lies along itself, too. */
static const double LEAST_LEAP = 4;

/* A vertex may be farther from the middle of those that it is made of than they are from each other: in a sharp
 * corner. */
static const double MOST_MOVE = 2;

/* Later rounds reach farther, because vertices moved to the middle of those that they became one with. */
static const double LATER_REACH = 2;

/* A vertex on an open edge. */
typedef struct edge_split {
    uint32_t corner, vertex;
    double at; /* along the edge: 0 to 1 */
} edge_split;

typedef struct stitch_work {
    cwi_repair *r;
    cwi_border_list borders;
    uint32_t *root; /* of a vertex: union-find of those that become one */
    edge_split *splits;
    size_t count, capacity;
    double reach_mm;
    size_t welded, split;
} stitch_work;

/* --- the distance ------------------------------------------------------------------------- */

static int compare_doubles(const void *a, const void *b)
{
    const double s = *(const double *)a, t = *(const double *)b;
    return s < t ? -1 : s > t;
}

static double measure_floor(const cw_mesh *m)
{
    float largest = 0;
    for (size_t n = 0; n < 3 * m->vertex_count; n++)
        largest = fmaxf(largest, fabsf(m->positions[n]));
    return FLOOR_STEPS * (double)largest * 0x1p-23;
}

/* Finds the distance below which borders meet: where the distances of edges from their nearest partners leap most,
 * among the larger half of them. Above all of them comes a share of the median length.
 * sorted  room for one number of each edge */
static double find_reach(const cwi_border_list *b, double floor_mm, double *sorted)
{
    size_t count = 0;
    for (size_t n = 0; n < b->count; n++)
        sorted[n] = b->edges[n].length;
    qsort(sorted, b->count, sizeof *sorted, compare_doubles);
    const double above = b->share * sorted[b->count / 2];
    for (size_t n = 0; n < b->count; n++)
        if (isfinite(b->edges[n].nearest))
            sorted[count++] = fmax(b->edges[n].nearest, floor_mm);
    if (!count)
        return 0;
    qsort(sorted, count, sizeof *sorted, compare_doubles);
    double reach = floor_mm, leap = 0;
    for (size_t n = (count - 1) / 2; n < count; n++) {
        const double next = n + 1 < count ? sorted[n + 1] : fmax(above, sorted[n]);
        if (next >= leap * sorted[n]) {
            leap = next / sorted[n];
            reach = sorted[n];
        }
    }
    return leap >= LEAST_LEAP || 2 * count >= 3 * b->mesh->triangle_count ? reach : floor_mm;
}

/* --- what becomes one --------------------------------------------------------------------- */

static bool add_split(stitch_work *w, uint32_t corner, uint32_t vertex, double at)
{
    edge_split *splits = cwi_grow_array(w->splits, w->count, &w->capacity, sizeof *splits);
    if (!splits)
        return false;
    w->splits = splits;
    w->splits[w->count++] = (edge_split){corner, vertex, at};
    return true;
}

/* Joins the ends of two edges that lie along each other, or notes that one end splits the other edge. */
static bool join_pair(stitch_work *w, const cwi_border_pair *pair)
{
    cwi_overlap ends[2];
    if (!cwi_borders_overlap(&w->borders, pair->edges, w->reach_mm, ends))
        return true;
    for (int n = 0; n < 2; n++) {
        if (ends[n].is_split && !add_split(w, ends[n].corner, ends[n].vertex, ends[n].at))
            return false;
        if (!ends[n].is_split)
            cwi_sets_join(w->root, ends[n].vertex, ends[n].other);
    }
    return true;
}

/* --- splits ------------------------------------------------------------------------------- */

/* Sorts by triangles, then by edges, then along them. */
static int compare_splits(const void *a, const void *b)
{
    const edge_split *s = a, *t = b;
    if (s->corner != t->corner)
        return s->corner < t->corner ? -1 : 1;
    if (s->at != t->at)
        return s->at < t->at ? -1 : 1;
    return s->vertex < t->vertex ? -1 : s->vertex > t->vertex;
}

/* Returns true if a triangle of an edge's ends and its tip stays on its side when a vertex splits that edge. */
static bool may_split(const cw_mesh *m, uint32_t corner, uint32_t vertex)
{
    const uint32_t a = m->triangles[corner], b = m->triangles[cwi_corner_next(corner)],
                   tip = m->triangles[cwi_corner_prev(corner)];
    if (a == b || vertex == a || vertex == b || vertex == tip)
        return false;
    double along[3], up[3], to[3], area[3], aside[3];
    cwi_sub_points(m->positions + 3 * (size_t)b, m->positions + 3 * (size_t)a, along);
    cwi_sub_points(m->positions + 3 * (size_t)tip, m->positions + 3 * (size_t)a, up);
    cwi_sub_points(m->positions + 3 * (size_t)vertex, m->positions + 3 * (size_t)a, to);
    cwi_cross(along, up, area);
    cwi_cross(along, to, aside);
    return cwi_dot(area, area) > 4 * cwi_dot(aside, aside);
}

/* Splits triangles at one edge each, into fans around their tips. New triangles have the source of the old one. */
static cw_status split_triangles(stitch_work *w, cw_error *err)
{
    cw_mesh *m = &w->r->mesh;
    const size_t before = m->triangle_count;
    uint32_t *fan = cwi_alloc_array(w->count, 3 * sizeof *fan),
             *source = cwi_alloc_array(w->count, sizeof *source);
    size_t added = 0;
    cw_status st = fan && source ? CW_OK : cwi_fail_memory(err);
    qsort(w->splits, w->count, sizeof *w->splits, compare_splits);
    for (size_t n = 0, same; n < w->count && st == CW_OK; n += same) {
        const uint32_t t = w->splits[n].corner / 3, corner = w->splits[n].corner;
        const uint32_t tip = m->triangles[cwi_corner_prev(corner)];
        uint32_t last = m->triangles[corner];
        size_t made = 0;
        for (same = 0; n + same < w->count && w->splits[n + same].corner / 3 == t; same++) {
            const edge_split *s = &w->splits[n + same];
            const uint32_t vertex = cwi_sets_find(w->root, s->vertex);
            if (s->corner != corner || vertex == last || !may_split(m, corner, vertex))
                continue;
            const uint32_t corners[3] = {last, vertex, tip};
            memcpy(fan + 3 * added, corners, sizeof corners);
            source[added++] = t;
            last = vertex;
            made++;
        }
        m->triangles[corner] = last;
        w->split += made > 0;
    }
    if (st == CW_OK && added)
        st = cwi_repair_append(w->r, NULL, 0, fan, added, err);
    uint32_t *of = m->attributes->data;
    for (size_t n = 0; n < added && st == CW_OK; n++)
        of[before + n] = of[source[n]];
    cwi_free(fan);
    cwi_free(source);
    return st;
}

static cw_status drop_collapsed(cw_mesh *m, cw_error *err)
{
    bool *gone = cwi_alloc_zeroed(m->triangle_count, sizeof *gone);
    if (!gone)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < m->triangle_count; t++)
        gone[t] = cwi_triangle_is_collapsed(m->triangles + 3 * t);
    const cw_status st = cwi_mesh_drop_marked(m, gone, err);
    cwi_free(gone);
    return st;
}

/* --- rounds ------------------------------------------------------------------------------- */

static cw_status choose_reach(stitch_work *w, double floor_mm, cw_error *err)
{
    if (w->r->desc.weld_mm > 0) {
        w->reach_mm = w->r->desc.weld_mm;
        return CW_OK;
    }
    double *sorted = cwi_alloc_array(w->borders.count, sizeof *sorted);
    if (!sorted)
        return cwi_fail_memory(err);
    w->reach_mm = find_reach(&w->borders, floor_mm, sorted);
    cwi_free(sorted);
    return CW_OK;
}

/* Stitches what meets now. changed: set to true if anything does */
static cw_status stitch_round(stitch_work *w, bool is_first, bool *changed, cw_error *err)
{
    cw_repair_facts *f = &w->r->facts;
    *changed = false;
    cw_status st = cwi_borders_list(w->r, &w->borders, err);
    if (st == CW_OK && w->borders.pair_count && is_first)
        st = choose_reach(w, measure_floor(&w->r->mesh), err);
    if (st != CW_OK || !w->borders.pair_count)
        return st;
    const double reach = w->reach_mm;
    w->reach_mm = is_first ? reach : LATER_REACH * reach;
    w->root = cwi_sets_alloc(w->r->mesh.vertex_count);
    bool ok = w->root != NULL;
    for (size_t n = 0; n < w->borders.pair_count && ok; n++)
        ok = join_pair(w, &w->borders.pairs[n]);
    w->welded = w->split = 0;
    ok = ok && cwi_join_vertices(&w->r->mesh, w->root, MOST_MOVE * reach, &w->welded);
    st = ok ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK && w->count)
        st = split_triangles(w, err);
    if (st == CW_OK && w->welded)
        st = drop_collapsed(&w->r->mesh, err);
    *changed = w->welded || w->split;
    f->welded += w->welded;
    f->split_edges += w->split;
    w->reach_mm = reach;
    if (*changed)
        f->weld_mm = fmax(f->weld_mm, w->reach_mm);
    w->count = 0;
    cwi_free(w->root);
    w->root = NULL;
    return st;
}

cw_status cwi_stitch_borders(cwi_repair *r, cw_error *err)
{
    stitch_work w = {.r = r};
    bool changed = true;
    cw_status st = CW_OK;
    for (int round = 0; round < ROUNDS && changed && st == CW_OK; round++) {
        st = stitch_round(&w, round == 0, &changed, err);
        cwi_borders_free(&w.borders);
    }
    cwi_free(w.splits);
    return st;
}
