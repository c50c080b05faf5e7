/* Cuts ears from a ring [Meisters1975]: triangles of three nodes that follow each other, with no other
 * node in them. Nodes where the ring is not convex are found by a tree. */
#include "core/mesh/clip_ears.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <string.h>

#define NONE UINT32_MAX

enum { STEPS_A_REPORT = 4096, MAX_FORCED = 64, LEAF = 8 };

/* How strict an ear is: without nodes in it; without nodes in it by more than the tolerance; convex;
 * any. Rounding can make loops touch or cross, and then the first is not enough. */
typedef enum ear_rule { EAR_EMPTY, EAR_NEARLY_EMPTY, EAR_CONVEX, EAR_ANY } ear_rule;

typedef struct ear_work {
    cwi_ears *ears;
    int u, v;        /* axes of the plane */
    size_t left;     /* nodes of the ring */
    bool *is_reflex; /* of the section's nodes: not convex, and not cut off */
    uint32_t *items; /* the nodes that were reflex when the tree was made, in its order */
    size_t item_count;
    double (*boxes)
        [4]; /* of the tree: lows and highs along u and v. Branch 1 has all items, branch k
                           parts in the middle into 2 k and 2 k + 1 */
    size_t sorted; /* nodes of the ring when the tree was made */
    uint32_t *ahead,
        *behind; /* of candidates for ears: the next and the previous one around the ring */
    bool *is_candidate; /* others were no ears, and their neighbours are still the same */
    size_t candidates;
} ear_work;

static const float *point_of(const cwi_ears *e, uint32_t node)
{
    return e->positions + 3 * (size_t)e->nodes[node].vertex;
}

/* Returns 1 when three nodes turn against the clock, -1 with it, 0 when they are on one line. */
static int turn_at(const cwi_ears *e, uint32_t a, uint32_t b, uint32_t c)
{
    return e->direction * cwi_orient2d(point_of(e, a), point_of(e, b), point_of(e, c), e->axis);
}

static void update_reflex(ear_work *w, uint32_t n)
{
    const cwi_ears *s = w->ears;
    w->is_reflex[n] = turn_at(s, s->nodes[n].prev, n, s->nodes[n].next) <= 0;
}

static double coordinate(const ear_work *w, uint32_t node, int axis)
{
    return (double)point_of(w->ears, node)[axis];
}

/* Moves the items below a middle one along an axis before it, and the others behind. */
static void part_items(ear_work *w, size_t begin, size_t end, size_t middle, int axis)
{
    uint32_t *items = w->items;
    ptrdiff_t first = (ptrdiff_t)begin, last = (ptrdiff_t)end - 1;
    const ptrdiff_t wanted = (ptrdiff_t)middle;
    while (first < last) {
        const double pivot = coordinate(w, items[wanted], axis);
        ptrdiff_t i = first, j = last;
        while (i <= j) {
            while (coordinate(w, items[i], axis) < pivot)
                i++;
            while (coordinate(w, items[j], axis) > pivot)
                j--;
            if (i > j)
                break;
            const uint32_t kept = items[i];
            items[i++] = items[j];
            items[j--] = kept;
        }
        if (j < wanted)
            first = i;
        if (wanted < i)
            last = j;
    }
}

/* Sorts items into a branch of the tree, along the longer side of their box. */
static void fill_branch(ear_work *w, size_t branch, size_t first, size_t end)
{
    double *box = w->boxes[branch];
    box[0] = box[1] = INFINITY;
    box[2] = box[3] = -INFINITY;
    for (size_t i = first; i < end; i++)
        for (int a = 0; a < 2; a++) {
            const double x = coordinate(w, w->items[i], a ? w->v : w->u);
            box[a] = fmin(box[a], x);
            box[2 + a] = fmax(box[2 + a], x);
        }
    if (end - first <= LEAF)
        return;
    const size_t middle = first + (end - first) / 2;
    part_items(w, first, end, middle, box[2] - box[0] >= box[3] - box[1] ? w->u : w->v);
    fill_branch(w, 2 * branch, first, middle);
    fill_branch(w, 2 * branch + 1, middle, end);
}

/* Makes the tree of the reflex nodes of a ring. */
static bool make_tree(ear_work *w, uint32_t start)
{
    const cwi_ears *s = w->ears;
    uint32_t n = start;
    size_t branches = 2;
    w->item_count = 0;
    w->sorted = w->left;
    do {
        if (w->is_reflex[n])
            w->items[w->item_count++] = n;
        n = s->nodes[n].next;
    } while (n != start);
    for (size_t most = w->item_count; most > LEAF; most -= most / 2)
        branches *= 2;
    cwi_free(w->boxes);
    w->boxes = cwi_alloc_array(branches, sizeof *w->boxes);
    if (w->boxes)
        fill_branch(w, 1, 0, w->item_count);
    return w->boxes;
}

