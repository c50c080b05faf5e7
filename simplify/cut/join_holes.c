/* Joins holes of a section to the loops around them [Eberly2008]. From the leftmost vertex of a hole,
 * the nearest edge to the left belongs to the loop around it, or to a hole that is already joined.
 * Edges are found by rows. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "simplify/cut/section.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NONE UINT32_MAX

enum { HOLES_A_REPORT = 64 };

/* Mean number of rows that an edge may span. */
static const double MAX_MEAN_SPAN = 4;

/* An edge from a node to the next, in a row that it passes. */
typedef struct row_entry {
    uint32_t node, after;
} row_entry;

typedef struct section_rows {
    cwi_section *section;
    double low, height; /* v of the first row, and the height of rows */
    size_t count;
    uint32_t *first; /* count: entries */
    row_entry *entries;
    size_t entry_count, entry_capacity;
} section_rows;

static double coordinate_u(const cwi_section *s, uint32_t node)
{
    return (double)cwi_section_point(s, node)[s->u];
}

static double coordinate_v(const cwi_section *s, uint32_t node)
{
    return (double)cwi_section_point(s, node)[s->v];
}

static size_t find_row(const section_rows *r, double v)
{
    const double row = (v - r->low) / r->height;
    return row > 0 ? row < (double)r->count ? (size_t)row : r->count - 1 : 0;
}

static bool add_edge_to_rows(section_rows *r, uint32_t node)
{
    const cwi_section *s = r->section;
    const double a = coordinate_v(s, node), b = coordinate_v(s, s->nodes[node].next);
    const size_t last = find_row(r, fmax(a, b));
    for (size_t row = find_row(r, fmin(a, b)); row <= last; row++) {
        void *grown =
            cwi_grow_array(r->entries, r->entry_count, &r->entry_capacity, sizeof *r->entries);
        if (!grown)
            return false;
        r->entries = grown;
        r->entries[r->entry_count] = (row_entry){node, r->first[row]};
        r->first[row] = (uint32_t)r->entry_count++;
    }
    return true;
}

static bool make_rows(section_rows *r)
{
    const cwi_section *s = r->section;
    double low = INFINITY, high = -INFINITY, length = 0;
    for (uint32_t n = 0; n < s->node_count; n++) {
        const double v = coordinate_v(s, n);
        low = fmin(low, v);
        high = fmax(high, v);
        length += fabs(coordinate_v(s, s->nodes[n].next) - v);
    }
    const double max_rows = MAX_MEAN_SPAN * (double)s->node_count * (high - low) / length;
    const double rows = fmin(2 * sqrt((double)s->node_count), max_rows);
    r->count = rows > 1 ? (size_t)rows : 1;
    r->low = low;
    r->height = high > low ? (high - low) / (double)r->count : 1;
    r->first = cwi_alloc_array(r->count, sizeof *r->first);
    if (!r->first)
        return false;
    memset(r->first, 0xff, r->count * sizeof *r->first);
    for (uint32_t n = 0; n < s->node_count; n++)
        if (!add_edge_to_rows(r, n))
            return false;
    return true;
}

/* Finds the nearest edge to the left of a hole's leftmost node, and sets where it is met. Edges are met
 * a little above the row of that node: of edges from one place, the one that leans most to the right
 * counts; of the two edges of a bridge, the one that runs down. Returns its node; NONE where there
 * is none. */
static uint32_t find_edge(const section_rows *r, uint32_t from, double *met)
{
    const cwi_section *s = r->section;
    const double u = coordinate_u(s, from), v = coordinate_v(s, from);
    double best_lean = 0;
    uint32_t best = NONE;
    *met = -INFINITY;
    for (uint32_t e = r->first[find_row(r, v)]; e != NONE; e = r->entries[e].after) {
        const uint32_t a = r->entries[e].node, b = s->nodes[a].next;
        const double av = coordinate_v(s, a), bv = coordinate_v(s, b);
        if ((av > v) == (bv > v) || s->nodes[a].loop == s->nodes[from].loop)
            continue;
        const bool falls = av > bv;
        const double low_u = coordinate_u(s, falls ? b : a), low_v = falls ? bv : av;
        const double lean = (coordinate_u(s, falls ? a : b) - low_u) / fabs(av - bv),
                     at = low_u + (v - low_v) * lean;
        const bool is_right = at > *met || (at == *met && lean > best_lean);
        if (at <= u && (is_right || (at == *met && lean == best_lean && falls))) {
            *met = at;
            best = a;
            best_lean = lean;
        }
    }
    return best;
}

/* Returns true if a node is seen from its place in the ring: within the angle of the ring there. */
static bool is_in_angle(const cwi_section *s, uint32_t at, uint32_t seen)
{
    const uint32_t prev = s->nodes[at].prev, next = s->nodes[at].next;
    const bool first = cwi_section_turn(s, prev, at, seen) >= 0,
               second = cwi_section_turn(s, at, next, seen) >= 0;
    return cwi_section_turn(s, prev, at, next) > 0 ? first && second : first || second;
}

