/* Gives each fan of triangles a vertex of its own, and moves vertices apart that are at one place. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "core/mesh/weld.h"
#include "simplify/repair/repair_state.h"

#include <math.h>
#include <string.h>

/* How far parted vertices move: this fraction of their shortest edge, but at least as many steps of
 * single precision, and never more than a quarter of the edge. */
static const double PART_FRACTION = 1e-3, PART_STEPS = 8, PART_MAX = 0.25;

/* Directions shorter than this fraction of the edge do not tell where to go. */
static const double FLAT = 1e-3;

cw_status cwi_repair_append(cwi_repair *r, const float *positions, size_t vertices,
                            const uint32_t *triangles, size_t triangle_count, cw_error *err)
{
    cw_mesh *m = &r->mesh;
    const size_t all = m->vertex_count + vertices,
                 all_triangles = m->triangle_count + triangle_count;
    if (all >= UINT32_MAX || all_triangles > CWI_MAX_TRIANGLES)
        return cwi_fail(err, CW_ERR_LIMIT, "the repaired mesh has more than %zu triangles",
                        CWI_MAX_TRIANGLES);
    float *points = cwi_realloc_array(m->positions, all, 3 * sizeof *points);
    m->positions = points ? points : m->positions;
    uint32_t *source = cwi_realloc_array(m->labels, all, sizeof *source);
    m->labels = source ? source : m->labels;
    uint8_t *flags = cwi_realloc_array(m->colors, all, 4);
    m->colors = flags ? flags : m->colors;
    uint32_t *corners = cwi_realloc_array(m->triangles, all_triangles, 3 * sizeof *corners);
    m->triangles = corners ? corners : m->triangles;
    uint32_t *parents = cwi_realloc_array(m->attributes->data, all_triangles, sizeof *parents);
    m->attributes->data = parents ? parents : m->attributes->data;
    if (!points || !source || !flags || !corners || !parents)
        return cwi_fail_memory(err);
    if (vertices) {
        memcpy(points + 3 * m->vertex_count, positions, 3 * vertices * sizeof *points);
        memset(source + m->vertex_count, 0xff, vertices * sizeof *source);
        memset(flags + 4 * m->vertex_count, 0, 4 * vertices);
    }
    if (triangle_count) {
        memcpy(corners + 3 * m->triangle_count, triangles,
               3 * triangle_count * sizeof *corners);
        memset(parents + m->triangle_count, 0xff, triangle_count * sizeof *parents);
    }
    m->vertex_count = all;
    m->triangle_count = all_triangles;
    return CW_OK;
}

/* --- fans --------------------------------------------------------------------------------- */

/* Joins the corners of triangles beside each other: a set is a fan around a vertex. */
static void join_fans(const cwi_repair *r, uint32_t *fan)
{
    const uint32_t corners = (uint32_t)(3 * r->mesh.triangle_count);
    for (uint32_t c = 0; c < corners; c++) {
        const uint32_t other = r->twin[c];
        if (other == CWI_NO_CORNER || other < c)
            continue;
        cwi_sets_join(fan, c, cwi_corner_next(other));
        cwi_sets_join(fan, cwi_corner_next(c), other);
    }
}

/* Copies the vertices of all fans but the first. */
static cw_status copy_vertices(cwi_repair *r, uint32_t *fan, size_t *copies, cw_error *err)
{
    cw_mesh *m = &r->mesh;
    const size_t corners = 3 * m->triangle_count, before = m->vertex_count;
    uint32_t *owner = cwi_alloc_array(before, sizeof *owner); /* the fan that keeps a vertex */
    uint32_t *copied = NULL;                                  /* the vertices that are copied */
    size_t count = 0;
    if (!owner)
        return cwi_fail_memory(err);
    memset(owner, 0xff, before * sizeof *owner);
    for (uint32_t c = 0; c < corners; c++)
        if (fan[c] == c) { /* the lowest corner names the fan */
            const uint32_t v = m->triangles[c];
            count += owner[v] != UINT32_MAX;
            owner[v] = owner[v] == UINT32_MAX ? c : owner[v];
        }
    copied = cwi_alloc_array(count, sizeof *copied);
    float *points = cwi_alloc_array(count, 3 * sizeof *points);
    cw_status st = copied && points ? CW_OK : cwi_fail_memory(err);
    size_t n = 0;
    for (uint32_t c = 0; c < corners && st == CW_OK; c++) {
        const uint32_t root = cwi_sets_find(fan, c), v = m->triangles[root];
        if (root == c && owner[v] != c) {
            memcpy(points + 3 * n, m->positions + 3 * (size_t)v, 3 * sizeof *points);
            copied[n] = v;
            m->triangles[c] = (uint32_t)(before + n++);
        } else {
            m->triangles[c] = m->triangles[root]; /* done before: roots come first */
        }
    }
    if (st == CW_OK)
        st = cwi_repair_append(r, points, count, NULL, 0, err);
    for (size_t k = 0; k < count && st == CW_OK; k++)
        m->labels[before + k] = m->labels[copied[k]];
    *copies += count;
    cwi_free(owner);
    cwi_free(copied);
    cwi_free(points);
    return st;
}

