/* Operations on the mesh at work: splits, collapses and flips of edges, and moves of vertices. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "simplify/remesh/remesh_state.h"

#include <string.h>

/* Cosine of 25 degrees: flips toward six neighbours may make angles this small. */
static const double FLIP_COSINE = 0.9063;

/* Fraction of the allowed distance that ends and bends of features may move. */
static const double TINY = 0.25;

/* Flips by angles must raise the smallest angle by more than rounding. */
static const double FLIP_GAIN = 1e-4;

static void set_sharp(cwi_remesh *r, uint32_t corner, bool is_sharp)
{
    const uint8_t bit = (uint8_t)(CWI_SHARP << corner % 3);
    uint8_t *bits = &r->bits[corner / 3];
    *bits = (uint8_t)(is_sharp ? *bits | bit : *bits & ~bit);
}

/* Joins two corners of one edge, one of which may be missing. */
static void join_corners(cwi_remesh *r, uint32_t a, uint32_t b)
{
    if (a != CWI_NONE)
        r->twin[a] = b;
    if (b != CWI_NONE)
        r->twin[b] = a;
}

static void begin_patch(cwi_replacement *p)
{
    p->old_count = p->count = p->samples = 0;
    p->moved = CWI_NONE;
}

static void add_fresh(cwi_replacement *p, uint32_t id, uint32_t a, uint32_t b, uint32_t c,
                      unsigned sharp)
{
    const size_t n = p->count++;
    p->ids[n] = id;
    p->fresh[n][0] = a;
    p->fresh[n][1] = b;
    p->fresh[n][2] = c;
    p->sharp[n] = (uint8_t)sharp;
}

/* Returns the bits of sharp edges of a corner's triangle, as if the corner was its first. */
static unsigned turned_bits(const cwi_remesh *r, uint32_t corner)
{
    const uint32_t b = cwi_corner_next(corner), c = cwi_corner_next(b);
    return (unsigned)cwi_is_sharp(r, corner) | (unsigned)cwi_is_sharp(r, b) << 1 |
           (unsigned)cwi_is_sharp(r, c) << 2;
}

/* --- splits ------------------------------------------------------------------------------- */

static bool grow_vertices(cwi_remesh *r, size_t capacity)
{
    float *positions = cwi_realloc_array(r->positions, capacity, 3 * sizeof *positions);
    r->positions = positions ? positions : r->positions;
    float *sizes = cwi_realloc_array(r->sizes, capacity, sizeof *sizes);
    r->sizes = sizes ? sizes : r->sizes;
    uint32_t *corner = cwi_realloc_array(r->corner, capacity, sizeof *corner);
    r->corner = corner ? corner : r->corner;
    uint8_t *freedom = cwi_realloc_array(r->freedom, capacity, sizeof *freedom);
    r->freedom = freedom ? freedom : r->freedom;
    const bool is_done = positions && sizes && corner && freedom;
    r->vertex_capacity = is_done ? capacity : r->vertex_capacity;
    return is_done;
}

static bool grow_triangles(cwi_remesh *r, size_t capacity)
{
    uint32_t *triangles = cwi_realloc_array(r->triangles, capacity, 3 * sizeof *triangles);
    r->triangles = triangles ? triangles : r->triangles;
    uint32_t *twin = cwi_realloc_array(r->twin, capacity, 3 * sizeof *twin);
    r->twin = twin ? twin : r->twin;
    uint32_t *first = cwi_realloc_array(r->first_sample, capacity, sizeof *first);
    r->first_sample = first ? first : r->first_sample;
    uint8_t *bits = cwi_realloc_array(r->bits, capacity, sizeof *bits);
    r->bits = bits ? bits : r->bits;
    const bool is_done = triangles && twin && first && bits;
    r->triangle_capacity = is_done ? capacity : r->triangle_capacity;
    return is_done;
}

/* Makes room for a vertex and two triangles. */
static cw_status ensure_capacity(cwi_remesh *r, cw_error *err)
{
    if (r->triangle_count + 2 > CWI_MAX_TRIANGLES)
        return cwi_fail(err, CW_ERR_LIMIT, "remeshing needs more than %zu triangles",
                        CWI_MAX_TRIANGLES);
    const bool has_vertices =
        r->vertex_count < r->vertex_capacity ||
        grow_vertices(r, r->vertex_capacity + r->vertex_capacity / 2 + 64);
    const bool has_triangles =
        r->triangle_count + 2 <= r->triangle_capacity ||
        grow_triangles(r, r->triangle_capacity + r->triangle_capacity / 2 + 64);
    return has_vertices && has_triangles ? CW_OK : cwi_fail_memory(err);
}

