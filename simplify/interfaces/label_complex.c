/* Builds the complex of label interfaces, tests the link condition, and collapses edges. */
#include "simplify/interfaces/label_complex.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <string.h>

/* ---- rings ------------------------------------------------------------------------------ */

/* Adds one triangle at the edge to a neighbour. balance: 1 if it runs away from the vertex */
static void add_neighbour(cwi_ring *ring, uint32_t vertex, uint32_t edge, int balance)
{
    size_t n = 0;
    while (n < ring->neighbour_count && ring->neighbours[n].vertex != vertex)
        n++;
    if (n == ring->neighbour_count)
        ring->neighbours[ring->neighbour_count++] = (cwi_neighbour){vertex, edge, 0, 0};
    ring->neighbours[n].triangles++;
    ring->neighbours[n].balance += balance;
}

bool cwi_ring_gather(const cwi_complex *c, uint32_t vertex, cwi_ring *ring)
{
    ring->triangle_count = ring->neighbour_count = 0;
    for (uint32_t at = c->heads[vertex]; at != CWI_NO_INDEX; at = c->next[at]) {
        const uint32_t triangle = at / 3, second = at % 3 < 2 ? at + 1 : at - 2,
                       third = second % 3 < 2 ? second + 1 : second - 2;
        if (ring->triangle_count == CWI_RING_TRIANGLES)
            return false;
        const cwi_ring_triangle moved = {triangle, c->corners[second], c->corners[third]};
        ring->triangles[ring->triangle_count++] = moved;
        add_neighbour(ring, moved.a, c->sides[third], 1);
        add_neighbour(ring, moved.b, c->sides[second], -1);
    }
    return true;
}

const cwi_neighbour *cwi_ring_find(const cwi_ring *ring, uint32_t vertex)
{
    for (size_t n = 0; n < ring->neighbour_count; n++)
        if (ring->neighbours[n].vertex == vertex)
            return &ring->neighbours[n];
    return NULL;
}

/* ---- building --------------------------------------------------------------------------- */

static bool alloc_triangles(cwi_complex *c)
{
    c->corners = cwi_alloc_array(3 * c->triangle_count, sizeof *c->corners);
    c->patches = cwi_alloc_array(c->triangle_count, sizeof *c->patches);
    c->next = cwi_alloc_array(3 * c->triangle_count, sizeof *c->next);
    c->sides = cwi_alloc_array(3 * c->triangle_count, sizeof *c->sides);
    c->points = cwi_alloc_array(3 * c->vertex_count, sizeof *c->points);
    c->heads = cwi_alloc_array(c->vertex_count, sizeof *c->heads);
    c->orders = cwi_alloc_zeroed(c->vertex_count, sizeof *c->orders);
    return c->corners && c->patches && c->next && c->sides && c->points && c->heads &&
           c->orders;
}

static bool alloc_edges(cwi_complex *c)
{
    c->ends = cwi_alloc_array(c->edge_count, sizeof *c->ends);
    c->is_curve = cwi_alloc_zeroed(c->edge_count, sizeof *c->is_curve);
    return c->ends && c->is_curve;
}

static void copy_surfaces(cwi_complex *c, const cw_label_surfaces *s, double scale)
{
    for (size_t i = 0; i < 3 * c->vertex_count; i++)
        c->points[i] = (float)(scale * (double)s->mesh.positions[i]);
    for (size_t p = 0; p < s->patch_count; p++)
        for (size_t t = 0; t < s->patches[p].count; t++)
            c->patches[s->patches[p].first + t] = (uint32_t)p;
    if (c->triangle_count > 0)
        memcpy(c->corners, s->mesh.triangles, 3 * c->triangle_count * sizeof *c->corners);
    memset(c->heads, 0xff, c->vertex_count * sizeof *c->heads);
    for (size_t i = 3 * c->triangle_count; i-- > 0;) {
        c->next[i] = c->heads[c->corners[i]];
        c->heads[c->corners[i]] = (uint32_t)i;
    }
}

