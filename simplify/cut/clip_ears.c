/* Cuts ears from a ring [Meisters1975]: triangles of three nodes that follow each other, with no other
 * node in them. Nodes where the ring is not convex are found by a grid. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "simplify/cut/section.h"

#include <math.h>
#include <string.h>

#define NONE UINT32_MAX

enum { STEPS_A_REPORT = 4096, MAX_FORCED = 64 };

/* How strict an ear is: without nodes in it; without nodes in it by more than the tolerance; convex;
 * any. Rounding can make loops touch or cross, and then the first is not enough. */
typedef enum ear_rule { EAR_EMPTY, EAR_NEARLY_EMPTY, EAR_CONVEX, EAR_ANY } ear_rule;

typedef struct ear_work {
    cwi_section *section;
    size_t left;         /* nodes of the ring */
    bool *is_reflex;     /* of the section's nodes: not convex, and not cut off */
    bool is_flipped;     /* triangles are turned over */
    double low[2], cell; /* of the grid */
    size_t dim[2];
    uint32_t *first; /* of its cells: a node */
    uint32_t *after; /* of nodes: the next in the cell */
    size_t gridded;  /* nodes when the grid was made */
} ear_work;

static size_t find_cell(const ear_work *w, int axis, double x)
{
    const double cell = (x - w->low[axis]) / w->cell;
    return cell > 0 ? cell < (double)w->dim[axis] ? (size_t)cell : w->dim[axis] - 1 : 0;
}

static void update_reflex(ear_work *w, uint32_t n)
{
    const cwi_section *s = w->section;
    w->is_reflex[n] = cwi_section_turn(s, s->nodes[n].prev, n, s->nodes[n].next) <= 0;
}

/* Sorts the reflex nodes of a ring into cells, one for each. */
static bool make_grid(ear_work *w, uint32_t start)
{
    const cwi_section *s = w->section;
    double high[2] = {-INFINITY, -INFINITY};
    size_t count = 0;
    w->low[0] = w->low[1] = INFINITY;
    uint32_t n = start;
    do {
        const float *p = cwi_section_point(s, n);
        const double x[2] = {(double)p[s->u], (double)p[s->v]};
        for (int a = 0; a < 2; a++) {
            w->low[a] = fmin(w->low[a], x[a]);
            high[a] = fmax(high[a], x[a]);
        }
        count += w->is_reflex[n];
        n = s->nodes[n].next;
    } while (n != start);
    const double width = high[0] - w->low[0], height = high[1] - w->low[1],
                 target = (double)(count ? count : 1);
    w->cell = fmax(sqrt(width * height / target), fmax(width, height) / target);
    if (!(w->cell > 0))
        w->cell = 1;
    w->dim[0] = (size_t)(width / w->cell) + 1;
    w->dim[1] = (size_t)(height / w->cell) + 1;
    cwi_free(w->first);
    w->first = cwi_alloc_array(w->dim[0] * w->dim[1], sizeof *w->first);
    if (!w->first)
        return false;
    memset(w->first, 0xff, w->dim[0] * w->dim[1] * sizeof *w->first);
    w->gridded = w->left;
    do {
        if (w->is_reflex[n]) {
            const float *p = cwi_section_point(s, n);
            uint32_t *first = w->first + find_cell(w, 0, (double)p[s->u]) +
                              w->dim[0] * find_cell(w, 1, (double)p[s->v]);
            w->after[n] = *first;
            *first = n;
        }
        n = s->nodes[n].next;
    } while (n != start);
    return true;
}

static bool is_same_point(const float *p, const float *q)
{
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

/* Returns true if a node is deeper in an ear than the tolerance. */
static bool is_deep(const cwi_section *s, const uint32_t ear[3], uint32_t n)
{
    const float *p = cwi_section_point(s, n);
    for (int k = 0; k < 3; k++) {
        const float *a = cwi_section_point(s, ear[k]),
                    *b = cwi_section_point(s, ear[(k + 1) % 3]);
        const double u = (double)b[s->u] - (double)a[s->u],
                     v = (double)b[s->v] - (double)a[s->v];
        const double area =
            u * ((double)p[s->v] - (double)a[s->v]) - v * ((double)p[s->u] - (double)a[s->u]);
        if (!(area > s->cut->tolerance * sqrt(u * u + v * v)))
            return false;
    }
    return true;
}

/* Returns true if a node is in a triangle, or on its sides. Nodes at its corners are not: they are
 * twins at the ends of bridges, whose edges lead elsewhere. */
static bool blocks_ear(const cwi_section *s, const uint32_t ear[3], uint32_t n)
{
    const float *p = cwi_section_point(s, n);
    for (int k = 0; k < 3; k++)
        if (n == ear[k] || is_same_point(p, cwi_section_point(s, ear[k])))
            return false;
    for (int k = 0; k < 3; k++)
        if (cwi_section_turn(s, ear[k], ear[(k + 1) % 3], n) < 0)
            return false;
    return true;
}

static bool is_ear_empty(const ear_work *w, const uint32_t ear[3], ear_rule rule)
{
    const cwi_section *s = w->section;
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int k = 0; k < 3; k++) {
        const float *p = cwi_section_point(s, ear[k]);
        const double x[2] = {(double)p[s->u], (double)p[s->v]};
        for (int a = 0; a < 2; a++) {
            low[a] = fmin(low[a], x[a]);
            high[a] = fmax(high[a], x[a]);
        }
    }
    const size_t left = find_cell(w, 0, low[0]), right = find_cell(w, 0, high[0]),
                 top = find_cell(w, 1, high[1]);
    for (size_t y = find_cell(w, 1, low[1]); y <= top; y++)
        for (size_t x = left; x <= right; x++)
            for (uint32_t n = w->first[x + w->dim[0] * y]; n != NONE; n = w->after[n])
                if (w->is_reflex[n] && blocks_ear(s, ear, n) &&
                    (rule == EAR_EMPTY || is_deep(s, ear, n)))
                    return false;
    return true;
}

