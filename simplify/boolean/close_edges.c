/* Edges of two sheets of surface that pass each other closer than floats can tell apart: they get a vertex in
 * common, so that the sheets have the same edges wherever they are that close. */
#include "simplify/boolean/snapping.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <stdlib.h>

typedef struct edge {
    uint32_t a, b; /* a < b */
} edge;

typedef struct edge_search {
    cwi_inserter *w;
    size_t count;
    edge *edges; /* of hot triangles, each once, in order */
    float (*boxes)[6];
    cwi_boxes tree;
    uint32_t at; /* the edge that is looked at */
} edge_search;

static int compare_edges(const void *x, const void *y)
{
    const edge *p = x, *q = y;
    if (p->a != q->a)
        return p->a < q->a ? -1 : 1;
    return p->b < q->b ? -1 : p->b > q->b;
}

static bool list_edges(edge_search *e)
{
    const cwi_inserter *w = e->w;
    size_t all = 0;
    e->edges = cwi_alloc_array(3 * w->list_count, sizeof *e->edges);
    if (!e->edges)
        return false;
    for (size_t n = 0; n < w->list_count; n++) {
        const uint32_t *c = w->solids->soup.triangles[w->list[n]];
        for (int k = 0; k < 3; k++) {
            const uint32_t a = c[k], b = c[(k + 1) % 3];
            if (a != b)
                e->edges[all++] = a < b ? (edge){a, b} : (edge){b, a};
        }
    }
    if (all)
        qsort(e->edges, all, sizeof *e->edges, compare_edges);
    for (size_t n = 0; n < all; n++)
        if (n == 0 || compare_edges(&e->edges[n - 1], &e->edges[n]) != 0)
            e->edges[e->count++] = e->edges[n];
    return true;
}

/* Boxes wider than the edges by the radius, and by what floats round away. */
static bool list_boxes(edge_search *e)
{
    e->boxes = cwi_alloc_array(e->count, sizeof *e->boxes);
    for (size_t n = 0; n < e->count && e->boxes; n++)
        for (int k = 0; k < 3; k++) {
            const double x = e->w->solids->soup.vertices[e->edges[n].a][k],
                         y = e->w->solids->soup.vertices[e->edges[n].b][k];
            e->boxes[n][k] = (float)(fmin(x, y) - 2 * e->w->radius);
            e->boxes[n][k + 3] = (float)(fmax(x, y) + 2 * e->w->radius);
        }
    return e->boxes;
}

/* Finds the points in which two edges are closest, as fractions of their lengths; false: at an end of one, or they
 * are parallel. */
static bool find_closest(const cwi_soup *s, const edge *p, const edge *q, double at[2])
{
    double d[2][3], between[3];
    cwi_sub(s->vertices[p->b], s->vertices[p->a], d[0]);
    cwi_sub(s->vertices[q->b], s->vertices[q->a], d[1]);
    cwi_sub(s->vertices[p->a], s->vertices[q->a], between);
    double normal[3], across[3];
    cwi_cross(d[0], d[1], normal);
    const double area_sq = cwi_dot(normal, normal);
    if (area_sq == 0)
        return false;
    cwi_cross(d[1], between, across);
    at[0] = cwi_dot(across, normal) / area_sq;
    cwi_cross(d[0], between, across);
    at[1] = cwi_dot(across, normal) / area_sq;
    return at[0] > 0 && at[0] < 1 && at[1] > 0 && at[1] < 1;
}

/* Returns the vertex at a place: one that is close, or a new one at floats of the file; CWI_NOTHING: no memory. */
static uint32_t make_vertex(cwi_inserter *w, const double x[3])
{
    cwi_soup *s = &w->solids->soup;
    const size_t v = s->vertex_count;
    const uint32_t found = cwi_anchors_find(w->anchors, x);
    if (found != CWI_NOTHING)
        return found;
    double(*vertices)[3] =
        cwi_grow_array(s->vertices, v, &w->vertex_capacity, sizeof *vertices);
    w->failed |= !vertices;
    if (!vertices)
        return CWI_NOTHING;
    s->vertices = vertices;
    for (int k = 0; k < 3; k++)
        s->vertices[v][k] =
            nearbyint((double)(float)(x[k] / w->solids->scale) * w->solids->scale) + 0.0;
    s->vertex_count++;
    w->failed |= !cwi_anchors_add(w->anchors, (uint32_t)v);
    return (uint32_t)v;
}

static void insert_into(cwi_inserter *w, const edge *e, uint32_t v, double at)
{
    const cwi_soup *s = &w->solids->soup;
    const double length_sq = cwi_distance_sq(s->vertices[e->a], s->vertices[e->b]),
                 least_sq = w->radius * w->radius,
                 from_a_sq = cwi_distance_sq(s->vertices[e->a], s->vertices[v]),
                 from_b_sq = cwi_distance_sq(s->vertices[e->b], s->vertices[v]);
    double off[3];
    if (from_a_sq >= length_sq || from_b_sq >= length_sq || from_a_sq < least_sq ||
        from_b_sq < least_sq)
        return;
    cwi_lerp(s->vertices[e->a], s->vertices[e->b], at, off);
    cwi_insertion_add(
        w, &w->edges,
        (cwi_insertion){e->a, e->b, v, fabs(at - 0.5), cwi_distance(off, s->vertices[v])});
}

static void test_edges(cwi_inserter *w, const edge *p, const edge *q)
{
    const cwi_soup *s = &w->solids->soup;
    double at[2], x[3], y[3];
    if (p->a == q->a || p->a == q->b || p->b == q->a || p->b == q->b ||
        !find_closest(s, p, q, at))
        return;
    cwi_lerp(s->vertices[p->a], s->vertices[p->b], at[0], x);
    cwi_lerp(s->vertices[q->a], s->vertices[q->b], at[1], y);
    if (cwi_distance(x, y) > w->radius)
        return;
    cwi_midpoint(x, y, x);
    const uint32_t v = make_vertex(w, x);
    if (v == CWI_NOTHING)
        return;
    insert_into(w, p, v, at[0]);
    insert_into(w, q, v, at[1]);
}

static bool visit_node(void *context, size_t node)
{
    edge_search *e = context;
    for (unsigned n = cwi_boxes_meeting(&e->tree.nodes[node], e->boxes[e->at]); n; n &= n - 1) {
        const uint32_t other = e->tree.order[node * CWI_WIDTH + (size_t)__builtin_ctz(n)];
        if (other > e->at)
            test_edges(e->w, &e->edges[e->at], &e->edges[other]);
    }
    return !e->w->failed;
}

cw_status cwi_find_close_edges(cwi_inserter *w, cw_error *err)
{
    edge_search e = {.w = w};
    const bool ready = list_edges(&e) && list_boxes(&e);
    cw_status st = ready ? cwi_boxes_build(&e.tree, (const float(*)[6])e.boxes, e.count, err)
                         : cwi_fail_memory(err);
    for (e.at = 0; e.at < e.count && st == CW_OK && !w->failed; e.at++)
        cwi_boxes_visit(&e.tree, e.boxes[e.at], 0, visit_node, &e);
    cwi_boxes_free(&e.tree);
    cwi_free(e.edges);
    cwi_free(e.boxes);
    return st == CW_OK && w->failed ? cwi_fail_memory(err) : st;
}