/* Lists the halves of a triangle whose edge at a corner is divided. */
static void plan_halves(const cwi_remesh *r, cwi_replacement *p, uint32_t corner,
                        uint32_t middle, uint32_t new_id)
{
    const uint32_t a = r->triangles[corner], b = r->triangles[cwi_corner_next(corner)],
                   c = r->triangles[cwi_corner_prev(corner)];
    const unsigned bits = turned_bits(r, corner);
    p->old[p->old_count++] = corner / 3;
    add_fresh(p, corner / 3, a, middle, c, (bits & 1) | (bits & 4));
    add_fresh(p, new_id, middle, b, c, (bits & 1) | (bits & 2));
}

/* Divides the triangle of a corner: it keeps the first half of the edge, a new one gets the second. */
static void divide_triangle(cwi_remesh *r, uint32_t corner, uint32_t middle, uint32_t new_id)
{
    const uint32_t next = cwi_corner_next(corner), last = cwi_corner_prev(corner),
                   base = 3 * new_id;
    const bool is_sharp = cwi_is_sharp(r, corner), is_next_sharp = cwi_is_sharp(r, next);
    r->triangles[base] = middle;
    r->triangles[base + 1] = r->triangles[next];
    r->triangles[base + 2] = r->triangles[last];
    r->bits[new_id] = 0;
    set_sharp(r, base, is_sharp);
    set_sharp(r, base + 1, is_next_sharp);
    set_sharp(r, next, false);
    r->corner[r->triangles[base + 1]] = base + 1;
    r->triangles[next] = middle;
    r->corner[middle] = next;
    r->corner[r->triangles[last]] = last;
    join_corners(r, base + 1, r->twin[next]);
    join_corners(r, base + 2, next);
    r->twin[base] = CWI_NONE;
}

cw_status cwi_split_edge(cwi_remesh *r, uint32_t corner, bool *is_done, cw_error *err)
{
    *is_done = false;
    cw_status st = ensure_capacity(r, err);
    if (st != CW_OK)
        return st;
    cwi_replacement *p = &r->patch;
    const uint32_t twin = r->twin[corner], middle = (uint32_t)r->vertex_count,
                   id = (uint32_t)r->triangle_count, a = r->triangles[corner],
                   b = r->triangles[cwi_corner_next(corner)];
    begin_patch(p);
    for (size_t k = 0; k < 3; k++)
        p->position[k] = (float)(((double)r->positions[3 * (size_t)a + k] +
                                  (double)r->positions[3 * (size_t)b + k]) /
                                 2);
    p->moved = middle;
    plan_halves(r, p, corner, middle, id);
    if (twin != CWI_NONE)
        plan_halves(r, p, twin, middle, id + 1);
    if (cwi_patch_cosine(r, p) > 1)
        return CW_OK;
    cwi_patch_assign(r, p);
    memcpy(r->positions + 3 * (size_t)middle, p->position, sizeof p->position);
    r->sizes[middle] = (r->sizes[a] + r->sizes[b]) / 2;
    r->freedom[middle] = cwi_is_sharp(r, corner) ? CWI_CURVE : CWI_FREE;
    r->vertex_count++;
    r->triangle_count += twin == CWI_NONE ? 1 : 2;
    divide_triangle(r, corner, middle, id);
    if (twin != CWI_NONE) {
        divide_triangle(r, twin, middle, id + 1);
        join_corners(r, corner, 3 * (id + 1));
        join_corners(r, twin, 3 * id);
    }
    cwi_patch_attach(r, p);
    *is_done = true;
    return CW_OK;
}

/* --- collapses ---------------------------------------------------------------------------- */

/* Visits the triangles at a vertex: sets `corner` to each of its corners in turn. A border is passed
 * by going back to the first one. */
typedef struct ring_walk {
    uint32_t start, corner;
    bool is_back; /* walks clockwise, after a border was met */
    bool is_border;
} ring_walk;

static ring_walk begin_walk(const cwi_remesh *r, uint32_t vertex)
{
    return (ring_walk){.start = r->corner[vertex], .corner = r->corner[vertex]};
}