static cw_status split_fans(cwi_repair *r, size_t *copies, cw_error *err)
{
    uint32_t *fan = cwi_sets_alloc(3 * r->mesh.triangle_count);
    if (!fan)
        return cwi_fail_memory(err);
    join_fans(r, fan);
    for (uint32_t c = 0; c < 3 * r->mesh.triangle_count; c++)
        fan[c] = cwi_sets_find(fan, c);
    cw_status st = copy_vertices(r, fan, copies, err);
    cwi_free(fan);
    return st;
}

/* --- edges that two pairs of triangles still share ---------------------------------------- */

/* Lists an edge for each pair of triangles, and for each open one. */
static size_t list_edges(const cwi_repair *r, cwi_side *edges)
{
    const uint32_t *v = r->mesh.triangles;
    size_t count = 0;
    for (uint32_t c = 0; c < 3 * r->mesh.triangle_count; c++) {
        if (r->twin[c] == CWI_NO_CORNER || c < r->twin[c])
            edges[count++] = (cwi_side){cwi_edge_key(v[c], v[cwi_corner_next(c)]), c};
    }
    cwi_sides_sort(edges, count);
    return count;
}

/* Divides the triangles on both sides of an edge at its middle. The new vertex is `middle`.
 * parents  triangles that those added are parts of */
static size_t divide_sides(cwi_repair *r, uint32_t corner, uint32_t middle, uint32_t *added,
                           uint32_t *parents)
{
    const uint32_t sides[2] = {corner, r->twin[corner]};
    size_t count = 0;
    for (int n = 0; n < 2; n++) {
        if (sides[n] == CWI_NO_CORNER)
            continue;
        const uint32_t next = cwi_corner_next(sides[n]), last = cwi_corner_next(next);
        uint32_t *v = r->mesh.triangles, *to = added + 3 * count;
        parents[count++] = sides[n] / 3;
        to[0] = middle;
        to[1] = v[next];
        to[2] = v[last];
        v[next] = middle;
    }
    return count;
}

/* Divides edges that more than one pair of triangles share; of each triangle one edge at a time. */
static cw_status divide_shared_edges(cwi_repair *r, size_t *divided, cw_error *err)
{
    cw_mesh *m = &r->mesh;
    const size_t corners = 3 * m->triangle_count;
    cwi_side *edges = cwi_alloc_array(corners, sizeof *edges);
    bool *is_used = cwi_alloc_zeroed(m->triangle_count, sizeof *is_used);
    float *points = NULL;
    uint32_t *added = NULL, *parents = NULL;
    size_t shared = 0, vertices = 0, triangles = 0;
    const size_t count = edges && is_used ? list_edges(r, edges) : 0;
    for (size_t n = 0; n < count; n++)
        shared += (n > 0 && edges[n].key == edges[n - 1].key) ||
                  (n + 1 < count && edges[n].key == edges[n + 1].key);
    points = cwi_alloc_array(shared, 3 * sizeof *points);
    added = cwi_alloc_array(shared, 6 * sizeof *added);
    parents = cwi_alloc_array(shared, 2 * sizeof *parents);
    cw_status st =
        edges && is_used && points && added && parents ? CW_OK : cwi_fail_memory(err);
    for (size_t n = 0; n < count && st == CW_OK && shared; n++) {
        const uint32_t corner = edges[n].corner, other = r->twin[corner];
        const bool is_shared = (n > 0 && edges[n].key == edges[n - 1].key) ||
                               (n + 1 < count && edges[n].key == edges[n + 1].key);
        if (!is_shared || is_used[corner / 3] || (other != CWI_NO_CORNER && is_used[other / 3]))
            continue;
        const float *p = m->positions + 3 * (edges[n].key >> 32),
                    *q = m->positions + 3 * (edges[n].key & UINT32_MAX);
        for (int a = 0; a < 3; a++)
            points[3 * vertices + (size_t)a] = (float)(((double)p[a] + (double)q[a]) / 2);
        is_used[corner / 3] = true;
        if (other != CWI_NO_CORNER)
            is_used[other / 3] = true;
        triangles += divide_sides(r, corner, (uint32_t)(m->vertex_count + vertices),
                                  added + 3 * triangles, parents + triangles);
        vertices++;
    }
    if (st == CW_OK && vertices)
        st = cwi_repair_append(r, points, vertices, added, triangles, err);
    uint32_t *source = m->attributes->data;
    for (size_t n = 0; n < triangles && st == CW_OK; n++)
        source[m->triangle_count - triangles + n] = source[parents[n]];
    *divided = vertices;
    cwi_free(edges);
    cwi_free(is_used);
    cwi_free(points);
    cwi_free(added);
    cwi_free(parents);
    return st;
}