/* Gives the edges from a vertex to higher ones their numbers, after those of lower vertices.
 * seen   vertex_count: the last vertex from which this one was met, plus 1
 * edges  vertex_count: the edge from there */
static void number_edges_of(cwi_complex *c, uint32_t vertex, uint32_t *seen, uint32_t *edges)
{
    for (uint32_t at = c->heads[vertex]; at != CWI_NO_INDEX; at = c->next[at])
        for (uint32_t k = 1; k < 3; k++) {
            const uint32_t first = at - at % 3, other = c->corners[first + (at + k) % 3];
            if (other < vertex)
                continue;
            if (seen[other] != vertex + 1) {
                seen[other] = vertex + 1;
                edges[other] = (uint32_t)c->edge_count++;
            }
            c->sides[first + (at + 3 - k) % 3] = edges[other];
        }
}

/* Numbers all edges. `at + k` counts corners modulo 3, as the first corner of a triangle is a
 * multiple of 3. */
static bool number_edges(cwi_complex *c)
{
    uint32_t *seen = cwi_alloc_zeroed(c->vertex_count, sizeof *seen);
    uint32_t *edges = cwi_alloc_array(c->vertex_count, sizeof *edges);
    const bool has_memory = seen && edges;
    for (size_t v = 0; v < c->vertex_count && has_memory; v++)
        number_edges_of(c, (uint32_t)v, seen, edges);
    cwi_free(seen);
    cwi_free(edges);
    return has_memory;
}

/* Sets the ends of edges, and marks those that are not inside of one patch: first each edge
 * counts its triangles, and those that run against it. */
static bool find_curves(cwi_complex *c)
{
    typedef struct edge_use {
        uint32_t triangles, reversed, patch;
        bool is_mixed;
    } edge_use;
    edge_use *uses = cwi_alloc_zeroed(c->edge_count, sizeof *uses);
    if (!uses)
        return false;
    for (size_t i = 0; i < 3 * c->triangle_count; i++) {
        const size_t first = i - i % 3;
        const uint32_t a = c->corners[first + (i + 1) % 3], b = c->corners[first + (i + 2) % 3],
                       patch = c->patches[i / 3];
        edge_use *use = &uses[c->sides[i]];
        c->ends[c->sides[i]][0] = a < b ? a : b;
        c->ends[c->sides[i]][1] = a < b ? b : a;
        use->is_mixed |= use->triangles > 0 && use->patch != patch;
        use->patch = patch;
        use->triangles++;
        use->reversed += a > b;
    }
    for (size_t e = 0; e < c->edge_count; e++)
        c->is_curve[e] = uses[e].triangles != 2 || uses[e].reversed != 1 || uses[e].is_mixed;
    cwi_free(uses);
    return true;
}

/* ---- orders ----------------------------------------------------------------------------- */

static uint32_t find_root(uint32_t *parents, uint32_t n)
{
    while (parents[n] != n)
        n = parents[n] = parents[parents[n]];
    return n;
}

/* Counts the sectors of a ring: sets of triangles joined by edges inside of patches. Sets
 * *are_spanning if each of them joins both of the curve's edges.
 * curve  the neighbours along the curve; CWI_NO_INDEX: none */
static size_t count_sectors(const cwi_ring *ring, const uint32_t curve[2], bool *are_spanning)
{
    uint32_t parents[CWI_RING_TRIANGLES];
    uint8_t ends[CWI_RING_TRIANGLES][2] = {{0}};
    size_t sectors = 0;
    for (uint32_t i = 0; i < ring->triangle_count; i++)
        parents[i] = i;
    for (uint32_t i = 0; i < ring->triangle_count; i++)
        for (uint32_t j = 0; j < i; j++) {
            const cwi_ring_triangle *s = &ring->triangles[i], *t = &ring->triangles[j];
            const uint32_t common = s->a == t->b ? s->a : s->b == t->a ? s->b : CWI_NO_INDEX;
            if (common != CWI_NO_INDEX && common != curve[0] && common != curve[1])
                parents[find_root(parents, i)] = find_root(parents, j);
        }
    for (uint32_t i = 0; i < ring->triangle_count; i++)
        for (int k = 0; k < 2; k++) {
            const cwi_ring_triangle *s = &ring->triangles[i];
            ends[find_root(parents, i)][k] += (s->a == curve[k]) + (s->b == curve[k]);
        }
    *are_spanning = true;
    for (uint32_t i = 0; i < ring->triangle_count; i++)
        if (parents[i] == i) {
            sectors++;
            *are_spanning &= ends[i][0] == 1 && ends[i][1] == 1;
        }
    return sectors;
}

