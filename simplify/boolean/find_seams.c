/* The lines and points in which triangles meet. Two planes cross in a line; on it each triangle has an
 * interval, and the seam is what both have. In a common plane edges of each are clipped by the other. */
#include "simplify/boolean/arrangement.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"

#include <stdlib.h>

enum {
    CHUNK = 256,   /* pairs that a thread does at a time */
    BATCH = 65536, /* pairs whose seams are kept with whole points */
    MAX_SEAMS = 6  /* of a pair: each edge clipped by the other triangle */
};

/* A seam before its points have numbers. */
typedef struct raw_seam {
    cwi_exact_point p, q;
    uint32_t triangle, on[2];
} raw_seam;

typedef struct batch {
    const cwi_soup *s;
    const cwi_meeting *pairs;
    size_t count;
    raw_seam (*seams)[MAX_SEAMS];
    uint8_t *seam_count;
} batch;

static bool has_corner(const cwi_soup *s, uint32_t t, const cwi_exact_point *p)
{
    const uint32_t *v = s->triangles[t];
    return p->kind == CWI_VERTEX &&
           (p->ref[0] == v[0] || p->ref[0] == v[1] || p->ref[0] == v[2]);
}

/* Adds a seam of a triangle, unless it is one of the triangle's corners or edges. */
static void add_seam(const batch *b, size_t n, uint32_t t, const cwi_exact_point *p,
                     const cwi_exact_point *q, uint32_t on0, uint32_t on1)
{
    if (!has_corner(b->s, t, p) || !has_corner(b->s, t, q))
        b->seams[n][b->seam_count[n]++] = (raw_seam){*p, *q, t, {on0, on1}};
}

/* --- planes that cross -------------------------------------------------------------------- */

/* Finds the interval of triangle t on the plane of u, in the order of points; false: there is none. */
static bool find_interval(const cwi_soup *s, uint32_t t, uint32_t u, cwi_exact_point ends[2])
{
    const uint32_t *v = s->triangles[t];
    int side[3], count = 0;
    for (int k = 0; k < 3; k++) {
        const uint32_t *c = s->triangles[u];
        side[k] = v[k] == c[0] || v[k] == c[1] || v[k] == c[2] ? 0 : cwi_soup_side(s, u, v[k]);
    }
    for (int k = 0; k < 3 && count < 2; k++) {
        const int next = (k + 1) % 3;
        if (side[k] == 0)
            ends[count++] = cwi_point_vertex(s, v[k]);
        else if (side[k] * side[next] < 0)
            ends[count++] = cwi_point_line_plane(s, v[k], v[next], u);
    }
    if (count == 1)
        ends[1] = ends[0];
    if (count == 2 && cwi_point_order(s, &ends[0], &ends[1]) > 0) {
        const cwi_exact_point first = ends[1];
        ends[1] = ends[0];
        ends[0] = first;
    }
    return count;
}

/* Returns the later of two points if sign is 1, the earlier if it is -1; of equal ones a vertex. */
static const cwi_exact_point *choose(const cwi_soup *s, const cwi_exact_point *p,
                                     const cwi_exact_point *q, int sign)
{
    const int order = sign * cwi_point_order(s, p, q);
    return order > 0 || (order == 0 && p->kind <= q->kind) ? p : q;
}

static void cross_planes(const batch *b, size_t n)
{
    const cwi_soup *s = b->s;
    const uint32_t t = b->pairs[n].a, u = b->pairs[n].b;
    cwi_exact_point first[2], second[2];
    if (!find_interval(s, t, u, first) || !find_interval(s, u, t, second))
        return;
    const cwi_exact_point *low = choose(s, &first[0], &second[0], 1);
    const cwi_exact_point *high = choose(s, &first[1], &second[1], -1);
    const int order = cwi_point_order(s, low, high);
    if (order > 0)
        return;
    if (order == 0)
        low = high = low->kind <= high->kind ? low : high;
    add_seam(b, n, t, low, high, u, CWI_NOTHING);
    add_seam(b, n, u, low, high, t, CWI_NOTHING);
}

/* --- a common plane ----------------------------------------------------------------------- */