/* --- vertices at one place ---------------------------------------------------------------- */

/* Sums of the neighbours of a vertex, relative to it, and the shortest edge. */
typedef struct surroundings {
    double sum[3], shortest_sq;
    uint32_t count;
} surroundings;

static void add_neighbour(const float *p, const float *q, surroundings *s)
{
    double d[3];
    for (int a = 0; a < 3; a++) {
        d[a] = (double)q[a] - (double)p[a];
        s->sum[a] += d[a];
    }
    s->count++;
    s->shortest_sq = fmin(s->shortest_sq, cwi_dot(d, d));
}

/* Moves a vertex toward the mean of its neighbours; returns how far. */
static double move_inward(float *p, const surroundings *s)
{
    const double shortest = sqrt(s->shortest_sq);
    double largest = 0, length = 0, direction[3], moved[3];
    if (!s->count)
        return 0;
    for (int a = 0; a < 3; a++) {
        direction[a] = s->sum[a] / s->count;
        largest = fmax(largest, fabs((double)p[a]));
    }
    length = cwi_length(direction);
    if (!(length > FLAT * shortest) || !cwi_normalise(direction))
        return 0;
    const double step = fmin(fmax(PART_FRACTION * shortest, PART_STEPS * largest * 0x1p-24),
                             PART_MAX * shortest);
    for (int a = 0; a < 3; a++) {
        const double before = (double)p[a];
        p[a] = (float)(before + step * direction[a]);
        moved[a] = (double)p[a] - before;
    }
    return cwi_length(moved);
}

cw_status cwi_part_vertices(cwi_repair *r, bool *moved, cw_error *err)
{
    cw_mesh *m = &r->mesh;
    uint32_t *map = cwi_alloc_array(m->vertex_count, sizeof *map);
    bool *shares = cwi_alloc_zeroed(m->vertex_count, sizeof *shares);
    *moved = false;
    surroundings *around = cwi_alloc_zeroed(m->vertex_count, sizeof *around);
    cw_status st = map && shares && around && cwi_weld(m->positions, m->vertex_count, map)
                       ? CW_OK
                       : cwi_fail_memory(err);
    for (size_t v = 0; v < m->vertex_count && st == CW_OK; v++) {
        around[v].shortest_sq = INFINITY;
        if (map[v] != v)
            shares[v] = shares[map[v]] = *moved = true;
    }
    for (uint32_t c = 0; c < 3 * m->triangle_count && st == CW_OK && *moved; c++) {
        const uint32_t v = m->triangles[c], next = m->triangles[cwi_corner_next(c)];
        if (shares[v])
            add_neighbour(m->positions + 3 * (size_t)v, m->positions + 3 * (size_t)next,
                          &around[v]);
        if (shares[next]) /* twice, as are those of closed fans */
            add_neighbour(m->positions + 3 * (size_t)next, m->positions + 3 * (size_t)v,
                          &around[next]);
    }
    for (size_t v = 0; v < m->vertex_count && st == CW_OK; v++)
        if (shares[v])
            r->facts.parted_mm =
                fmax(r->facts.parted_mm, move_inward(m->positions + 3 * v, &around[v]));
    cwi_free(map);
    cwi_free(shares);
    cwi_free(around);
    return st;
}

cw_status cwi_repair_split(cwi_repair *r, cw_error *err)
{
    size_t copies = 0, divided = 0;
    cw_status st = split_fans(r, &copies, err);
    if (st == CW_OK)
        st = divide_shared_edges(r, &divided, err);
    while (st == CW_OK && divided) {
        copies += divided;
        st = cwi_repair_link(r, false, err);
        if (st == CW_OK)
            st = split_fans(r, &copies, err);
        if (st == CW_OK)
            st = divide_shared_edges(r, &divided, err);
    }
    if (!r->is_later)
        r->facts.nonmanifold_vertices += copies;
    return st;
}