/* Returns true if a triangle of a ring has the same corners as another one. */
static bool has_duplicates(const cwi_ring *ring)
{
    for (size_t i = 0; i < ring->triangle_count; i++)
        for (size_t j = 0; j < i; j++) {
            const cwi_ring_triangle *s = &ring->triangles[i], *t = &ring->triangles[j];
            if ((s->a == t->a && s->b == t->b) || (s->a == t->b && s->b == t->a))
                return true;
        }
    return false;
}

static uint8_t find_order(const cwi_complex *c, uint32_t vertex, cwi_ring *ring)
{
    uint32_t curve[2] = {CWI_NO_INDEX, CWI_NO_INDEX};
    size_t curves = 0;
    bool are_spanning;
    if (!cwi_ring_gather(c, vertex, ring) || has_duplicates(ring))
        return CWI_ORDER_HELD;
    for (size_t n = 0; n < ring->neighbour_count; n++)
        if (c->is_curve[ring->neighbours[n].edge]) {
            if (curves < 2)
                curve[curves] = ring->neighbours[n].vertex;
            curves++;
        }
    if (curves != 0 && curves != 2)
        return CWI_ORDER_POINT;
    const size_t sectors = count_sectors(ring, curve, &are_spanning);
    if (curves == 0)
        return sectors == 1 ? CWI_ORDER_INNER : CWI_ORDER_POINT;
    return are_spanning ? CWI_ORDER_CURVE : CWI_ORDER_POINT;
}

cw_status cwi_complex_build(cwi_complex *c, const cw_label_surfaces *s, double scale,
                            cw_error *err)
{
    memset(c, 0, sizeof *c);
    c->vertex_count = s->mesh.vertex_count;
    c->triangle_count = c->live = s->mesh.triangle_count;
    bool has_memory = alloc_triangles(c);
    if (has_memory) {
        copy_surfaces(c, s, scale);
        has_memory = number_edges(c) && alloc_edges(c) && find_curves(c);
    }
    if (!has_memory)
        return cwi_fail_memory(err);
    cwi_ring ring;
    for (size_t v = 0; v < c->vertex_count; v++)
        c->orders[v] = find_order(c, (uint32_t)v, &ring);
    return CW_OK;
}

void cwi_complex_free(cwi_complex *c)
{
    cwi_free(c->points);
    cwi_free(c->corners);
    cwi_free(c->patches);
    cwi_free(c->next);
    cwi_free(c->heads);
    cwi_free(c->sides);
    cwi_free(c->ends);
    cwi_free(c->is_curve);
    cwi_free(c->orders);
    memset(c, 0, sizeof *c);
}

/* ---- collapses -------------------------------------------------------------------------- */

bool cwi_complex_choose(const cwi_complex *c, uint32_t edge, uint32_t *keep, uint32_t *drop)
{
    const uint32_t a = c->ends[edge][0], b = c->ends[edge][1];
    const uint8_t order_a = c->orders[a], order_b = c->orders[b];
    const bool is_first = order_a != order_b ? order_a > order_b : a < b;
    *keep = is_first ? a : b;
    *drop = is_first ? b : a;
    const uint8_t high = is_first ? order_a : order_b, low = is_first ? order_b : order_a;
    if (high == CWI_ORDER_HELD || low >= CWI_ORDER_POINT)
        return false;
    return low == CWI_ORDER_INNER || c->is_curve[edge];
}

