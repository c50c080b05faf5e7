/* Vertices close to an edge or a facet of triangles that cross after rounding, made vertices of it: two sheets of
 * surface that are closer than floats can tell apart get the same vertices, and so the same edges.
 * After the snap rounding of [Devillers2018], in passes that insert one vertex into each edge at most. */
#include "simplify/boolean/snapping.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Bounds the passes: an edge with n vertices close by takes about log2 n. */
enum { MAX_PASSES = 16 };

/* A search of what is close to a vertex. */
typedef struct vertex_search {
    cwi_inserter *w;
    cwi_boxes tree; /* of the hot triangles */
    uint32_t vertex;
    float box[6]; /* around it */
} vertex_search;

static size_t count_all(const cwi_grid_solids *s)
{
    return s->soup.triangle_count + s->flat_count;
}

/* --- what is close ------------------------------------------------------------------------ */

void cwi_insertion_add(cwi_inserter *w, cwi_insertions *to, cwi_insertion row)
{
    cwi_insertion *rows = cwi_grow_array(to->rows, to->count, &to->capacity, sizeof *rows);
    w->failed |= !rows;
    if (!rows)
        return;
    to->rows = rows;
    to->rows[to->count++] = row;
}

/* Looks whether the vertex is close to an edge, and nearer to both ends than they are to each other. */
static bool note_edge(cwi_inserter *w, uint32_t v, uint32_t a, uint32_t b)
{
    const double *p = w->solids->soup.vertices[a], *q = w->solids->soup.vertices[b],
                 *x = w->solids->soup.vertices[v];
    double along[3], from[3], off[3];
    cwi_sub(q, p, along);
    cwi_sub(x, p, from);
    const double length_sq = cwi_dot(along, along), at = cwi_dot(from, along) / length_sq;
    if (!(at > 0 && at < 1))
        return false;
    cwi_lerp(p, q, at, off);
    const double distance = cwi_distance(x, off), least_sq = w->radius * w->radius,
                 from_p_sq = cwi_dot(from, from), from_q_sq = cwi_distance_sq(x, q);
    if (distance > w->radius)
        return false;
    if (from_p_sq >= length_sq || from_q_sq >= length_sq || from_p_sq < least_sq ||
        from_q_sq < least_sq)
        return true;
    cwi_insertion_add(
        w, &w->edges,
        (cwi_insertion){a < b ? a : b, a < b ? b : a, v, fabs(at - 0.5), distance});
    return true;
}

/* Looks whether the vertex is close to the inside of a triangle. */
static void note_facet(cwi_inserter *w, uint32_t v, uint32_t t)
{
    const uint32_t *c = w->solids->soup.triangles[t];
    const double *x = w->solids->soup.vertices[v];
    double edge[3][3], normal[3], lowest = INFINITY;
    for (int k = 0; k < 3; k++)
        cwi_sub(w->solids->soup.vertices[c[(k + 1) % 3]], w->solids->soup.vertices[c[k]],
                edge[k]);
    cwi_cross(edge[0], edge[1], normal);
    const double area_sq = cwi_dot(normal, normal);
    if (area_sq == 0)
        return;
    double from[3], across[3];
    for (int k = 0; k < 3; k++) {
        cwi_sub(x, w->solids->soup.vertices[c[k]], from);
        cwi_cross(edge[k], from, across);
        lowest = fmin(lowest, cwi_dot(across, normal) / area_sq);
    }
    const double distance = fabs(cwi_dot(from, normal)) / sqrt(area_sq);
    if (lowest > 0 && distance <= w->radius)
        cwi_insertion_add(w, &w->facets, (cwi_insertion){t, t, v, -lowest, distance});
}

static void note_triangle(cwi_inserter *w, uint32_t v, uint32_t t)
{
    const uint32_t *c = w->solids->soup.triangles[t];
    bool is_close = false;
    for (int k = 0; k < 3; k++)
        if (c[k] == v || c[k] == c[(k + 1) % 3])
            is_close = true; /* but nothing is to insert, only into the edge across */
    for (int k = 0; k < 3; k++)
        if (c[k] != v && c[(k + 1) % 3] != v && c[k] != c[(k + 1) % 3])
            is_close |= note_edge(w, v, c[k], c[(k + 1) % 3]);
    if (!is_close)
        note_facet(w, v, t);
}

static bool visit_node(void *context, size_t node)
{
    vertex_search *f = context;
    for (unsigned n = cwi_boxes_meeting(&f->tree.nodes[node], f->box); n; n &= n - 1)
        note_triangle(f->w, f->vertex,
                      f->w->list[f->tree.order[node * CWI_WIDTH + (size_t)__builtin_ctz(n)]]);
    return !f->w->failed;
}

static int compare_insertions(const void *x, const void *y)
{
    const cwi_insertion *p = x, *q = y;
    if (p->a != q->a)
        return p->a < q->a ? -1 : 1;
    if (p->b != q->b)
        return p->b < q->b ? -1 : 1;
    if (p->order != q->order)
        return p->order < q->order ? -1 : 1;
    return p->vertex < q->vertex ? -1 : p->vertex > q->vertex;
}

