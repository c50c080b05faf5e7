/* Sweeps over a mesh from below: each minimum of the height begins a set of vertices. Where two sets
 * meet, the one that began higher ends. The height between is its persistence. */
#include "simplify/printing/islands.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"

#include <stdlib.h>

typedef struct sweep {
    const cw_mesh *mesh;
    double bottom, layer;
    uint32_t *order; /* vertices by height, and those at one height by their number */
    uint32_t *rank;  /* of each vertex in the order */
    size_t *begin;   /* first lower neighbour of each vertex; vertices + 1 */
    uint32_t *lower; /* ranks of lower neighbours */
    uint32_t *set;   /* of each rank; the root is where the set began */
    cwi_islands *found;
} sweep;

static double height_of(const cw_mesh *mesh, uint32_t v)
{
    return (double)mesh->positions[3 * (size_t)v + 2];
}

typedef struct height {
    float z;
    uint32_t vertex;
} height;

static int compare_heights(const void *a, const void *b)
{
    const height *p = a, *q = b;
    return p->z != q->z ? (p->z < q->z ? -1 : 1) : p->vertex < q->vertex ? -1 : 1;
}

static cw_status alloc_sweep(sweep *s, cw_error *err)
{
    const size_t vertices = s->mesh->vertex_count, sides = 3 * s->mesh->triangle_count;
    s->order = cwi_alloc_array(vertices, sizeof *s->order);
    s->rank = cwi_alloc_array(vertices, sizeof *s->rank);
    s->begin = cwi_alloc_zeroed(vertices + 1, sizeof *s->begin);
    s->lower = cwi_alloc_array(sides, sizeof *s->lower);
    s->set = cwi_alloc_array(vertices, sizeof *s->set);
    return s->order && s->rank && s->begin && s->lower && s->set ? CW_OK : cwi_fail_memory(err);
}

static cw_status sort_vertices(sweep *s, cw_error *err)
{
    const size_t count = s->mesh->vertex_count;
    height *heights = cwi_alloc_array(count, sizeof *heights);
    if (!heights)
        return cwi_fail_memory(err);
    for (size_t v = 0; v < count; v++)
        heights[v] = (height){s->mesh->positions[3 * v + 2], (uint32_t)v};
    qsort(heights, count, sizeof *heights, compare_heights);
    for (size_t n = 0; n < count; n++) {
        s->order[n] = heights[n].vertex;
        s->rank[heights[n].vertex] = (uint32_t)n;
    }
    cwi_free(heights);
    return CW_OK;
}

/* Lists, for each vertex, the ranks of lower ones that it has an edge with. */
static void list_lower(sweep *s)
{
    const cw_mesh *mesh = s->mesh;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t side = 0; side < 3 * mesh->triangle_count; side++) {
            const uint32_t v = mesh->triangles[side],
                           w = mesh->triangles[cwi_corner_next((uint32_t)side)];
            const uint32_t a = s->rank[v], b = s->rank[w];
            const uint32_t high = a > b ? v : w, low_rank = a > b ? b : a;
            if (v == w)
                continue;
            if (pass == 0)
                s->begin[high + (size_t)1]++;
            else
                s->lower[s->begin[high]++] = low_rank;
        }
        if (pass == 0)
            for (size_t v = 0; v < mesh->vertex_count; v++)
                s->begin[v + 1] += s->begin[v];
        else /* each begin moved to that of the next */
            for (size_t v = mesh->vertex_count; v > 0; v--)
                s->begin[v] = s->begin[v - 1];
    }
    s->begin[0] = 0;
}

static uint32_t find_root(sweep *s, uint32_t rank)
{
    while (s->set[rank] != rank)
        rank = s->set[rank] = s->set[s->set[rank]];
    return rank;
}

/* Ends a set that began at a rank, and counts it if it is an island.
 * alone_mm    height over which it met nothing
 * faces_down  whether the surface does so where it began */
static void end_set(sweep *s, uint32_t rank, double alone_mm, const bool *faces_down)
{
    const uint32_t vertex = s->order[rank];
    if (!faces_down[vertex] || alone_mm < s->layer ||
        height_of(s->mesh, vertex) - s->bottom < s->layer)
        return;
    if (!s->found->count++ || alone_mm > s->found->height) {
        s->found->vertex = vertex;
        s->found->height = alone_mm;
    }
}

static void sweep_vertices(sweep *s, const bool *faces_down, const bool *is_used)
{
    for (uint32_t rank = 0; rank < s->mesh->vertex_count; rank++) {
        const uint32_t v = s->order[rank];
        s->set[rank] = rank;
        for (size_t n = s->begin[v]; n < s->begin[v + (size_t)1]; n++) {
            const uint32_t own = find_root(s, rank), other = find_root(s, s->lower[n]);
            const uint32_t later = own > other ? own : other,
                           sooner = own > other ? other : own;
            if (own == other)
                continue;
            if (later != rank)
                end_set(s, later, height_of(s->mesh, v) - height_of(s->mesh, s->order[later]),
                        faces_down);
            s->set[later] = sooner;
        }
    }
    for (uint32_t rank = 0; rank < s->mesh->vertex_count; rank++)
        if (s->set[rank] == rank && is_used[s->order[rank]])
            end_set(s, rank, INFINITY, faces_down);
}

/* Marks vertices whose area faces down in sum, and those that triangles use. */
static cw_status mark_vertices(const cw_mesh *mesh, bool *faces_down, bool *is_used,
                               cw_error *err)
{
    double *up = cwi_alloc_zeroed(mesh->vertex_count, sizeof *up);
    if (!up)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->triangles + 3 * t;
        double side[2][2];
        for (size_t c = 0; c < 2; c++)
            for (size_t a = 0; a < 2; a++)
                side[c][a] = (double)mesh->positions[3 * (size_t)v[c + 1] + a] -
                             (double)mesh->positions[3 * (size_t)v[0] + a];
        for (size_t c = 0; c < 3; c++) {
            up[v[c]] += side[0][0] * side[1][1] - side[0][1] * side[1][0];
            is_used[v[c]] = true;
        }
    }
    for (size_t v = 0; v < mesh->vertex_count; v++)
        faces_down[v] = up[v] < 0;
    cwi_free(up);
    return CW_OK;
}

cw_status cwi_find_islands(const cw_mesh *mesh, double bottom, double layer_mm,
                           cwi_islands *islands, cw_error *err)
{
    sweep s = {.mesh = mesh, .bottom = bottom, .layer = layer_mm, .found = islands};
    bool *faces_down = cwi_alloc_zeroed(mesh->vertex_count, sizeof *faces_down);
    bool *is_used = cwi_alloc_zeroed(mesh->vertex_count, sizeof *is_used);
    *islands = (cwi_islands){0};
    cw_status st = alloc_sweep(&s, err);
    if (st == CW_OK && !(faces_down && is_used))
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = sort_vertices(&s, err);
    if (st == CW_OK)
        st = mark_vertices(mesh, faces_down, is_used, err);
    if (st == CW_OK) {
        list_lower(&s);
        sweep_vertices(&s, faces_down, is_used);
    }
    cwi_free(faces_down);
    cwi_free(is_used);
    cwi_free(s.order);
    cwi_free(s.rank);
    cwi_free(s.begin);
    cwi_free(s.lower);
    cwi_free(s.set);
    return st;
}
