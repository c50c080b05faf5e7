/* Facets from triangles and their parts. Where triangles overlap in a plane, each is split by the others'
 * edges: it has the same pockets there, regions between seams. Of a pocket that several triangles have, the
 * first one's parts stand for all [Cherchi2022]. */
#include "simplify/boolean/complex.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"

#include <stdlib.h>
#include <string.h>

/* A pocket of a triangle: the edges around it name it. */
typedef struct pocket {
    uint64_t hash;
    size_t first_edge, edge_count; /* in pockets.edges */
    size_t first_part, part_count; /* in pockets.parts */
    uint32_t triangle;
} pocket;

typedef struct edge {
    uint32_t low, high; /* points */
    uint32_t part;
} edge;

typedef struct pockets {
    const cwi_soup *s;
    const cwi_triangle_parts *parts;
    size_t count, capacity, edge_count, edge_capacity, part_count, part_capacity;
    pocket *pockets;
    edge *edges;
    uint32_t *members; /* parts of pockets */
    uint32_t *slots;   /* hash table of pockets that stand for themselves: 1 + a pocket */
    size_t slot_mask;
    size_t cover_capacity;
} pockets;

bool cwi_make_room(void *array, size_t *capacity, size_t count, size_t size)
{
    void **a = array;
    if (count <= *capacity)
        return true;
    void *grown = cwi_realloc_array(*a, 2 * count, size);
    if (!grown)
        return false;
    *a = grown;
    *capacity = 2 * count;
    return true;
}

static int compare_edges(const void *x, const void *y)
{
    const edge *a = x, *b = y;
    if (a->low != b->low)
        return a->low < b->low ? -1 : 1;
    if (a->high != b->high)
        return a->high < b->high ? -1 : 1;
    return a->part < b->part ? -1 : a->part > b->part;
}

static edge edge_of(const uint32_t corners[3], int k, uint32_t part)
{
    const uint32_t a = corners[k], b = corners[(k + 1) % 3];
    return a < b ? (edge){a, b, part} : (edge){b, a, part};
}

/* A triangle's parts, or itself, as one list. */
typedef struct piece {
    uint32_t corners[3];
    uint8_t seams;
} piece;

/* Joins pieces that share an edge that is no seam. */
static bool join_pieces(const piece *pieces, size_t count, uint32_t *sets)
{
    edge *edges = cwi_alloc_array(3 * count, sizeof *edges);
    size_t n = 0;
    if (!edges)
        return false;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            if (!(pieces[i].seams >> k & 1))
                edges[n++] = edge_of(pieces[i].corners, k, (uint32_t)i);
    qsort(edges, n, sizeof *edges, compare_edges);
    for (size_t i = 1; i < n; i++)
        if (edges[i].low == edges[i - 1].low && edges[i].high == edges[i - 1].high)
            cwi_sets_join(sets, edges[i].part, edges[i - 1].part);
    cwi_free(edges);
    return true;
}

/* Adds the pocket of a set of pieces. base: the number of the first part; CWI_NOTHING: the whole triangle. */
static bool add_pocket(pockets *p, uint32_t triangle, const piece *pieces, size_t count,
                       uint32_t *sets, uint32_t set, uint32_t base)
{
    if (!cwi_make_room(&p->pockets, &p->capacity, p->count + 1, sizeof *p->pockets) ||
        !cwi_make_room(&p->edges, &p->edge_capacity, p->edge_count + 3 * count,
                       sizeof *p->edges) ||
        !cwi_make_room(&p->members, &p->part_capacity, p->part_count + count,
                       sizeof *p->members))
        return false;
    pocket *out = &p->pockets[p->count++];
    *out = (pocket){
        .first_edge = p->edge_count, .first_part = p->part_count, .triangle = triangle};
    edge *edges = p->edges + p->edge_count;
    size_t n = 0;
    for (size_t i = 0; i < count; i++) {
        if (cwi_sets_find(sets, (uint32_t)i) != set)
            continue;
        p->members[p->part_count++] = base == CWI_NOTHING ? CWI_NOTHING : base + (uint32_t)i;
        for (int k = 0; k < 3; k++)
            if (pieces[i].seams >> k & 1)
                edges[n++] = edge_of(pieces[i].corners, k, 0);
    }
    out->part_count = p->part_count - out->first_part;
    qsort(edges, n, sizeof *edges, compare_edges);
    for (size_t i = 0; i < n; i++)
        if (i == 0 || compare_edges(&edges[i], &edges[i - 1]) != 0) {
            out->hash = (out->hash ^ edges[i].low) * UINT64_C(0x9E3779B97F4A7C15);
            out->hash = (out->hash ^ edges[i].high) * UINT64_C(0xC2B2AE3D27D4EB4F);
            out->hash ^= out->hash >> 29;
            edges[out->edge_count++] = edges[i];
        }
    p->edge_count += out->edge_count;
    return true;
}