/* Keeps the first insertion into each edge or facet. */
static void choose_insertions(cwi_insertions *list)
{
    size_t n = 0;
    if (list->count)
        qsort(list->rows, list->count, sizeof *list->rows, compare_insertions);
    for (size_t i = 0; i < list->count; i++)
        if (n == 0 || list->rows[n - 1].a != list->rows[i].a ||
            list->rows[n - 1].b != list->rows[i].b)
            list->rows[n++] = list->rows[i];
    list->count = n;
}

static const cwi_insertion *find_insertion(const cwi_insertions *list, uint32_t a, uint32_t b)
{
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    size_t from = 0, to = list->count;
    while (from < to) {
        const size_t at = from + (to - from) / 2;
        const cwi_insertion *row = &list->rows[at];
        if (row->a == low && row->b == high)
            return row;
        if (row->a < low || (row->a == low && row->b < high))
            from = at + 1;
        else
            to = at;
    }
    return NULL;
}

/* Lists the hot triangles, and marks their vertices. */
static bool list_hot(cwi_inserter *w)
{
    w->list_count = 0;
    w->list = cwi_alloc_array(count_all(w->solids), sizeof *w->list);
    w->close = cwi_alloc_zeroed(w->solids->soup.vertex_count, sizeof *w->close);
    for (uint32_t t = 0; t < count_all(w->solids) && w->list && w->close; t++)
        if (w->hot[t]) {
            w->list[w->list_count++] = t;
            for (int k = 0; k < 3; k++)
                w->close[w->solids->soup.triangles[t][k]] = true;
        }
    return w->list && w->close;
}

static cw_status find_close_vertices(cwi_inserter *w, cw_error *err)
{
    const cwi_soup *s = &w->solids->soup;
    vertex_search f = {.w = w};
    cw_status st = cwi_soup_tree(s, w->list, w->list_count, &f.tree, err);
    for (f.vertex = 0; f.vertex < s->vertex_count && st == CW_OK && !w->failed; f.vertex++) {
        if (!w->close[f.vertex])
            continue;
        for (int k = 0; k < 3; k++) { /* wider by more than floats round away */
            f.box[k] = (float)(s->vertices[f.vertex][k] - 2 * w->radius);
            f.box[k + 3] = (float)(s->vertices[f.vertex][k] + 2 * w->radius);
        }
        cwi_boxes_visit(&f.tree, f.box, 0, visit_node, &f);
    }
    cwi_boxes_free(&f.tree);
    return st == CW_OK && w->failed ? cwi_fail_memory(err) : st;
}

/* Finds what is to insert in a pass: edges that pass each other count where no vertex is close any more. */
static cw_status find_insertions(cwi_inserter *w, cw_error *err)
{
    w->edges.count = w->facets.count = 0;
    cw_status st = list_hot(w) ? find_close_vertices(w, err) : cwi_fail_memory(err);
    if (st == CW_OK && w->edges.count + w->facets.count == 0 && w->edges_meet) {
        st = cwi_find_close_edges(w, err);
        w->edges_meet = false;
    }
    choose_insertions(&w->edges);
    choose_insertions(&w->facets);
    return st;
}

/* --- splitting ---------------------------------------------------------------------------- */

/* Splits a triangle whose edges from corner k on have a new vertex m[k], or none. Returns the number of
 * triangles; edges keep their direction, whatever vertices are equal. */
static int split_edges(const cwi_soup *s, const uint32_t c[3], const uint32_t m[3],
                       uint32_t out[4][3])
{
    int k = 0, n = 0;
    for (int i = 0; i < 3; i++)
        n += m[i] != CWI_NOTHING;
    if (n == 3) {
        const uint32_t parts[4][3] = {
            {c[0], m[0], m[2]}, {m[0], c[1], m[1]}, {m[1], c[2], m[2]}, {m[0], m[1], m[2]}};
        memcpy(out, parts, sizeof parts);
        return 4;
    }
    while (m[k] == CWI_NOTHING || (n == 2 && m[(k + 1) % 3] == CWI_NOTHING))
        k++;
    const uint32_t a = c[k], b = c[(k + 1) % 3], d = c[(k + 2) % 3], p = m[k],
                   q = m[(k + 1) % 3];
    if (n == 1) {
        const uint32_t parts[2][3] = {{a, p, d}, {p, b, d}};
        memcpy(out, parts, sizeof parts);
        return 2;
    }
    const bool short_first = cwi_distance_sq(s->vertices[a], s->vertices[q]) <
                             cwi_distance_sq(s->vertices[p], s->vertices[d]);
    const uint32_t parts[3][3] = {
        {p, b, q}, {a, p, short_first ? q : d}, {short_first ? a : p, q, d}};
    memcpy(out, parts, sizeof parts);
    return 3;
}

