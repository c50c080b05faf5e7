/* Keeps the part of a mesh above a plane, and finds the edges of the section. The section runs through
 * vertices in the plane, but around those at which surfaces touch. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"
#include "simplify/cut/cut_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An edge from a vertex v in the plane to vertex w, of a kept triangle. */
typedef struct corner_edge {
    uint64_t key;  /* v << 32 | w */
    bool is_inner; /* w is above the plane */
    bool is_flat;  /* w is in the plane */
} corner_edge;

/* An edge with both ends in the plane, of a triangle that is kept or not. */
typedef struct flat_edge {
    uint64_t key; /* of the mesh: the lower vertex << 32 | the higher */
    cwi_cut_edge edge;
    bool is_kept;
} flat_edge;

/* The section passes around a vertex in the plane where its edges are as high as this number of
 * tolerances, and at most at this fraction of them. At one height edges of a vertex are apart as they are in
 * the mesh. */
static const double PARTED_TOLERANCES = 8, MAX_PARTED_FRACTION = 0.25;

typedef struct clip_work {
    cwi_cut *cut;
    uint64_t *crossings; /* edges that cross the plane, sorted: below and above */
    size_t crossing_count, crossing_capacity;
    corner_edge *corner_edges;
    size_t corner_count, corner_capacity;
    flat_edge *flat_edges;
    size_t flat_count, flat_capacity;
    uint32_t *numbers;       /* vertex_count: numbers in the result of those above the plane */
    uint32_t first_crossing; /* number of the first crossing in the result */
} clip_work;

bool cwi_cut_add_triangle(cwi_cut *c, uint32_t a, uint32_t b, uint32_t d)
{
    const uint32_t corners[3] = {a, b, d};
    void *grown =
        cwi_grow_array(c->triangles, c->triangle_count, &c->triangle_capacity, sizeof corners);
    if (!grown)
        return false;
    c->triangles = grown;
    grown =
        cwi_grow_array(c->parents, c->triangle_count, &c->parent_capacity, sizeof *c->parents);
    if (!grown)
        return false;
    c->parents = grown;
    c->parents[c->triangle_count] = c->parent;
    memcpy(c->triangles + 3 * c->triangle_count++, corners, sizeof corners);
    return true;
}

static bool add_source(cwi_cut *c, uint32_t a, uint32_t b, double t)
{
    void *grown =
        cwi_grow_array(c->sources, c->vertex_count, &c->vertex_capacity, sizeof *c->sources);
    if (!grown)
        return false;
    c->sources = grown;
    c->sources[c->vertex_count++] = (cwi_cut_source){a, b, t};
    return true;
}

static bool add_edge(cwi_cut *c, uint32_t start, uint32_t end)
{
    if (start == end) /* of a triangle that names a vertex twice */
        return true;
    void *grown = cwi_grow_array(c->edges, c->edge_count, &c->edge_capacity, sizeof *c->edges);
    if (!grown)
        return false;
    c->edges = grown;
    c->edges[c->edge_count++] = (cwi_cut_edge){start, end};
    return true;
}

static int compare_keys(const void *a, const void *b)
{
    const uint64_t s = *(const uint64_t *)a, t = *(const uint64_t *)b;
    return s < t ? -1 : s > t;
}

/* Orders kept ones first. */
static int compare_flat_edges(const void *a, const void *b)
{
    const flat_edge *s = a, *t = b;
    const int order = compare_keys(&s->key, &t->key);
    return order ? order : (s->is_kept < t->is_kept) - (s->is_kept > t->is_kept);
}

static bool is_kept(const cwi_cut *c, const uint32_t *corners)
{
    return c->side[corners[0]] > 0 || c->side[corners[1]] > 0 || c->side[corners[2]] > 0;
}

/* --- vertices at which surfaces touch ----------------------------------------------------- */

static bool gather_corner_edges(clip_work *w)
{
    const cwi_cut *c = w->cut;
    w->corner_count = 0;
    for (size_t t = 0; t < c->mesh->triangle_count; t++) {
        const uint32_t *corners = c->mesh->triangles + 3 * t;
        if (!is_kept(c, corners))
            continue;
        for (int n = 0; n < 6; n++) {
            const uint32_t v = corners[n / 2], end = corners[(n / 2 + 1 + n % 2) % 3];
            if (c->side[v] != CWI_CUT_ON)
                continue;
            void *grown = cwi_grow_array(w->corner_edges, w->corner_count, &w->corner_capacity,
                                         sizeof *w->corner_edges);
            if (!grown)
                return false;
            w->corner_edges = grown;
            w->corner_edges[w->corner_count++] =
                (corner_edge){(uint64_t)v << 32 | end, c->side[end] == CWI_CUT_ABOVE,
                              c->side[end] == CWI_CUT_ON};
        }
    }
    return true;
}

/* Lets vertices in the plane count as below it, unless their kept triangles are one fan between two
 * edges of the section. Those that would have to move there stay on their side instead. Returns true if
 * there were some. */