/* Goes on to the next corner; false when all were visited. */
static bool walk_on(const cwi_remesh *r, ring_walk *w)
{
    if (!w->is_back) {
        const uint32_t across = r->twin[cwi_corner_prev(w->corner)];
        if (across != CWI_NONE) {
            w->corner = across;
            return across != w->start;
        }
        w->is_back = w->is_border = true;
        w->corner = w->start;
    }
    const uint32_t across = r->twin[w->corner];
    if (across == CWI_NONE)
        return false;
    w->corner = cwi_corner_next(across);
    return true;
}

/* Counts the triangles at a vertex. */
static size_t count_triangles_around(const cwi_remesh *r, uint32_t vertex, bool *is_border)
{
    ring_walk w = begin_walk(r, vertex);
    size_t count = 1;
    while (walk_on(r, &w))
        count++;
    *is_border = w.is_border;
    return count;
}

static bool are_neighbours(const cwi_remesh *r, uint32_t a, uint32_t b)
{
    ring_walk w = begin_walk(r, a);
    do {
        if (r->triangles[cwi_corner_next(w.corner)] == b ||
            r->triangles[cwi_corner_prev(w.corner)] == b)
            return true;
    } while (walk_on(r, &w));
    return false;
}

/* The ring of the vertex that a collapse removes. */
typedef struct collapse_ring {
    uint32_t corners[CWI_MAX_ONE_RING], ring[CWI_MAX_ONE_RING + 1];
    size_t count, ring_count, shared; /* shared: triangles of the edge */
    bool is_border, is_edge_sharp;
} collapse_ring;

static bool read_one_ring(const cwi_remesh *r, uint32_t vertex, uint32_t to, collapse_ring *s)
{
    s->count = cwi_list_one_ring(r, vertex, s->corners, &s->is_border);
    s->ring_count = s->shared = 0;
    s->is_edge_sharp = false;
    for (size_t n = 0; n < s->count; n++) {
        const uint32_t c = s->corners[n], next = r->triangles[cwi_corner_next(c)],
                       last = r->triangles[cwi_corner_prev(c)];
        s->ring[s->ring_count++] = next;
        if (n + 1 == s->count && s->is_border)
            s->ring[s->ring_count++] = last;
        s->shared += next == to || last == to;
        s->is_edge_sharp = s->is_edge_sharp || (next == to && cwi_is_sharp(r, c)) ||
                           (last == to && cwi_is_sharp(r, cwi_corner_prev(c)));
    }
    return s->shared > 0 && s->count > s->shared;
}

static bool is_in_ring(const collapse_ring *s, uint32_t vertex)
{
    for (size_t n = 0; n < s->ring_count; n++)
        if (s->ring[n] == vertex)
            return true;
    return false;
}

/* Returns true if the vertices have no neighbours in common but those across the edge, those keep enough
 * triangles, and no border would touch another. */
static bool is_collapse_simple(const cwi_remesh *r, uint32_t to, const collapse_ring *s)
{
    size_t common = 0;
    ring_walk w = begin_walk(r, to);
    do {
        common += is_in_ring(s, r->triangles[cwi_corner_next(w.corner)]);
        if (r->twin[cwi_corner_prev(w.corner)] == CWI_NONE)
            common += is_in_ring(s, r->triangles[cwi_corner_prev(w.corner)]);
    } while (walk_on(r, &w));
    if (common != s->shared || (s->is_border && w.is_border && s->shared == 2))
        return false;
    bool is_border;
    for (size_t n = 0; n < s->count; n++) {
        const uint32_t c = s->corners[n], next = r->triangles[cwi_corner_next(c)],
                       last = r->triangles[cwi_corner_prev(c)];
        if (next != to && last != to)
            continue;
        const size_t triangles =
            count_triangles_around(r, next == to ? last : next, &is_border);
        if (triangles < (is_border ? 2u : 4u))
            return false;
    }
    return true;
}

/* Returns true if an edge from the vertex to a neighbour lies on one from `to` that is sharp. */
static bool is_merged_sharp(const cwi_remesh *r, uint32_t to, uint32_t neighbour,
                            const collapse_ring *s)
{
    for (size_t n = 0; n < s->count; n++) {
        const uint32_t c = s->corners[n], next = r->triangles[cwi_corner_next(c)],
                       last = r->triangles[cwi_corner_prev(c)];
        if ((next == to && last == neighbour) || (next == neighbour && last == to))
            return cwi_is_sharp(r, cwi_corner_next(c));
    }
    return false;
}

/* Lists the triangles after a collapse.
 * merges   two sharp edges may become one
 * Returns  false where that would happen, and may not */