/* The point at which an edge crosses the line of another one. */
static cwi_exact_point cross_edges(const cwi_soup *s, const uint32_t edge[2], uint32_t v0,
                                   uint32_t v1, int axis)
{
    if (cwi_soup_turn(s, edge[0], edge[1], v0, axis) == 0)
        return cwi_point_vertex(s, v0);
    if (cwi_soup_turn(s, edge[0], edge[1], v1, axis) == 0)
        return cwi_point_vertex(s, v1);
    return cwi_point_line_line(s, (const uint32_t[4]){edge[0], edge[1], v0, v1}, axis);
}

/* Clips an edge by a triangle in its plane; false: nothing is left. */
static bool clip_edge(const cwi_soup *s, const uint32_t edge[2], uint32_t t, int axis,
                      cwi_exact_point ends[2])
{
    const uint32_t *v = s->triangles[t];
    const int turn = cwi_soup_turn(s, v[0], v[1], v[2], axis);
    ends[0] = cwi_point_vertex(s, edge[0]);
    ends[1] = cwi_point_vertex(s, edge[1]);
    const int forward = -cwi_point_order(s, &ends[0], &ends[1]); /* 1: points rise along it */
    for (int e = 0; e < 3; e++) {
        const uint32_t v0 = v[e], v1 = v[(e + 1) % 3];
        const int first = turn * cwi_soup_turn(s, v0, v1, edge[0], axis);
        const int last = turn * cwi_soup_turn(s, v0, v1, edge[1], axis);
        if (first < 0 && last < 0)
            return false;
        if (first >= 0 && last >= 0)
            continue;
        const cwi_exact_point cut = first == 0  ? cwi_point_vertex(s, edge[0])
                                    : last == 0 ? cwi_point_vertex(s, edge[1])
                                                : cross_edges(s, edge, v0, v1, axis);
        cwi_exact_point *end = first < 0 ? &ends[0] : &ends[1];
        *end = *choose(s, end, &cut, first < 0 ? forward : -forward);
    }
    const int order = forward * cwi_point_order(s, &ends[0], &ends[1]);
    if (order == 0)
        ends[ends[0].kind <= ends[1].kind] = ends[ends[0].kind > ends[1].kind];
    return order <= 0;
}

static void clip_edges(const batch *b, size_t n, uint32_t t, uint32_t u)
{
    const uint32_t *v = b->s->triangles[u];
    const int axis = cwi_soup_axis(b->s, t);
    for (int e = 0; e < 3; e++) {
        const uint32_t edge[2] = {v[e], v[(e + 1) % 3]};
        cwi_exact_point ends[2];
        if (clip_edge(b->s, edge, t, axis, ends))
            add_seam(b, n, t, &ends[0], &ends[1], edge[0], edge[1]);
    }
}

/* --- numbers of points -------------------------------------------------------------------- */

/* Points by what defines them: a hash table of numbers. */
typedef struct point_table {
    uint32_t *slots; /* 0: free; else 1 + a number */
    size_t capacity; /* a power of two */
    size_t room;     /* of the points */
} point_table;

static uint64_t hash_point(const cwi_exact_point *p)
{
    uint64_t hash = p->kind;
    for (int k = 0; k < 4; k++)
        hash = (hash ^ p->ref[k]) * UINT64_C(0x9E3779B97F4A7C15), hash ^= hash >> 29;
    return hash;
}

static bool is_same_definition(const cwi_exact_point *p, const cwi_exact_point *q)
{
    return p->kind == q->kind && p->ref[0] == q->ref[0] && p->ref[1] == q->ref[1] &&
           p->ref[2] == q->ref[2] && p->ref[3] == q->ref[3];
}

static size_t find_slot(const point_table *table, const cwi_seams *out,
                        const cwi_exact_point *p)
{
    size_t slot = hash_point(p) & (table->capacity - 1);
    while (table->slots[slot] && !is_same_definition(&out->points[table->slots[slot] - 1], p))
        slot = (slot + 1) & (table->capacity - 1);
    return slot;
}

static bool grow_table(point_table *table, cwi_seams *out)
{
    const size_t capacity = table->capacity ? 2 * table->capacity : 1024;
    cwi_exact_point *points = cwi_realloc_array(out->points, capacity / 2, sizeof *points);
    if (points)
        out->points = points;
    uint32_t *slots = points ? cwi_alloc_zeroed(capacity, sizeof *slots) : NULL;
    if (!slots)
        return false;
    cwi_free(table->slots);
    *table = (point_table){slots, capacity, capacity / 2};
    for (size_t n = 0; n < out->point_count; n++)
        table->slots[find_slot(table, out, &out->points[n])] = (uint32_t)n + 1;
    return true;
}