static bool add_pockets(pockets *p, const cwi_facets *f, uint32_t t)
{
    const size_t first = f->first_part[t], parts = f->first_part[t + 1] - first;
    const size_t count = parts ? parts : 1;
    piece *pieces = cwi_alloc_array(count, sizeof *pieces);
    uint32_t *sets = cwi_sets_alloc(count);
    bool done = pieces && sets;
    if (done && parts == 0) {
        memcpy(pieces[0].corners, p->s->triangles[t], sizeof pieces[0].corners);
        pieces[0].seams = 7;
    }
    for (size_t i = 0; i < parts && done; i++) {
        memcpy(pieces[i].corners, p->parts->parts[first + i].corners, sizeof pieces[i].corners);
        pieces[i].seams = p->parts->parts[first + i].seams;
    }
    done = done && join_pieces(pieces, count, sets);
    for (size_t i = 0; i < count && done; i++)
        if (cwi_sets_find(sets, (uint32_t)i) == i)
            done = add_pocket(p, t, pieces, count, sets, (uint32_t)i,
                              parts ? (uint32_t)first : CWI_NOTHING);
    cwi_free(pieces);
    cwi_free(sets);
    return done;
}

static bool is_same_pocket(const pockets *p, const pocket *a, const pocket *b)
{
    return a->hash == b->hash && a->edge_count == b->edge_count &&
           memcmp(p->edges + a->first_edge, p->edges + b->first_edge,
                  a->edge_count * sizeof *p->edges) == 0;
}

/* Returns the pocket that stands for pocket n: itself, if it is the first. */
static size_t find_first(pockets *p, size_t n)
{
    size_t slot = p->pockets[n].hash & p->slot_mask;
    for (; p->slots[slot]; slot = (slot + 1) & p->slot_mask)
        if (is_same_pocket(p, &p->pockets[p->slots[slot] - 1], &p->pockets[n]))
            return p->slots[slot] - 1;
    p->slots[slot] = (uint32_t)n + 1;
    return n;
}

/* --- facets ------------------------------------------------------------------------------- */

/* Returns 1 when two triangles of one plane face the same way, else -1. */
static int compare_facing(const cwi_soup *s, uint32_t t, uint32_t u)
{
    cwi_wide a[3], b[3];
    cwi_soup_normal(s, t, a);
    cwi_soup_normal(s, u, b);
    return cwi_wide_dot_sign(a, b);
}

static uint32_t add_facet(cwi_facets *f, const uint32_t corners[3], uint32_t source)
{
    memcpy(f->corners[f->count], corners, sizeof f->corners[0]);
    f->sources[f->count] = source;
    return (uint32_t)f->count++;
}

/* Adds the facets of a pocket, or covers those of the pocket that stands for it. */
static bool place_pocket(pockets *p, size_t n, cwi_facets *f)
{
    const pocket *own = &p->pockets[n];
    const size_t first = find_first(p, n);
    const uint32_t t = own->triangle;
    if (first == n) {
        for (size_t i = own->first_part; i < own->first_part + own->part_count; i++) {
            const uint32_t part = p->members[i];
            if (part == CWI_NOTHING)
                f->facet_of[t] = add_facet(f, p->s->triangles[t], t);
            else
                f->facet_of[t] = f->of_part[part] =
                    add_facet(f, p->parts->parts[part].corners, t);
        }
        return true;
    }
    const pocket *other = &p->pockets[first];
    if (!cwi_make_room(&f->covers, &p->cover_capacity, f->cover_count + other->part_count,
                       sizeof *f->covers))
        return false;
    for (size_t i = other->first_part; i < other->first_part + other->part_count; i++) {
        const uint32_t part = p->members[i];
        const uint32_t facet =
            part == CWI_NOTHING ? f->facet_of[other->triangle] : f->of_part[part];
        f->facet_of[t] = facet;
        f->covers[f->cover_count++] =
            (cwi_facet_cover){facet, t, compare_facing(p->s, t, other->triangle)};
    }
    return true;
}

static bool place_pockets(pockets *p, cwi_facets *f)
{
    size_t capacity = 64;
    while (capacity < 2 * p->count)
        capacity *= 2;
    p->slots = cwi_alloc_zeroed(capacity, sizeof *p->slots);
    p->slot_mask = capacity - 1;
    bool done = p->slots;
    for (size_t n = 0; n < p->count && done; n++)
        done = place_pocket(p, n, f);
    return done;
}

/* Facets of triangles that overlap no other. */
static void place_others(const cwi_soup *s, const cwi_triangle_parts *parts,
                         const bool *overlaps, cwi_facets *f)
{
    for (uint32_t t = 0; t < s->triangle_count; t++) {
        if (overlaps[t])
            continue;
        if (f->first_part[t] == f->first_part[t + 1])
            f->facet_of[t] = add_facet(f, s->triangles[t], t);
        for (size_t i = f->first_part[t]; i < f->first_part[t + 1]; i++)
            f->facet_of[t] = f->of_part[i] = add_facet(f, parts->parts[i].corners, t);
    }
}

static int compare_covers(const void *x, const void *y)
{
    const cwi_facet_cover *a = x, *b = y;
    if (a->facet != b->facet)
        return a->facet < b->facet ? -1 : 1;
    return a->triangle < b->triangle ? -1 : a->triangle > b->triangle;
}