static bool is_ear(const ear_work *w, uint32_t at, ear_rule rule)
{
    const cwi_section *s = w->section;
    const uint32_t ear[3] = {s->nodes[at].prev, at, s->nodes[at].next};
    if (rule == EAR_ANY)
        return true;
    return !w->is_reflex[at] && (rule == EAR_CONVEX || is_ear_empty(w, ear, rule));
}

static bool add_ear(ear_work *w, uint32_t at)
{
    cwi_section *s = w->section;
    const uint32_t a = s->nodes[s->nodes[at].prev].vertex, b = s->nodes[at].vertex,
                   c = s->nodes[s->nodes[at].next].vertex;
    s->cut->facts.cap_triangles++;
    return w->is_flipped ? cwi_cut_add_triangle(s->cut, c, b, a)
                         : cwi_cut_add_triangle(s->cut, a, b, c);
}

/* Cuts ears in turns around the ring, not next to each other, so that triangles grow evenly. Without
 * an ear in a whole turn the rule gets weaker for one. */
static bool clip_ring(ear_work *w, uint32_t at, cw_status *st, cw_error *err)
{
    cwi_section *s = w->section;
    const double total = (double)w->left;
    ear_rule rule = EAR_EMPTY;
    size_t idle = 0, forced[4] = {0}, steps = 0;
    while (w->left > 3) {
        if (++steps % STEPS_A_REPORT == 0)
            *st = cwi_progress(&s->cut->desc.progress, "fill",
                               1 - 0.4 * (double)w->left / total, err);
        if (*st != CW_OK)
            return true;
        const uint32_t prev = s->nodes[at].prev, next = s->nodes[at].next;
        if (!is_ear(w, at, rule)) {
            at = next;
            if (++idle > w->left) {
                rule = rule < EAR_ANY ? rule + 1 : EAR_ANY;
                idle = 0;
            }
            continue;
        }
        if (!add_ear(w, at))
            return false;
        s->nodes[prev].next = next;
        s->nodes[next].prev = prev;
        w->is_reflex[at] = false;
        update_reflex(w, prev);
        update_reflex(w, next);
        w->left--;
        idle = 0;
        forced[rule]++;
        rule = forced[EAR_CONVEX] + forced[EAR_ANY] > MAX_FORCED ? EAR_CONVEX
               : forced[EAR_NEARLY_EMPTY] > MAX_FORCED           ? EAR_NEARLY_EMPTY
                                                                 : EAR_EMPTY;
        at = s->nodes[next].next;
        if (w->left < w->gridded / 2 && !make_grid(w, at))
            return false;
    }
    return add_ear(w, at);
}

/* Runs around a ring the other way, and turns its triangles over. */
static void reverse_ring(cwi_section *s, uint32_t start)
{
    uint32_t n = start;
    do {
        cwi_section_node *node = s->nodes + n;
        const uint32_t next = node->next;
        node->next = node->prev;
        node->prev = next;
        n = next;
    } while (n != start);
}

cw_status cwi_section_clip_ears(cwi_section *s, const cwi_section_loop *loop, cw_error *err)
{
    ear_work w = {.section = s, .is_flipped = loop->is_free};
    const uint32_t start = loop->begin;
    cw_status st = CW_OK;
    w.is_reflex = cwi_alloc_array(s->node_count, sizeof *w.is_reflex);
    w.after = cwi_alloc_array(s->node_count, sizeof *w.after);
    bool ok = w.is_reflex && w.after;
    if (loop->is_free)
        reverse_ring(s, start);
    if (ok) {
        uint32_t n = start;
        do {
            update_reflex(&w, n);
            w.left++;
            n = s->nodes[n].next;
        } while (n != start);
        ok = make_grid(&w, start) && clip_ring(&w, start, &st, err);
    }
    cwi_free(w.is_reflex);
    cwi_free(w.after);
    cwi_free(w.first);
    return ok ? st : cwi_fail_memory(err);
}
