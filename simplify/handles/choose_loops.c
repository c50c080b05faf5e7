/* Chooses loops whose cuts have nothing to do with each other, and leaves those out that would
 * separate the surface together. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/triangle.h"
#include "core/geometry/union_find.h"
#include "core/mesh/corner_table.h"
#include "simplify/handles/handle_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Caps may leave the box of the triangles around a loop by this fraction of its length. */
static const float MARGIN = 0.1F;

static int compare_loops(const void *a, const void *b)
{
    const cwi_loop *k = a, *l = b;
    if (k->length != l->length)
        return k->length < l->length ? -1 : 1;
    return (k->seed > l->seed) - (k->seed < l->seed);
}

/* Marks the triangles around the vertices of a loop, and finds the box around them. Returns false, and marks
 * none, if another loop has one of them. */
static bool take_triangles(const cwi_handles *h, const cwi_loops *loops, const cwi_loop *loop,
                           uint8_t *is_taken, float box[6])
{
    for (int a = 0; a < 3; a++) {
        box[a] = INFINITY;
        box[a + 3] = -INFINITY;
    }
    for (int pass = 0; pass < 2; pass++)
        for (size_t n = loop->first; n < loop->first + loop->count; n++) {
            const uint32_t start = loops->sides[n];
            uint32_t c = start;
            do {
                float around[6];
                if (!pass && is_taken[c / 3])
                    return false;
                is_taken[c / 3] |= pass;
                cwi_boxes_triangle(h->positions, h->triangles + c / 3 * 3, around);
                for (int a = 0; a < 3; a++) {
                    box[a] = fminf(box[a], around[a]);
                    box[a + 3] = fmaxf(box[a + 3], around[a + 3]);
                }
                c = h->twin[cwi_corner_prev(c)];
            } while (c != start);
        }
    for (int a = 0; a < 3; a++) {
        box[a] -= MARGIN * (float)loop->length;
        box[a + 3] += MARGIN * (float)loop->length;
    }
    return true;
}

/* Loops by their boxes, and the search around one of them. */
typedef struct box_search {
    cwi_boxes tree;
    const float (*boxes)[6];
    const bool *is_kept;
    uint32_t loop;
    bool is_met; /* a kept loop is there */
} box_search;

static bool visit_boxes(void *context, size_t node)
{
    box_search *s = context;
    unsigned meeting = cwi_boxes_meeting(&s->tree.nodes[node], s->boxes[s->loop]);
    for (; meeting && !s->is_met; meeting &= meeting - 1)
        s->is_met =
            s->is_kept[s->tree.order[node * CWI_WIDTH + (size_t)__builtin_ctz(meeting)]];
    return !s->is_met;
}

/* Keeps loops whose boxes meet no box of one before them. */
static cw_status keep_apart(cwi_loops *loops, float (*boxes)[6], cw_error *err)
{
    bool *is_kept = cwi_alloc_zeroed(loops->count, sizeof *is_kept);
    box_search s = {.boxes = (const float(*)[6])boxes, .is_kept = is_kept};
    cw_status st =
        is_kept ? cwi_boxes_build(&s.tree, s.boxes, loops->count, err) : cwi_fail_memory(err);
    for (; st == CW_OK && s.loop < loops->count; s.loop++) {
        s.is_met = false;
        cwi_boxes_visit(&s.tree, boxes[s.loop], 0, visit_boxes, &s);
        is_kept[s.loop] = !s.is_met;
    }
    size_t kept = 0;
    for (size_t n = 0; n < loops->count && st == CW_OK; n++)
        if (is_kept[n]) {
            memcpy(boxes[kept], boxes[n], sizeof *boxes);
            loops->items[kept++] = loops->items[n];
        }
    loops->count = st == CW_OK ? kept : loops->count;
    cwi_boxes_free(&s.tree);
    cwi_free(is_kept);
    return st;
}

cw_status cwi_handles_choose(const cwi_handles *h, cwi_loops *loops, float (**boxes)[6],
                             cw_error *err)
{
    uint8_t *is_taken = cwi_alloc_zeroed(h->triangle_count, 1);
    float(*around)[6] = cwi_alloc_array(loops->count, sizeof *around);
    size_t kept = 0;
    *boxes = around;
    if (!is_taken || !around) {
        cwi_free(is_taken);
        return cwi_fail_memory(err);
    }
    if (loops->count)
        qsort(loops->items, loops->count, sizeof *loops->items, compare_loops);
    for (size_t n = 0; n < loops->count; n++)
        if (take_triangles(h, loops, &loops->items[n], is_taken, around[kept]))
            loops->items[kept++] = loops->items[n];
    loops->count = kept;
    cwi_free(is_taken);
    return keep_apart(loops, around, err);
}

/* --- loops that separate ------------------------------------------------------------------ */

/* Joins triangles across all edges but those of loops that are kept. */
static void join_triangles(const cwi_handles *h, const uint8_t *is_cut, uint32_t *sets)
{
    for (uint32_t side = 0; side < 3 * h->triangle_count; side++)
        if (h->twin[side] != CWI_NO_CORNER && side < h->twin[side] && !is_cut[side])
            cwi_sets_join(sets, side / 3, h->twin[side] / 3);
}

cw_status cwi_handles_keep_joined(const cwi_handles *h, const cwi_loops *loops, bool *keep,
                                  cw_error *err)
{
    uint8_t *is_cut = cwi_alloc_zeroed(h->triangle_count, 3);
    uint32_t *sets = cwi_sets_alloc(h->triangle_count);
    const bool ok = is_cut && sets;
    for (size_t n = 0; n < loops->count && ok; n++)
        for (size_t i = loops->items[n].first;
             keep[n] && i < loops->items[n].first + loops->items[n].count; i++)
            is_cut[loops->sides[i]] = is_cut[h->twin[loops->sides[i]]] = 1;
    if (ok)
        join_triangles(h, is_cut, sets);
    /* A loop with one piece on its left and another on its right holds both together. The longest ones do. */
    for (size_t n = loops->count; n-- > 0 && ok;) {
        const uint32_t side = loops->sides[loops->items[n].first];
        const uint32_t left = keep[n] ? cwi_sets_find(sets, side / 3) : 0,
                       right = keep[n] ? cwi_sets_find(sets, h->twin[side] / 3) : 0;
        if (left == right)
            continue;
        cwi_sets_join(sets, left, right);
        keep[n] = false;
    }
    cwi_free(is_cut);
    cwi_free(sets);
    return ok ? CW_OK : cwi_fail_memory(err);
}