static bool part_vertices(clip_work *w)
{
    const corner_edge *e = w->corner_edges;
    bool has_parted = false;
    if (w->corner_count)
        qsort(w->corner_edges, w->corner_count, sizeof *e, compare_keys);
    for (size_t n = 0, end; n < w->corner_count; n = end) {
        const uint64_t v = e[n].key >> 32;
        size_t ends = 0;
        bool touches = false;
        for (end = n; end < w->corner_count && e[end].key >> 32 == v; end++) {
            const bool has_twin = (end > n && e[end - 1].key == e[end].key) ||
                                  (end + 1 < w->corner_count && e[end + 1].key == e[end].key);
            ends += !e[end].is_inner || !has_twin;
            touches = touches || (e[end].is_flat && has_twin);
        }
        if (ends == 2 && !touches)
            continue;
        w->cut->side[v] =
            cwi_cut_distance(w->cut, v) > w->cut->tolerance ? CWI_CUT_ABOVE : CWI_CUT_BELOW;
        has_parted = true;
    }
    return has_parted;
}

/* Parts surfaces that touch in the plane: at a vertex of several fans, or of one all around it, or along
 * an edge. The section passes around such a vertex. That may leave others of the same kind. */
static bool part_touching(clip_work *w)
{
    do {
        if (!gather_corner_edges(w))
            return false;
    } while (part_vertices(w));
    return true;
}

/* --- numbers of vertices ------------------------------------------------------------------ */

/* Gathers edges that cross the plane, and marks vertices of kept triangles. */
static bool gather_crossings(clip_work *w)
{
    const cwi_cut *c = w->cut;
    for (size_t t = 0; t < c->mesh->triangle_count; t++) {
        const uint32_t *corners = c->mesh->triangles + 3 * t;
        for (int k = 0; k < 3 && is_kept(c, corners); k++) {
            const uint32_t v = corners[k], next = corners[(k + 1) % 3];
            w->numbers[v] = 0;
            if (c->side[v] * c->side[next] >= 0)
                continue;
            void *grown = cwi_grow_array(w->crossings, w->crossing_count, &w->crossing_capacity,
                                         sizeof *w->crossings);
            if (!grown)
                return false;
            w->crossings = grown;
            w->crossings[w->crossing_count++] = cwi_edge_key(v, next);
        }
    }
    return true;
}

/* Numbers the vertices that are kept, in their order. */
static bool number_kept(clip_work *w)
{
    cwi_cut *c = w->cut;
    for (uint32_t v = 0; v < c->mesh->vertex_count; v++) {
        if (w->numbers[v] != 0 || c->side[v] == CWI_CUT_BELOW)
            continue;
        w->numbers[v] = (uint32_t)c->vertex_count;
        if (!add_source(c, v, v, 0))
            return false;
    }
    return true;
}

/* Returns where an edge crosses the plane. It leaves a vertex that is in the plane, but counts as
 * below, where it is a little above. */
static double find_fraction(const cwi_cut *c, uint32_t a, uint32_t b)
{
    const double from = cwi_cut_distance(c, a), to = cwi_cut_distance(c, b);
    if (fabs(from) > c->tolerance && fabs(to) > c->tolerance)
        return from / (from - to);
    const double low = fmin(from, to), rise = fmax(from, to) - low;
    const double part =
        fmax(0, fmin(MAX_PARTED_FRACTION, (PARTED_TOLERANCES * c->tolerance - low) / rise));
    return fabs(from) <= c->tolerance ? part : 1 - part;
}

/* Numbers each edge that crosses the plane once. */
static bool number_crossings(clip_work *w)
{
    cwi_cut *c = w->cut;
    size_t count = 0;
    w->first_crossing = (uint32_t)c->vertex_count;
    if (w->crossing_count)
        qsort(w->crossings, w->crossing_count, sizeof *w->crossings, compare_keys);
    for (size_t n = 0; n < w->crossing_count; n++) {
        if (n > 0 && w->crossings[n] == w->crossings[count - 1])
            continue;
        const uint32_t a = (uint32_t)(w->crossings[n] >> 32), b = (uint32_t)w->crossings[n];
        w->crossings[count++] = w->crossings[n];
        if (!add_source(c, a, b, find_fraction(c, a, b)))
            return false;
    }
    w->crossing_count = count;
    return true;
}

/* --- triangles ---------------------------------------------------------------------------- */

static uint32_t find_crossing(const clip_work *w, uint32_t a, uint32_t b)
{
    const uint64_t key = cwi_edge_key(a, b);
    const uint64_t *found =
        bsearch(&key, w->crossings, w->crossing_count, sizeof key, compare_keys);
    return w->first_crossing + (uint32_t)(found - w->crossings);
}

/* Adds the kept part of a triangle, of three or four corners. A part of four is divided along its
 * shorter diagonal.
 * numbers  of its corners that are not below the plane */