static bool plan_collapse(const cwi_remesh *r, uint32_t to, const collapse_ring *s, bool merges,
                          cwi_replacement *p)
{
    begin_patch(p);
    for (size_t n = 0; n < s->count; n++) {
        const uint32_t c = s->corners[n], next = r->triangles[cwi_corner_next(c)],
                       last = r->triangles[cwi_corner_prev(c)];
        p->old[p->old_count++] = c / 3;
        if (next == to || last == to)
            continue;
        const bool at_next = is_merged_sharp(r, to, next, s),
                   at_last = is_merged_sharp(r, to, last, s);
        const unsigned bits = turned_bits(r, c);
        if (!merges && ((at_next && bits & 1) || (at_last && bits & 4)))
            return false;
        add_fresh(p, c / 3, to, next, last, bits | (at_next ? 1u : 0u) | (at_last ? 4u : 0u));
    }
    return true;
}

/* Removes a triangle of a collapsed edge: its two other edges become one. */
static void close_triangle(cwi_remesh *r, uint32_t corner, uint32_t to)
{
    const uint32_t next = cwi_corner_next(corner), last = cwi_corner_prev(corner);
    const bool goes_to_next = r->triangles[next] == to;
    const uint32_t other = r->triangles[goes_to_next ? last : next];
    const uint32_t a = r->twin[next], b = r->twin[goes_to_next ? last : corner];
    const bool is_sharp =
        cwi_is_sharp(r, next) || cwi_is_sharp(r, goes_to_next ? last : corner);
    join_corners(r, a, b);
    if (a != CWI_NONE) {
        set_sharp(r, a, is_sharp);
        r->corner[other] = r->triangles[a] == other ? a : cwi_corner_next(a);
    }
    if (b != CWI_NONE) {
        set_sharp(r, b, is_sharp);
        r->corner[other] = r->triangles[b] == other ? b : cwi_corner_next(b);
    }
    r->bits[corner / 3] = CWI_DEAD;
}

/* Returns true if an edge is so short that even ends and bends of features may be moved along it, and
 * features beside each other merged. */
static bool is_tiny(const cwi_remesh *r, uint32_t a, uint32_t b)
{
    const double limit = TINY * r->limit_mm;
    return cwi_point_distance_sq(r->positions + 3 * (size_t)a, r->positions + 3 * (size_t)b) <
           limit * limit;
}

bool cwi_collapse_edge(cwi_remesh *r, uint32_t vertex, uint32_t to, double longest,
                       double cosine)
{
    collapse_ring s;
    cwi_replacement *p = &r->patch;
    const bool is_small = is_tiny(r, vertex, to);
    if ((r->freedom[vertex] == CWI_FIXED && !is_small) || !read_one_ring(r, vertex, to, &s) ||
        (r->freedom[vertex] != CWI_FREE && !s.is_edge_sharp && !is_small) ||
        !is_collapse_simple(r, to, &s))
        return false;
    for (size_t n = 0; n < s.ring_count; n++)
        if (s.ring[n] != to && cwi_relative_length(r, to, s.ring[n]) > longest)
            return false;
    if (!plan_collapse(r, to, &s, is_small, p) ||
        !(cwi_patch_cosine(r, p) <= cwi_lesser(cosine, 1)) || !cwi_patch_fits(r, p))
        return false;
    uint32_t kept = CWI_NONE;
    for (size_t n = 0; n < s.count; n++) {
        const uint32_t c = s.corners[n];
        if (r->triangles[cwi_corner_next(c)] == to || r->triangles[cwi_corner_prev(c)] == to)
            continue;
        kept = c;
    }
    for (size_t n = 0; n < s.count; n++) {
        const uint32_t c = s.corners[n];
        if (r->triangles[cwi_corner_next(c)] == to || r->triangles[cwi_corner_prev(c)] == to)
            close_triangle(r, c, to);
        else
            r->triangles[c] = to;
    }
    r->corner[vertex] = CWI_NONE;
    r->corner[to] = kept;
    r->freedom[to] = r->freedom[vertex] > r->freedom[to] ? r->freedom[vertex] : r->freedom[to];
    cwi_patch_attach(r, p);
    return true;
}

/* --- flips -------------------------------------------------------------------------------- */

/* Returns the square of how far a vertex is from its wanted number of triangles. */
static int square_off(size_t triangles, bool is_border, int change)
{
    const int off = (int)triangles + change - (is_border ? 3 : 6);
    return off * off;
}