static bool alloc_facets(const cwi_soup *s, const cwi_triangle_parts *parts, cwi_facets *f)
{
    const size_t count = s->triangle_count + parts->count;
    f->corners = cwi_alloc_array(count, sizeof *f->corners);
    f->sources = cwi_alloc_array(count, sizeof *f->sources);
    f->facet_of = cwi_alloc_array(s->triangle_count, sizeof *f->facet_of);
    f->of_part = cwi_alloc_array(parts->count, sizeof *f->of_part);
    f->first_part = cwi_alloc_array(s->triangle_count + 1, sizeof *f->first_part);
    if (!f->corners || !f->sources || !f->facet_of || !f->of_part || !f->first_part)
        return false;
    for (size_t i = 0; i < parts->count; i++)
        f->of_part[i] = CWI_NOTHING;
    size_t n = 0;
    for (size_t t = 0; t <= s->triangle_count; t++) {
        while (n < parts->count && parts->parts[n].source < t)
            n++;
        f->first_part[t] = n;
    }
    return true;
}

/* Returns true if the triangles of a facet cancel out for each input: the facet parts nothing. */
static bool is_void(const cwi_facets *f, uint32_t facet, const cwi_facet_cover *covers,
                    size_t count, const uint32_t *inputs)
{
    for (size_t n = 0; n <= count; n++) { /* of the input of each triangle */
        const uint32_t input = inputs[n == count ? f->sources[facet] : covers[n].triangle];
        int sum = inputs[f->sources[facet]] == input;
        for (size_t i = 0; i < count; i++)
            sum += inputs[covers[i].triangle] == input ? covers[i].sign : 0;
        if (sum)
            return false;
    }
    return true;
}

/* Drops facets that part nothing, such as where two shells of one mesh touch. */
static bool drop_void(const cwi_soup *s, const cwi_triangle_parts *parts,
                      const uint32_t *inputs, cwi_facets *f)
{
    uint32_t *number = cwi_alloc_array(f->count, sizeof *number);
    size_t count = 0, covers = 0, n = 0;
    if (!number)
        return false;
    for (uint32_t facet = 0; facet < f->count; facet++) {
        const size_t first = n;
        while (n < f->cover_count && f->covers[n].facet == facet)
            n++;
        number[facet] = CWI_NOTHING;
        if (n > first && is_void(f, facet, f->covers + first, n - first, inputs))
            continue;
        number[facet] = (uint32_t)count;
        memmove(f->corners[count], f->corners[facet], sizeof f->corners[0]);
        f->sources[count] = f->sources[facet];
        for (size_t i = first; i < n; i++) {
            f->covers[covers] = f->covers[i];
            f->covers[covers++].facet = (uint32_t)count;
        }
        count++;
    }
    f->count = count;
    f->cover_count = covers;
    for (size_t t = 0; t < s->triangle_count; t++)
        f->facet_of[t] = number[f->facet_of[t]];
    for (size_t i = 0; i < parts->count; i++) {
        f->of_part[i] = f->of_part[i] == CWI_NOTHING ? CWI_NOTHING : number[f->of_part[i]];
        if (f->of_part[i] != CWI_NOTHING)
            f->facet_of[parts->parts[i].source] = f->of_part[i];
    }
    cwi_free(number);
    return true;
}

cw_status cwi_find_facets(const cwi_soup *s, const cwi_meetings *meetings,
                          const cwi_triangle_parts *parts, const uint32_t *inputs,
                          cwi_facets *out, cw_error *err)
{
    pockets p = {.s = s, .parts = parts};
    bool *overlaps = cwi_alloc_zeroed(s->triangle_count, sizeof *overlaps);
    bool done = overlaps && alloc_facets(s, parts, out);
    for (size_t n = 0; n < meetings->count && done; n++)
        if (meetings->pairs[n].overlap)
            overlaps[meetings->pairs[n].a] = overlaps[meetings->pairs[n].b] = true;
    for (uint32_t t = 0; t < s->triangle_count && done; t++)
        if (overlaps[t])
            done = add_pockets(&p, out, t);
    done = done && place_pockets(&p, out);
    if (done) {
        place_others(s, parts, overlaps, out);
        if (out->cover_count) {
            qsort(out->covers, out->cover_count, sizeof *out->covers, compare_covers);
            done = drop_void(s, parts, inputs, out);
        }
    }
    cwi_free(p.pockets);
    cwi_free(p.edges);
    cwi_free(p.members);
    cwi_free(p.slots);
    cwi_free(overlaps);
    if (!done)
        return cwi_fail_memory(err);
    return out->count < INT32_MAX / 3
               ? CW_OK
               : cwi_fail(err, CW_ERR_LIMIT, "the meshes have more than 2^31 / 3 facets");
}

void cwi_facets_free(cwi_facets *f)
{
    cwi_free(f->corners);
    cwi_free(f->sources);
    cwi_free(f->covers);
    cwi_free(f->facet_of);
    cwi_free(f->of_part);
    cwi_free(f->first_part);
    *f = (cwi_facets){0};
}