/* Returns the node to which the bridge goes: the left end of the edge that was met, or the node
 * nearest in angle to the row among those that hide it. */
static uint32_t find_bridge_end(const section_rows *r, uint32_t from, uint32_t edge, double met)
{
    const cwi_section *s = r->section;
    const double u = coordinate_u(s, from), v = coordinate_v(s, from);
    const uint32_t next = s->nodes[edge].next;
    uint32_t best = coordinate_u(s, edge) < coordinate_u(s, next) ? edge : next;
    const double end_u = coordinate_u(s, best), end_v = coordinate_v(s, best);
    double best_u = end_u, slope = fabs(end_v - v) / (u - end_u);
    if (end_v == v || met >= u)
        return best;
    const size_t last = find_row(r, fmax(end_v, v));
    for (size_t row = find_row(r, fmin(end_v, v)); row <= last; row++)
        for (uint32_t e = r->first[row]; e != NONE; e = r->entries[e].after) {
            const uint32_t n = r->entries[e].node;
            const double x = coordinate_u(s, n), y = coordinate_v(s, n);
            if (!(x < u) || x < end_u || s->nodes[n].loop == s->nodes[from].loop)
                continue;
            /* inside of the triangle of from, where the edge is met, and the edge's end */
            const double fraction = (y - v) / (end_v - v);
            if (!(fraction >= 0 && fraction <= 1) || x < met + fraction * (end_u - met) ||
                x > u + fraction * (end_u - u))
                continue;
            const double angle = fabs(y - v) / (u - x);
            if ((angle < slope || (angle == slope && x > best_u)) && is_in_angle(s, n, from)) {
                best = n;
                best_u = x;
                slope = angle;
            }
        }
    return best;
}

/* Joins the ring of a hole to another at two nodes. Both get a second node, whose edges are the
 * bridge; the first ones keep their edges to the next node. */
static bool add_bridge(section_rows *r, uint32_t from, uint32_t to)
{
    cwi_section *s = r->section;
    const uint32_t to_twin = (uint32_t)s->node_count++, from_twin = (uint32_t)s->node_count++;
    cwi_section_node *n = s->nodes;
    n[to_twin] = (cwi_section_node){n[to].vertex, from, n[to].prev, n[to].loop};
    n[from_twin] = (cwi_section_node){n[from].vertex, to, n[from].prev, n[from].loop};
    n[n[to].prev].next = to_twin;
    n[n[from].prev].next = from_twin;
    n[to].prev = from_twin;
    n[from].prev = to_twin;
    return add_edge_to_rows(r, to_twin) && add_edge_to_rows(r, from_twin);
}

/* The leftmost node of a hole. */
typedef struct hole_start {
    float u, v;
    uint32_t loop;
} hole_start;

static int compare_starts(const void *a, const void *b)
{
    const hole_start *x = a, *y = b;
    if (x->u != y->u)
        return x->u < y->u ? -1 : 1;
    if (x->v != y->v)
        return x->v < y->v ? -1 : 1;
    return (x->loop > y->loop) - (x->loop < y->loop);
}

static bool join_hole(section_rows *r, cwi_section_loop *hole)
{
    cwi_section *s = r->section;
    double met;
    const uint32_t from = hole->leftmost, edge = find_edge(r, from, &met);
    hole->is_free = edge == NONE || s->loops[s->nodes[edge].loop].is_free ||
                    coordinate_v(s, edge) < coordinate_v(s, s->nodes[edge].next);
    hole->is_joined = !hole->is_free;
    return hole->is_free || add_bridge(r, from, find_bridge_end(r, from, edge, met));
}

cw_status cwi_section_join_holes(cwi_section *s, cw_error *err)
{
    section_rows rows = {.section = s};
    size_t count = 0;
    hole_start *starts = cwi_alloc_array(s->loop_count, sizeof *starts);
    bool ok = starts && make_rows(&rows);
    for (uint32_t n = 0; n < s->loop_count && ok; n++)
        if (s->loops[n].area < 0) {
            const float *p = cwi_section_point(s, s->loops[n].leftmost);
            starts[count++] = (hole_start){p[s->u], p[s->v], n};
        }
    if (ok && count)
        qsort(starts, count, sizeof *starts, compare_starts);
    cw_status st = CW_OK;
    for (size_t n = 0; n < count && ok && st == CW_OK; n++) {
        if (n % HOLES_A_REPORT == 0)
            st = cwi_progress(&s->cut->desc.progress, "fill",
                              0.5 + 0.1 * (double)n / (double)count, err);
        ok = join_hole(&rows, s->loops + starts[n].loop);
    }
    cwi_free(starts);
    cwi_free(rows.first);
    cwi_free(rows.entries);
    return ok ? st : cwi_fail_memory(err);
}
