/* Features of the input: edges where normals turn by much, and how their vertices may move. */
#include "core/geometry/vec3.h"
#include "simplify/remesh/remesh_state.h"

#include <string.h>

enum { CHAIN_ROUNDS = 3 };

static void measure_normals(cwi_remesh *r)
{
    const cw_mesh *m = r->input;
    for (size_t t = 0; t < m->triangle_count; t++) {
        double normal[3];
        const uint32_t *v = m->triangles + 3 * t;
        const bool has_area =
            cwi_largest_cosine(m->positions + 3 * (size_t)v[0], m->positions + 3 * (size_t)v[1],
                               m->positions + 3 * (size_t)v[2], normal) <= 1 &&
            cwi_normalise(normal);
        for (size_t k = 0; k < 3; k++)
            r->surface.normals[3 * t + k] = has_area ? (float)normal[k] : 0;
    }
}

static bool is_feature(const cwi_remesh *r, uint32_t corner, double cosine)
{
    const uint32_t twin = r->twin[corner];
    if (twin == CWI_NONE)
        return true;
    const float *n = r->surface.normals + 3 * (size_t)(corner / 3),
                *o = r->surface.normals + 3 * (size_t)(twin / 3);
    const bool has_area =
        (n[0] != 0 || n[1] != 0 || n[2] != 0) && (o[0] != 0 || o[1] != 0 || o[2] != 0);
    return has_area && (double)n[0] * (double)o[0] + (double)n[1] * (double)o[1] +
                               (double)n[2] * (double)o[2] <
                           cosine;
}

static void mark_features(cwi_remesh *r)
{
    const double cosine = cos(r->desc.feature_deg * CWI_PI / 180);
    for (size_t t = 0; t < r->triangle_count; t++) {
        unsigned bits = 0;
        for (uint32_t k = 0; k < 3; k++)
            bits |= is_feature(r, (uint32_t)(3 * t + k), cosine) ? 1u << k : 0;
        r->bits[t] = (uint8_t)bits;
    }
}

/* Returns true if two vertices are seen from a third in directions that turn by more than the angle of
 * features. */
static bool is_turn(const cwi_remesh *r, uint32_t v, uint32_t a, uint32_t b)
{
    double to[2][3];
    for (size_t k = 0; k < 3; k++) {
        const double at = (double)r->positions[3 * (size_t)v + k];
        to[0][k] = (double)r->positions[3 * (size_t)a + k] - at;
        to[1][k] = at - (double)r->positions[3 * (size_t)b + k];
    }
    return !cwi_normalise(to[0]) || !cwi_normalise(to[1]) ||
           cwi_dot(to[0], to[1]) < cos(r->desc.feature_deg * CWI_PI / 180);
}

/* Follows sharp edges until a vertex is farther from the first than the allowed distance. */
static uint32_t follow_curve(const cwi_remesh *r, uint32_t (*ends)[2], const uint8_t *counts,
                             uint32_t start, uint32_t next)
{
    const double reach = r->desc.error_mm;
    uint32_t last = start;
    while (counts[next] == 2 && next != start &&
           cwi_point_distance_sq(r->positions + 3 * (size_t)start,
                                 r->positions + 3 * (size_t)next) < reach * reach) {
        const uint32_t after = ends[next][0] == last ? ends[next][1] : ends[next][0];
        last = next;
        next = after;
    }
    return next;
}

/* Returns true if a curve bends at a vertex, both at once and beyond the allowed distance: so zigzags that
 * are smaller do not count. */
static bool is_bend(const cwi_remesh *r, uint32_t (*ends)[2], const uint8_t *counts, uint32_t v)
{
    return is_turn(r, v, ends[v][0], ends[v][1]) &&
           is_turn(r, v, follow_curve(r, ends, counts, v, ends[v][0]),
                   follow_curve(r, ends, counts, v, ends[v][1]));
}

/* Counts the sharp edges at each vertex, up to 3, and lists the other ends of the first two. */
static void count_edges(cwi_remesh *r, uint32_t (*ends)[2])
{
    memset(r->freedom, 0, r->vertex_count);
    for (uint32_t c = 0; c < 3 * r->triangle_count; c++) {
        if (!cwi_is_sharp(r, c) || (r->twin[c] != CWI_NONE && r->twin[c] < c))
            continue;
        const uint32_t v[2] = {r->triangles[c], r->triangles[cwi_corner_next(c)]};
        for (int k = 0; k < 2; k++) {
            const uint8_t found = r->freedom[v[k]];
            if (found < 2)
                ends[v[k]][found] = v[1 - k];
            r->freedom[v[k]] = (uint8_t)(found < 3 ? found + 1 : 3);
        }
    }
}

/* Marks the vertices of a chain of sharp edges that begins at a loose end, if it is shorter than an edge
 * of the result.
 * Returns  how many were marked */
static size_t mark_chain(cwi_remesh *r, uint32_t (*ends)[2], uint32_t start)
{
    double length = 0;
    uint32_t at = start, last = CWI_NONE;
    size_t count = 0;
    for (int pass = 0; pass < 2; pass++, at = start, last = CWI_NONE)
        for (bool goes_on = true; goes_on;) {
            const uint32_t next = ends[at][0] == last ? ends[at][1] : ends[at][0];
            if (pass == 0)
                length += sqrt(cwi_point_distance_sq(r->positions + 3 * (size_t)at,
                                                     r->positions + 3 * (size_t)next));
            else
                count += (r->scratch[at] = 1);
            if (length >= r->desc.edge_mm)
                return 0;
            last = at;
            at = next;
            goes_on = r->freedom[at] == 2;
        }
    return count;
}

/* Takes short chains with a loose end from the features: they come and go where a surface turns by about
 * the angle of features.
 * Returns  true if there were any */
static bool drop_short_chains(cwi_remesh *r, uint32_t (*ends)[2])
{
    size_t marked = 0;
    for (size_t v = 0; v < r->vertex_count; v++)
        r->scratch[v] = 0;
    for (uint32_t v = 0; v < r->vertex_count; v++)
        if (r->freedom[v] == 1)
            marked += mark_chain(r, ends, v);
    for (uint32_t c = 0; c < 3 * r->triangle_count && marked; c++)
        if (r->twin[c] != CWI_NONE &&
            (r->scratch[r->triangles[c]] || r->scratch[r->triangles[cwi_corner_next(c)]]))
            r->bits[c / 3] &= (uint8_t) ~(CWI_SHARP << c % 3);
    return marked > 0;
}

/* Decides how each vertex may move, by the sharp edges at it. */
static void find_freedom(cwi_remesh *r)
{
    uint32_t(*ends)[2] = (uint32_t(*)[2])(void *)r->scratch_ends;
    count_edges(r, ends);
    for (int round = 0; round < CHAIN_ROUNDS && drop_short_chains(r, ends); round++)
        count_edges(r, ends);
    uint8_t *counts = r->scratch_to;
    memcpy(counts, r->freedom, r->vertex_count);
    for (uint32_t v = 0; v < r->vertex_count; v++)
        r->freedom[v] = counts[v] == 0                                   ? CWI_FREE
                        : counts[v] == 2 && !is_bend(r, ends, counts, v) ? CWI_CURVE
                                                                         : CWI_FIXED;
}

void cwi_find_features(cwi_remesh *r)
{
    measure_normals(r);
    mark_features(r);
    find_freedom(r);
}