static bool clip_triangle(clip_work *w, const uint32_t *corners, const uint32_t *numbers)
{
    cwi_cut *c = w->cut;
    uint32_t part[4];
    int count = 0;
    for (int k = 0; k < 3; k++) {
        const uint32_t v = corners[k], next = corners[(k + 1) % 3];
        if (c->side[v] >= 0)
            part[count++] = numbers[k];
        if (c->side[v] * c->side[next] < 0)
            part[count++] = find_crossing(w, v, next);
    }
    for (int k = 0; k < count; k++)
        if (c->is_section[part[k]] && c->is_section[part[(k + 1) % count]])
            if (!add_edge(c, part[k], part[(k + 1) % count]))
                return false;
    c->facts.cut_triangles++;
    if (count == 3)
        return cwi_cut_add_triangle(c, part[0], part[1], part[2]);
    const bool turns = cwi_point_distance_sq(c->positions + 3 * (size_t)part[1],
                                             c->positions + 3 * (size_t)part[3]) <
                       cwi_point_distance_sq(c->positions + 3 * (size_t)part[0],
                                             c->positions + 3 * (size_t)part[2]);
    const int f = turns ? 1 : 0;
    return cwi_cut_add_triangle(c, part[f], part[f + 1], part[f + 2]) &&
           cwi_cut_add_triangle(c, part[f], part[f + 2], part[(f + 3) % 4]);
}

static bool add_flat_edges(clip_work *w, const uint32_t *corners, const uint32_t *numbers,
                           bool is_kept_one)
{
    const cwi_cut *c = w->cut;
    for (int k = 0; k < 3; k++) {
        const int next = (k + 1) % 3;
        if (c->side[corners[k]] != CWI_CUT_ON || c->side[corners[next]] != CWI_CUT_ON)
            continue;
        void *grown = cwi_grow_array(w->flat_edges, w->flat_count, &w->flat_capacity,
                                     sizeof *w->flat_edges);
        if (!grown)
            return false;
        w->flat_edges = grown;
        w->flat_edges[w->flat_count++] = (flat_edge){
            cwi_edge_key(corners[k], corners[next]), {numbers[k], numbers[next]}, is_kept_one};
    }
    return true;
}

static bool clip_triangles(clip_work *w)
{
    cwi_cut *c = w->cut;
    const cw_mesh *m = c->mesh;
    for (size_t t = 0; t < m->triangle_count; t++) {
        const uint32_t *corners = m->triangles + 3 * t;
        uint32_t numbers[3];
        bool below = false, ok = true;
        const bool kept = is_kept(c, corners);
        for (int k = 0; k < 3; k++) {
            below = below || c->side[corners[k]] < 0;
            numbers[k] = w->numbers[corners[k]];
        }
        c->facts.dropped_triangles += !kept;
        c->parent = (uint32_t)t;
        if (!add_flat_edges(w, corners, numbers, kept))
            return false;
        if (kept)
            ok = below ? clip_triangle(w, corners, numbers)
                       : cwi_cut_add_triangle(c, numbers[0], numbers[1], numbers[2]);
        if (!ok)
            return false;
    }
    c->parent = UINT32_MAX;
    return true;
}

/* Finds edges in the plane of one kept triangle, and of others that are not kept. An edge of one
 * triangle alone is an open edge of the mesh. */
static bool find_flat_edges(clip_work *w)
{
    flat_edge *e = w->flat_edges;
    if (w->flat_count)
        qsort(e, w->flat_count, sizeof *e, compare_flat_edges);
    for (size_t n = 0, end; n < w->flat_count; n = end) {
        for (end = n + 1; end < w->flat_count && e[end].key == e[n].key; end++)
            ;
        const bool is_end = e[n].is_kept && end > n + 1 && !e[n + 1].is_kept;
        if (is_end && !add_edge(w->cut, e[n].edge.start, e[n].edge.end))
            return false;
    }
    return true;
}

cw_status cwi_cut_clip(cwi_cut *c, cw_error *err)
{
    clip_work w = {.cut = c};
    const size_t vertices = c->mesh->vertex_count;
    cw_status st = cwi_progress(&c->desc.progress, "cut", 0.1, err);
    bool ok = true;
    w.numbers = cwi_alloc_array(vertices, sizeof *w.numbers);
    if (w.numbers)
        memset(w.numbers, 0xff, vertices * sizeof *w.numbers);
    if (st == CW_OK)
        ok = w.numbers && part_touching(&w) && gather_crossings(&w) && number_kept(&w);
    if (st == CW_OK && ok)
        st = cwi_progress(&c->desc.progress, "cut", 0.3, err);
    if (st == CW_OK && ok)
        ok = number_crossings(&w) && cwi_cut_place_vertices(c) && clip_triangles(&w) &&
             find_flat_edges(&w);
    if (st == CW_OK && !ok)
        st = cwi_fail_memory(err);
    if (st == CW_OK && c->vertex_count >= UINT32_MAX)
        st = cwi_fail(err, CW_ERR_LIMIT, "the cut mesh has more than %u vertices", UINT32_MAX);
    cwi_free(w.crossings);
    cwi_free(w.corner_edges);
    cwi_free(w.flat_edges);
    cwi_free(w.numbers);
    return st;
}