static bool is_same_point(const float *p, const float *q)
{
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

/* Returns true if a node is deeper in an ear than the tolerance. */
static bool is_deep(const ear_work *w, const uint32_t ear[3], uint32_t n)
{
    const cwi_ears *s = w->ears;
    const float *p = point_of(s, n);
    for (int k = 0; k < 3; k++) {
        const float *a = point_of(s, ear[k]), *b = point_of(s, ear[(k + 1) % 3]);
        const double u = (double)b[w->u] - (double)a[w->u],
                     v = (double)b[w->v] - (double)a[w->v];
        const double area =
            u * ((double)p[w->v] - (double)a[w->v]) - v * ((double)p[w->u] - (double)a[w->u]);
        if (!(area > s->tolerance * sqrt(u * u + v * v)))
            return false;
    }
    return true;
}

/* Returns true if a node is in a triangle, or on its sides. Nodes at its corners are not: they are
 * twins at the ends of bridges, whose edges lead elsewhere. */
static bool blocks_ear(const ear_work *w, const uint32_t ear[3], uint32_t n)
{
    const cwi_ears *s = w->ears;
    const float *p = point_of(s, n);
    for (int k = 0; k < 3; k++)
        if (n == ear[k] || is_same_point(p, point_of(s, ear[k])))
            return false;
    for (int k = 0; k < 3; k++)
        if (turn_at(s, ear[k], ear[(k + 1) % 3], n) < 0)
            return false;
    return true;
}

/* Returns true if a box lies outside of an ear, beyond one of its sides. */
static bool is_box_apart(const ear_work *w, const uint32_t ear[3], const double box[4])
{
    for (int k = 0; k < 3; k++) {
        const uint32_t from = ear[k], to = ear[(k + 1) % 3];
        const double x = coordinate(w, from, w->u), y = coordinate(w, from, w->v);
        const double along = coordinate(w, to, w->u) - x, up = coordinate(w, to, w->v) - y;
        const double left = along * ((along > 0 ? box[3] : box[1]) - y);
        const double right = up * ((up > 0 ? box[0] : box[2]) - x);
        if (left - right < -0x1p-50 * (fabs(left) + fabs(right)))
            return true;
    }
    return false;
}

/* Returns true if no node of a branch of the tree is in an ear. */
static bool is_branch_clear(const ear_work *w, const uint32_t ear[3], ear_rule rule,
                            size_t branch, size_t first, size_t end)
{
    const size_t middle = first + (end - first) / 2;
    if (first == end || is_box_apart(w, ear, w->boxes[branch]))
        return true;
    if (end - first > LEAF)
        return is_branch_clear(w, ear, rule, 2 * branch, first, middle) &&
               is_branch_clear(w, ear, rule, 2 * branch + 1, middle, end);
    for (size_t i = first; i < end; i++) {
        const uint32_t n = w->items[i];
        if (w->is_reflex[n] && blocks_ear(w, ear, n) &&
            (rule == EAR_EMPTY || is_deep(w, ear, n)))
            return false;
    }
    return true;
}

static bool is_ear(const ear_work *w, uint32_t at, ear_rule rule)
{
    const cwi_ears *s = w->ears;
    const uint32_t ear[3] = {s->nodes[at].prev, at, s->nodes[at].next};
    if (rule == EAR_ANY)
        return true;
    return !w->is_reflex[at] &&
           (rule == EAR_CONVEX || is_branch_clear(w, ear, rule, 1, 0, w->item_count));
}

static bool add_ear(ear_work *w, uint32_t at)
{
    const cwi_ears *s = w->ears;
    const uint32_t a = s->nodes[s->nodes[at].prev].vertex, b = s->nodes[at].vertex,
                   c = s->nodes[s->nodes[at].next].vertex;
    return s->is_flipped ? s->add(s->user, c, b, a) : s->add(s->user, a, b, c);
}

/* Makes candidates of all nodes of the ring. */
static void take_all(ear_work *w, uint32_t start)
{
    const cwi_ring_node *nodes = w->ears->nodes;
    uint32_t n = start;
    w->candidates = 0;
    do {
        w->ahead[n] = nodes[n].next;
        w->behind[n] = nodes[n].prev;
        w->is_candidate[n] = true;
        w->candidates++;
        n = nodes[n].next;
    } while (n != start);
}

static void drop_candidate(ear_work *w, uint32_t n)
{
    w->ahead[w->behind[n]] = w->ahead[n];
    w->behind[w->ahead[n]] = w->behind[n];
    w->is_candidate[n] = false;
    w->candidates--;
}

/* Puts a node behind a candidate. */
static void take_candidate(ear_work *w, uint32_t n, uint32_t behind)
{
    if (w->is_candidate[n])
        return;
    w->behind[n] = behind;
    w->ahead[n] = w->ahead[behind];
    w->behind[w->ahead[n]] = n;
    w->ahead[behind] = n;
    w->is_candidate[n] = true;
    w->candidates++;
}

/* Cuts an ear off: its neighbours become candidates. Returns the candidate to go on with, which is not next
 * to the ear. */
static uint32_t cut_ear(ear_work *w, uint32_t at)
{
    cwi_ring_node *nodes = w->ears->nodes;
    const uint32_t prev = nodes[at].prev, next = nodes[at].next;
    take_candidate(w, prev, w->behind[at]);
    take_candidate(w, next, at);
    drop_candidate(w, at);
    nodes[prev].next = next;
    nodes[next].prev = prev;
    w->is_reflex[at] = false;
    update_reflex(w, prev);
    update_reflex(w, next);
    w->left--;
    return w->ahead[next];
}

/* Cuts ears in turns around the ring, not next to each other, so that triangles grow evenly. A node that
 * was no ear is looked at again when a neighbour of it was cut off, and all are when none is left; without an
 * ear then the rule gets weaker for one. */
static bool clip_ring(ear_work *w, uint32_t at, cw_status *st, cw_error *err)
{
    cwi_ears *s = w->ears;
    const double total = (double)w->left;
    ear_rule rule = EAR_EMPTY;
    size_t forced[4] = {0}, steps = 0;
    bool is_whole_turn = true; /* all nodes were candidates, and no ear was found since */
    take_all(w, at);
    while (w->left > 3) {
        if (++steps % STEPS_A_REPORT == 0 && s->progress)
            *st = cwi_progress(s->progress, "fill", 1 - 0.4 * (double)w->left / total, err);
        if (*st != CW_OK)
            return true;
        if (!is_ear(w, at, rule)) {
            const uint32_t after = w->ahead[at];
            if (w->candidates > 1) {
                drop_candidate(w, at);
                at = after;
                continue;
            }
            rule = is_whole_turn && rule < EAR_ANY ? rule + 1 : rule;
            is_whole_turn = true;
            at = s->nodes[at].next;
            take_all(w, at);
            continue;
        }
        if (!add_ear(w, at))
            return false;
        at = cut_ear(w, at);
        is_whole_turn = rule != EAR_EMPTY;
        forced[rule]++;
        rule = forced[EAR_CONVEX] + forced[EAR_ANY] > MAX_FORCED ? EAR_CONVEX
               : forced[EAR_NEARLY_EMPTY] > MAX_FORCED           ? EAR_NEARLY_EMPTY
                                                                 : EAR_EMPTY;
        if (is_whole_turn) /* others may be ears by the stricter rule now */
            take_all(w, at);
        if (w->left < w->sorted / 2 && !make_tree(w, at))
            return false;
    }
    return add_ear(w, at);
}

/* Runs around a ring the other way, and turns its triangles over. */
static void reverse_ring(cwi_ears *s, uint32_t start)
{
    uint32_t n = start;
    do {
        cwi_ring_node *node = s->nodes + n;
        const uint32_t next = node->next;
        node->next = node->prev;
        node->prev = next;
        n = next;
    } while (n != start);
}

cw_status cwi_clip_ears(cwi_ears *s, uint32_t start, cw_error *err)
{
    ear_work w = {.ears = s, .u = cwi_ears_u(s), .v = cwi_ears_v(s)};
    cw_status st = CW_OK;
    w.is_reflex = cwi_alloc_array(s->node_count, sizeof *w.is_reflex);
    w.items = cwi_alloc_array(s->node_count, sizeof *w.items);
    w.ahead = cwi_alloc_array(s->node_count, sizeof *w.ahead);
    w.behind = cwi_alloc_array(s->node_count, sizeof *w.behind);
    w.is_candidate = cwi_alloc_array(s->node_count, sizeof *w.is_candidate);
    bool ok = w.is_reflex && w.items && w.ahead && w.behind && w.is_candidate;
    if (s->is_flipped)
        reverse_ring(s, start);
    if (ok) {
        uint32_t n = start;
        do {
            update_reflex(&w, n);
            w.left++;
            n = s->nodes[n].next;
        } while (n != start);
        ok = make_tree(&w, start) && clip_ring(&w, start, &st, err);
    }
    cwi_free(w.is_reflex);
    cwi_free(w.items);
    cwi_free(w.ahead);
    cwi_free(w.behind);
    cwi_free(w.is_candidate);
    cwi_free(w.boxes);
    return ok ? st : cwi_fail_memory(err);
}