/* Returns true if a ring has a triangle with both vertices. */
static bool has_triangle(const cwi_ring *ring, uint32_t a, uint32_t b)
{
    for (size_t i = 0; i < ring->triangle_count; i++) {
        const cwi_ring_triangle *s = &ring->triangles[i];
        if ((s->a == a && s->b == b) || (s->a == b && s->b == a))
            return true;
    }
    return false;
}

/* In the complex, the links of both ends may share the vertices across from the edge alone. With
 * a cone over the curves, both ends may be on curves only if the edge is on one, and no
 * neighbour may be joined to both by curves. With a cone over the points, not both ends may be
 * points. cwi_complex_choose() has looked at the ends. */
bool cwi_complex_links_allow(const cwi_complex *c, uint32_t edge, uint32_t keep, uint32_t drop,
                             const cwi_ring *keep_ring, const cwi_ring *drop_ring)
{
    uint32_t common[CWI_RING_NEIGHBOURS];
    size_t count = 0, across = 0;
    for (size_t n = 0; n < drop_ring->neighbour_count; n++) {
        const cwi_neighbour *of_drop = &drop_ring->neighbours[n];
        if (of_drop->edge == edge) {
            across = of_drop->triangles;
            continue;
        }
        const cwi_neighbour *of_keep = cwi_ring_find(keep_ring, of_drop->vertex);
        if (!of_keep)
            continue;
        if (c->is_curve[of_drop->edge] && c->is_curve[of_keep->edge])
            return false;
        common[count++] = of_drop->vertex;
    }
    if (count != across)
        return false;
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < i; j++)
            if (has_triangle(drop_ring, common[i], common[j]) &&
                has_triangle(keep_ring, common[i], common[j]))
                return false;
    return keep != drop;
}

/* Takes a corner out of the list of its vertex. */
static void unlink_corner(cwi_complex *c, uint32_t corner)
{
    uint32_t *at = &c->heads[c->corners[corner]];
    while (*at != corner)
        at = &c->next[*at];
    *at = c->next[corner];
}

/* Removes a triangle, and gives the vertex across from the edge one edge in place of two. */
static void remove_triangle(cwi_complex *c, const cwi_ring_triangle *gone, uint32_t across,
                            const cwi_ring *keep_ring, const cwi_ring *drop_ring)
{
    const uint32_t kept = cwi_ring_find(keep_ring, across)->edge,
                   dropped = cwi_ring_find(drop_ring, across)->edge;
    for (uint32_t k = 0; k < 3; k++)
        unlink_corner(c, 3 * gone->triangle + k);
    for (uint32_t k = 0; k < 3; k++)
        c->corners[3 * gone->triangle + k] = CWI_NO_INDEX;
    c->live--;
    for (size_t i = 0; i < drop_ring->triangle_count; i++)
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t *side = &c->sides[3 * drop_ring->triangles[i].triangle + k];
            *side = *side == dropped ? kept : *side;
        }
    c->is_curve[kept] |= c->is_curve[dropped];
    c->ends[dropped][0] = CWI_NO_INDEX;
}

void cwi_complex_collapse(cwi_complex *c, uint32_t edge, uint32_t keep, uint32_t drop,
                          const cwi_ring *keep_ring, const cwi_ring *drop_ring)
{
    for (size_t i = 0; i < drop_ring->triangle_count; i++) {
        const cwi_ring_triangle *s = &drop_ring->triangles[i];
        if (s->a == keep || s->b == keep)
            remove_triangle(c, s, s->a == keep ? s->b : s->a, keep_ring, drop_ring);
    }
    for (uint32_t at = c->heads[drop], following; at != CWI_NO_INDEX; at = following) {
        following = c->next[at];
        c->corners[at] = keep;
        c->next[at] = c->heads[keep];
        c->heads[keep] = at;
    }
    c->heads[drop] = CWI_NO_INDEX;
    c->ends[edge][0] = CWI_NO_INDEX;
    for (size_t n = 0; n < drop_ring->neighbour_count; n++) {
        uint32_t *ends = c->ends[drop_ring->neighbours[n].edge];
        ends[0] = ends[0] == drop ? keep : ends[0];
        ends[1] = ends[1] == drop ? keep : ends[1];
    }
}
