/* Merges neighbours of a section that are at the same place or nearly so, so that no triangle there is
 * without area, or a sliver. The surface stays a manifold: two vertices merge only if the triangle between them
 * has the only vertex that is next to both. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "simplify/cut/cut_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NONE UINT32_MAX

enum { MAX_NEIGHBOURS = 64 };

/* A triangle at a vertex that may merge. */
typedef struct vertex_triangle {
    uint32_t vertex, triangle;
} vertex_triangle;

typedef struct merge_work {
    cwi_cut *cut;
    bool *is_near;          /* of vertices: one of a pair at the same place */
    bool *is_busy;          /* of vertices: next to one that merged in this round */
    vertex_triangle *items; /* by vertex */
    size_t item_count, item_capacity;
    size_t merged; /* in this round */
} merge_work;

/* Returns true if two neighbours are at one place, or as near as vertices are to move into the plane. */
static bool is_short(const cwi_cut *c, const cwi_cut_edge *edge)
{
    const double length_sq = cwi_point_distance_sq(c->positions + 3 * (size_t)edge->start,
                                                   c->positions + 3 * (size_t)edge->end);
    const double near =
        c->near ? fmin(c->near[c->sources[edge->start].a], c->near[c->sources[edge->end].a])
                : 0;
    return length_sq <= near * near;
}

static int compare_items(const void *a, const void *b)
{
    const vertex_triangle *s = a, *t = b;
    if (s->vertex != t->vertex)
        return s->vertex < t->vertex ? -1 : 1;
    return (s->triangle > t->triangle) - (s->triangle < t->triangle);
}

/* Marks the vertices of short edges. Returns false if there are none. */
static bool mark_near(merge_work *w)
{
    const cwi_cut *c = w->cut;
    bool any = false;
    memset(w->is_near, 0, c->vertex_count * sizeof *w->is_near);
    memset(w->is_busy, 0, c->vertex_count * sizeof *w->is_busy);
    for (size_t e = 0; e < c->edge_count; e++)
        if (is_short(c, c->edges + e)) {
            w->is_near[c->edges[e].start] = w->is_near[c->edges[e].end] = true;
            any = true;
        }
    return any;
}

static bool gather_items(merge_work *w)
{
    const cwi_cut *c = w->cut;
    w->item_count = 0;
    for (size_t n = 0; n < 3 * c->triangle_count; n++) {
        if (!w->is_near[c->triangles[n]])
            continue;
        void *grown =
            cwi_grow_array(w->items, w->item_count, &w->item_capacity, sizeof *w->items);
        if (!grown)
            return false;
        w->items = grown;
        w->items[w->item_count++] = (vertex_triangle){c->triangles[n], (uint32_t)(n / 3)};
    }
    if (w->item_count)
        qsort(w->items, w->item_count, sizeof *w->items, compare_items);
    return true;
}

static const vertex_triangle *find_items(const merge_work *w, uint32_t vertex)
{
    size_t low = 0, high = w->item_count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (w->items[middle].vertex < vertex)
            low = middle + 1;
        else
            high = middle;
    }
    return w->items + low;
}

/* Lists the vertices next to one. Returns their number; MAX_NEIGHBOURS + 1 if they are more. */
static size_t list_neighbours(const merge_work *w, uint32_t vertex, uint32_t *list)
{
    const vertex_triangle *end = w->items + w->item_count;
    size_t count = 0;
    for (const vertex_triangle *i = find_items(w, vertex); i < end && i->vertex == vertex; i++)
        for (size_t k = 0; k < 3; k++) {
            const uint32_t v = w->cut->triangles[3 * (size_t)i->triangle + k];
            bool is_known = v == vertex;
            for (size_t n = 0; n < count; n++)
                is_known = is_known || list[n] == v;
            if (is_known)
                continue;
            if (count == MAX_NEIGHBOURS)
                return MAX_NEIGHBOURS + 1;
            list[count++] = v;
        }
    return count;
}

/* Merges the second vertex into the first if that keeps the surface a manifold. */
static void merge_pair(merge_work *w, uint32_t keep, uint32_t gone)
{
    uint32_t first[MAX_NEIGHBOURS], second[MAX_NEIGHBOURS];
    const size_t first_count = list_neighbours(w, keep, first),
                 second_count = list_neighbours(w, gone, second);
    size_t common = 0;
    if (first_count > MAX_NEIGHBOURS || second_count > MAX_NEIGHBOURS || w->is_busy[keep] ||
        w->is_busy[gone])
        return;
    for (size_t n = 0; n < first_count; n++)
        for (size_t m = 0; m < second_count; m++)
            common += first[n] == second[m];
    if (common != 1)
        return;
    const vertex_triangle *end = w->items + w->item_count;
    for (const vertex_triangle *i = find_items(w, gone); i < end && i->vertex == gone; i++)
        for (size_t k = 0; k < 3; k++) {
            uint32_t *corner = w->cut->triangles + 3 * (size_t)i->triangle + k;
            *corner = *corner == gone ? keep : *corner;
        }
    for (size_t n = 0; n < first_count; n++)
        w->is_busy[first[n]] = true;
    for (size_t n = 0; n < second_count; n++)
        w->is_busy[second[n]] = true;
    w->is_busy[keep] = true;
    w->is_near[gone] = false; /* its edges go to the other one */
    w->cut->sources[gone].a = NONE;
    w->cut->sources[gone].b = keep;
    w->merged++;
}

static uint32_t find_kept(const cwi_cut *c, uint32_t v)
{
    return c->sources[v].a == NONE ? c->sources[v].b : v;
}

/* Leaves out triangles and edges that name a vertex twice. */
static void drop_collapsed(cwi_cut *c)
{
    size_t kept = 0;
    for (size_t t = 0; t < c->triangle_count; t++) {
        const uint32_t *v = c->triangles + 3 * t;
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
            continue;
        c->parents[kept] = c->parents[t];
        memmove(c->triangles + 3 * kept++, v, 3 * sizeof *v);
    }
    c->triangle_count = kept;
    kept = 0;
    for (size_t e = 0; e < c->edge_count; e++) {
        const cwi_cut_edge edge = {find_kept(c, c->edges[e].start),
                                   find_kept(c, c->edges[e].end)};
        if (edge.start != edge.end)
            c->edges[kept++] = edge;
    }
    c->edge_count = kept;
}

cw_status cwi_cut_merge_equal(cwi_cut *c, cw_error *err)
{
    merge_work w = {.cut = c};
    w.is_near = cwi_alloc_array(c->vertex_count, sizeof *w.is_near);
    w.is_busy = cwi_alloc_array(c->vertex_count, sizeof *w.is_busy);
    bool ok = w.is_near && w.is_busy;
    do {
        w.merged = 0;
        if (!ok || !mark_near(&w))
            break;
        ok = gather_items(&w);
        for (size_t e = 0; e < c->edge_count && ok; e++) {
            const cwi_cut_edge *edge = c->edges + e;
            if (c->sources[edge->start].a != NONE && c->sources[edge->end].a != NONE &&
                is_short(c, edge))
                merge_pair(&w, edge->start, edge->end);
        }
        drop_collapsed(c);
        c->has_unused = c->has_unused || w.merged;
    } while (ok && w.merged);
    cwi_free(w.is_near);
    cwi_free(w.is_busy);
    cwi_free(w.items);
    return ok ? CW_OK : cwi_fail_memory(err);
}