/* Returns true if a flip brings the four vertices nearer to six neighbours. */
static bool evens_valences(const cwi_remesh *r, const uint32_t from[2], const uint32_t to[2])
{
    int before = 0, after = 0;
    for (int k = 0; k < 2; k++) {
        bool is_border;
        size_t count = count_triangles_around(r, from[k], &is_border);
        before += square_off(count, is_border, 0);
        after += square_off(count, is_border, -1);
        count = count_triangles_around(r, to[k], &is_border);
        before += square_off(count, is_border, 0);
        after += square_off(count, is_border, 1);
    }
    return after < before;
}

static void put_triangle(cwi_remesh *r, uint32_t t, const uint32_t v[3], unsigned sharp)
{
    r->bits[t] = (uint8_t)sharp;
    for (uint32_t k = 0; k < 3; k++) {
        r->triangles[3 * t + k] = v[k];
        r->corner[v[k]] = 3 * t + k;
    }
}

bool cwi_flip_edge(cwi_remesh *r, uint32_t corner, bool by_angle)
{
    const uint32_t twin = r->twin[corner];
    if (twin == CWI_NONE || cwi_is_sharp(r, corner))
        return false;
    const uint32_t a = r->triangles[corner], b = r->triangles[twin],
                   c = r->triangles[cwi_corner_prev(corner)],
                   d = r->triangles[cwi_corner_prev(twin)], t = corner / 3, u = twin / 3;
    if (c == d)
        return false;
    cwi_replacement *p = &r->patch;
    const unsigned ca = cwi_is_sharp(r, cwi_corner_prev(corner)),
                   ad = cwi_is_sharp(r, cwi_corner_next(twin)),
                   db = cwi_is_sharp(r, cwi_corner_prev(twin)),
                   bc = cwi_is_sharp(r, cwi_corner_next(corner));
    begin_patch(p);
    p->old[p->old_count++] = t;
    p->old[p->old_count++] = u;
    add_fresh(p, t, c, a, d, ca | ad << 1);
    add_fresh(p, u, c, d, b, db << 1 | bc << 2);
    const double before = cwi_patch_cosine_before(r, p), after = cwi_patch_cosine(r, p);
    if (after > 1)
        return false;
    const bool is_target =
        by_angle ? after < before - FLIP_GAIN
                 : after <= cwi_greater(before, FLIP_COSINE) &&
                       evens_valences(r, (const uint32_t[]){a, b}, (const uint32_t[]){c, d});
    if (!is_target || are_neighbours(r, c, d) || !cwi_patch_fits(r, p))
        return false;
    const uint32_t to_ca = r->twin[cwi_corner_prev(corner)],
                   to_ad = r->twin[cwi_corner_next(twin)],
                   to_db = r->twin[cwi_corner_prev(twin)],
                   to_bc = r->twin[cwi_corner_next(corner)];
    put_triangle(r, t, p->fresh[0], p->sharp[0]);
    put_triangle(r, u, p->fresh[1], p->sharp[1]);
    join_corners(r, 3 * t, to_ca);
    join_corners(r, 3 * t + 1, to_ad);
    join_corners(r, 3 * t + 2, 3 * u);
    join_corners(r, 3 * u + 1, to_db);
    join_corners(r, 3 * u + 2, to_bc);
    cwi_patch_attach(r, p);
    return true;
}

/* --- moves -------------------------------------------------------------------------------- */

bool cwi_move_vertex(cwi_remesh *r, uint32_t vertex, const float position[3], float size,
                     double cosine)
{
    uint32_t corners[CWI_MAX_ONE_RING];
    bool is_border;
    cwi_replacement *p = &r->patch;
    const size_t count = cwi_list_one_ring(r, vertex, corners, &is_border);
    begin_patch(p);
    for (size_t n = 0; n < count; n++) {
        const uint32_t c = corners[n];
        p->old[p->old_count++] = c / 3;
        add_fresh(p, c / 3, vertex, r->triangles[cwi_corner_next(c)],
                  r->triangles[cwi_corner_prev(c)], turned_bits(r, c));
    }
    p->moved = vertex;
    memcpy(p->position, position, sizeof p->position);
    if (!count || !(cwi_patch_cosine(r, p) <= cwi_lesser(cosine, 1)) || !cwi_patch_fits(r, p))
        return false;
    memcpy(r->positions + 3 * (size_t)vertex, position, sizeof p->position);
    r->sizes[vertex] = size;
    cwi_patch_attach(r, p);
    return true;
}