/* Returns the number of a point; CWI_NOTHING when memory is out. */
static uint32_t number_point(const cwi_soup *s, point_table *table, cwi_seams *out,
                             const cwi_exact_point *p)
{
    if (p->kind == CWI_VERTEX)
        return p->ref[0];
    if (out->point_count == table->room && !grow_table(table, out))
        return CWI_NOTHING;
    const size_t slot = find_slot(table, out, p);
    if (!table->slots[slot]) {
        out->points[out->point_count++] = *p;
        table->slots[slot] = (uint32_t)out->point_count;
    }
    return (uint32_t)s->vertex_count + table->slots[slot] - 1;
}

/* --- all pairs ---------------------------------------------------------------------------- */

static void do_chunk(void *context, size_t k)
{
    const batch *b = context;
    for (size_t n = k * CHUNK; n < (k + 1) * CHUNK && n < b->count; n++) {
        b->seam_count[n] = 0;
        if (b->pairs[n].coplanar) {
            clip_edges(b, n, b->pairs[n].a, b->pairs[n].b);
            clip_edges(b, n, b->pairs[n].b, b->pairs[n].a);
        } else
            cross_planes(b, n);
    }
}

static bool keep_seams(const batch *b, point_table *table, size_t *room, cwi_seams *out)
{
    for (size_t n = 0; n < b->count; n++)
        for (int i = 0; i < b->seam_count[n]; i++) {
            const raw_seam *raw = &b->seams[n][i];
            if (out->count == *room) {
                *room = *room ? 2 * *room : 1024;
                cwi_triangle_seam *seams = cwi_realloc_array(out->seams, *room, sizeof *seams);
                if (!seams)
                    return false;
                out->seams = seams;
            }
            const uint32_t p = number_point(b->s, table, out, &raw->p);
            const uint32_t q = number_point(b->s, table, out, &raw->q);
            if (p == CWI_NOTHING || q == CWI_NOTHING)
                return false;
            out->seams[out->count++] =
                (cwi_triangle_seam){raw->triangle, p, q, {raw->on[0], raw->on[1]}};
        }
    return true;
}

static int compare_seams(const void *x, const void *y)
{
    const cwi_triangle_seam *a = x, *b = y;
    const uint32_t keys[2][5] = {{a->triangle, a->p, a->q, a->on[0], a->on[1]},
                                 {b->triangle, b->p, b->q, b->on[0], b->on[1]}};
    for (int k = 0; k < 5; k++)
        if (keys[0][k] != keys[1][k])
            return keys[0][k] < keys[1][k] ? -1 : 1;
    return 0;
}

static cw_status do_batches(batch *b, const cwi_meetings *meetings, int threads,
                            const cw_progress *progress, cwi_seams *out, cw_error *err)
{
    point_table table = {0};
    size_t room = 0;
    cw_status st = CW_OK;
    for (size_t first = 0; first < meetings->count && st == CW_OK; first += BATCH) {
        b->pairs = meetings->pairs + first;
        b->count = meetings->count - first < BATCH ? meetings->count - first : BATCH;
        cwi_parallel_for_all((b->count + CHUNK - 1) / CHUNK, CHUNK * 512, threads, do_chunk, b);
        if (!keep_seams(b, &table, &room, out))
            st = cwi_fail_memory(err);
        else
            st = cwi_progress(progress, "intersecting",
                              (double)(first + b->count) / (double)meetings->count, err);
    }
    cwi_free(table.slots);
    return st;
}

cw_status cwi_find_seams(const cwi_soup *s, const cwi_meetings *meetings, int threads,
                         const cw_progress *progress, cwi_seams *out, cw_error *err)
{
    const size_t most = meetings->count < BATCH ? meetings->count : BATCH;
    batch b = {.s = s,
               .seams = cwi_alloc_array(most, sizeof *b.seams),
               .seam_count = cwi_alloc_array(most, 1)};
    cw_status st = b.seams && b.seam_count
                       ? do_batches(&b, meetings, threads, progress, out, err)
                       : cwi_fail_memory(err);
    if (st == CW_OK && out->count)
        qsort(out->seams, out->count, sizeof *out->seams, compare_seams);
    cwi_free(b.seams);
    cwi_free(b.seam_count);
    return st;
}