static bool grow_triangles(cwi_inserter *w, size_t count)
{
    cwi_grid_solids *s = w->solids;
    void *triangles = cwi_realloc_array(s->soup.triangles, count, sizeof *s->soup.triangles);
    s->soup.triangles = triangles ? triangles : s->soup.triangles;
    void *inputs = cwi_realloc_array(s->inputs, count, sizeof *s->inputs);
    s->inputs = inputs ? inputs : s->inputs;
    void *sources = cwi_realloc_array(s->sources, count, sizeof *s->sources);
    s->sources = sources ? sources : s->sources;
    void *hot = cwi_realloc_array(w->hot, count, sizeof *w->hot);
    w->hot = hot ? hot : w->hot;
    void *moved = s->moved ? cwi_realloc_array(s->moved, count, sizeof *s->moved) : NULL;
    const bool done = triangles && inputs && sources && hot && (moved || !s->moved);
    s->moved = moved ? moved : s->moved;
    return done;
}

/* Finds the parts of a triangle; returns their number, 0 where it stays whole. */
static int find_parts(const cwi_inserter *w, uint32_t t, uint32_t out[4][3], double *distance)
{
    const uint32_t *c = w->solids->soup.triangles[t];
    uint32_t m[3];
    bool any = false;
    for (int k = 0; k < 3; k++) {
        const uint32_t a = c[k], b = c[(k + 1) % 3];
        const cwi_insertion *found =
            w->close[a] && w->close[b] ? find_insertion(&w->edges, a, b) : NULL;
        m[k] = found ? found->vertex : CWI_NOTHING;
        any |= found != NULL;
        *distance = found ? fmax(*distance, found->distance) : *distance;
    }
    if (any)
        return split_edges(&w->solids->soup, c, m, out);
    const cwi_insertion *found = w->hot[t] ? find_insertion(&w->facets, t, t) : NULL;
    if (!found)
        return 0;
    for (int k = 0; k < 3; k++) {
        const uint32_t part[3] = {c[k], c[(k + 1) % 3], found->vertex};
        memcpy(out[k], part, sizeof part);
    }
    *distance = fmax(*distance, found->distance);
    return 3;
}

/* Splits all triangles at the insertions: the first part takes the place of the triangle. */
static cw_status split_all(cwi_inserter *w, double *distance, cw_error *err)
{
    cwi_grid_solids *s = w->solids;
    const size_t before = count_all(s);
    uint32_t parts[4][3];
    size_t count = before;
    for (uint32_t t = 0; t < before; t++) {
        const int n = find_parts(w, t, parts, distance);
        count += n ? (size_t)n - 1 : 0;
    }
    if (count >= INT32_MAX / 3)
        return cwi_fail(err, CW_ERR_LIMIT, "the meshes have more than 2^31 / 3 facets");
    if (!grow_triangles(w, count))
        return cwi_fail_memory(err);
    count = before;
    for (uint32_t t = 0; t < before; t++) {
        const int n = find_parts(w, t, parts, distance);
        for (int i = 0; i < n; i++) {
            if (i && cwi_triangle_is_collapsed(parts[i]))
                continue;
            const size_t to = i ? count++ : t;
            memcpy(s->soup.triangles[to], parts[i], sizeof parts[i]);
            s->inputs[to] = s->inputs[t];
            s->sources[to] = s->sources[t];
            w->hot[to] = w->hot[t] && !cwi_triangle_is_collapsed(parts[i]);
            if (s->moved)
                s->moved[to] = true;
        }
    }
    s->flat_count = count - s->soup.triangle_count;
    return CW_OK;
}

cw_status cwi_insert_vertices(cwi_grid_solids *s, cwi_anchors *anchors, bool **hot,
                              bool edges_meet, double *moved_mm, cw_error *err)
{
    cwi_inserter w = {.solids = s,
                      .anchors = anchors,
                      .hot = *hot,
                      .radius = anchors->radius,
                      .edges_meet = edges_meet,
                      .vertex_capacity = s->soup.vertex_count};
    double distance = 0;
    cw_status st = CW_OK;
    bool done = false;
    size_t before = SIZE_MAX;
    for (int pass = 0; pass < MAX_PASSES && st == CW_OK && !done; pass++) {
        const bool edges_met = !w.edges_meet;
        st = find_insertions(&w, err);
        const size_t count = w.edges.count + w.facets.count;
        if (edges_met || w.edges_meet) { /* else this pass was that of the edges */
            done =
                count >= before; /* vertices that are close to each other: it would not end */
            before = count;
        }
        done |= count == 0;
        if (st == CW_OK && count)
            st = split_all(&w, &distance, err);
        cwi_free(w.list);
        cwi_free(w.close);
    }
    *moved_mm = fmax(*moved_mm, distance / s->scale);
    cwi_free(w.edges.rows);
    cwi_free(w.facets.rows);
    *hot = w.hot;
    return st;
}
