/* Points that are defined in several ways, and are at one place. A table of cells of one unit finds those
 * close together; exact coordinates decide. */
#include "simplify/boolean/arrangement.h"

#include "core/base/memory.h"

#include <math.h>
#include <string.h>

/* Points of which each stands for all at its place. */
typedef struct cell_table {
    const cwi_soup *s;
    const cwi_triangle_parts *parts;
    uint32_t *slots; /* 0: free; else 1 + a point */
    size_t mask;
} cell_table;

static cwi_exact_point point_of(const cell_table *t, uint32_t n)
{
    return n < t->s->vertex_count ? cwi_point_vertex(t->s, n)
                                  : t->parts->points[n - t->s->vertex_count];
}

/* Looks in a cell for a point at the place of p. *slot becomes the end of the cell's run. */
static uint32_t find_in_cell(const cell_table *t, const int64_t cell[3],
                             const cwi_exact_point *p, size_t *slot)
{
    for (*slot = cwi_hash_cell(cell) & t->mask; t->slots[*slot];
         *slot = (*slot + 1) & t->mask) {
        const cwi_exact_point q = point_of(t, t->slots[*slot] - 1);
        if (fabs(p->x[0] - q.x[0]) < 0.25 && fabs(p->x[1] - q.x[1]) < 0.25 &&
            fabs(p->x[2] - q.x[2]) < 0.25 && cwi_point_order(t->s, p, &q) == 0)
            return t->slots[*slot] - 1;
    }
    return CWI_NOTHING;
}

/* Returns the point that stands for point n: itself, if it is the first at its place. */
static uint32_t find_same(cell_table *t, uint32_t n)
{
    const cwi_exact_point p = point_of(t, n);
    int64_t low[3], high[3];
    size_t slot;
    for (int k = 0; k < 3; k++) {
        low[k] = (int64_t)floor(p.x[k] - 0.25);
        high[k] = (int64_t)floor(p.x[k] + 0.25);
    }
    for (int c = 0; c < 8; c++) {
        const int64_t cell[3] = {c & 1 ? high[0] : low[0], c & 2 ? high[1] : low[1],
                                 c & 4 ? high[2] : low[2]};
        if ((c & 1 && high[0] == low[0]) || (c & 2 && high[1] == low[1]) ||
            (c & 4 && high[2] == low[2]))
            continue;
        const uint32_t same = find_in_cell(t, cell, &p, &slot);
        if (same != CWI_NOTHING)
            return same;
    }
    const int64_t own[3] = {(int64_t)floor(p.x[0]), (int64_t)floor(p.x[1]),
                            (int64_t)floor(p.x[2])};
    for (slot = cwi_hash_cell(own) & t->mask; t->slots[slot]; slot = (slot + 1) & t->mask) {
    }
    t->slots[slot] = n + 1;
    return n;
}

/* Vertices come first, so that they stand for the others at their place. */
static void number_points(cell_table *t, uint32_t *number, cwi_triangle_parts *parts)
{
    const uint32_t vertices = (uint32_t)t->s->vertex_count;
    for (size_t i = 0; i < parts->count; i++)
        for (int k = 0; k < 3; k++)
            if (parts->parts[i].corners[k] < vertices)
                find_same(t, parts->parts[i].corners[k]);
    for (size_t n = 0; n < parts->point_count; n++)
        number[n] = find_same(t, vertices + (uint32_t)n);
    for (size_t i = 0; i < parts->count; i++)
        for (int k = 0; k < 3; k++)
            if (parts->parts[i].corners[k] >= vertices)
                parts->parts[i].corners[k] = number[parts->parts[i].corners[k] - vertices];
}

cw_status cwi_merge_points(const cwi_soup *s, cwi_triangle_parts *parts, cw_error *err)
{
    size_t capacity = 1024;
    while (capacity < 4 * (parts->point_count + 3 * parts->count / 2))
        capacity *= 2;
    cell_table t = {s, parts, cwi_alloc_zeroed(capacity, sizeof *t.slots), capacity - 1};
    uint32_t *number = cwi_alloc_array(parts->point_count, sizeof *number);
    cw_status st = CW_OK;
    if (t.slots && number)
        number_points(&t, number, parts);
    else
        st = cwi_fail_memory(err);
    cwi_free(number);
    cwi_free(t.slots);
    return st;
}
