/* Pairs of triangles that meet where they should not: boxes find the candidates, exact signs
 * decide. Around vertices of very many triangles boxes overlap nearly all: there the boxes are those
 * of directions. */
#include <cubewright/quality.h>

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "simplify/intersections/pair_search.h"

#include <stdlib.h>

/* Nodes of the tree are handed out in chunks. A chunk may do so much work, a test being 1 and a
 * pair kept 4: a sound mesh needs about 15 a triangle. When it is cut off, it is done again
 * with a share of what all such chunks have together. The result does not depend on threads. */
enum { CHUNK_NODES = 512, COST_OF_PAIR = 4, MIN_WORK = 32, MAX_WORK = 96 };
static const size_t MAX_REPEATED_WORK = (size_t)1 << 28, MAX_EXTRA_WORK = (size_t)1 << 25;

/* One node against those behind it on the curve. */
typedef struct visit {
    const cwi_pair_search *s;
    cwi_pair_list *to;
    size_t node;
    cwi_plane_pack planes; /* of its triangles */
} visit;

static void keep_pair(cwi_pair_list *to, uint32_t a, uint32_t b)
{
    if (to->count == to->capacity) {
        const size_t capacity = to->capacity ? 2 * to->capacity : 16;
        cwi_meeting_pair *pairs = cwi_realloc_array(to->pairs, capacity, sizeof *pairs);
        to->failed = !pairs;
        if (!pairs)
            return;
        to->pairs = pairs;
        to->capacity = capacity;
    }
    to->work += COST_OF_PAIR;
    to->pairs[to->count++] = a < b ? (cwi_meeting_pair){a, b} : (cwi_meeting_pair){b, a};
}

void cwi_test_pair(const cwi_pair_search *s, cwi_pair_list *to, uint32_t a, uint32_t b)
{
    const uint32_t *vertex = s->welded.vertex;
    if (cwi_triangles_meet(s->welded.points, vertex + 3 * (size_t)a, vertex + 3 * (size_t)b))
        keep_pair(to, a, b);
}

static void get_box(const cwi_boxes_node *node, int c, float box[6])
{
    for (int a = 0; a < 3; a++) {
        box[a] = node->low[a][c];
        box[a + 3] = node->high[a][c];
    }
}

/* Returns the number of set bits of eight. */
static unsigned count_bits(unsigned bits)
{
    bits -= bits >> 1 & 0x55;
    bits = (bits & 0x33) + (bits >> 2 & 0x33);
    return (bits + (bits >> 4)) & 0xf;
}

static bool meet_node(void *context, size_t other)
{
    visit *v = context;
    const cwi_boxes *tree = &v->s->tree;
    const cwi_triangle_pack *mine = &v->s->packs[v->node], *theirs = &v->s->packs[other];
    const size_t first = v->node * CWI_WIDTH;
    cwi_plane_pack planes;
    if (other != v->node)
        cwi_pack_planes(theirs, v->s->underflow, &planes);
    for (size_t i = first; i < first + CWI_WIDTH && i < tree->count; i++) {
        float box[6];
        get_box(&tree->nodes[v->node], (int)(i - first), box);
        unsigned near = cwi_boxes_meeting(&tree->nodes[other], box);
        if (other == v->node)
            near &= ~0u << (i - first + 1); /* each pair once */
        if (!near)
            continue;
        v->to->work += count_bits(near);
        unsigned unproved = cwi_find_unproved(mine, &v->planes, i - first, theirs,
                                              other == v->node ? &v->planes : &planes, near);
        for (; unproved; unproved &= unproved - 1)
            cwi_test_pair(v->s, v->to, tree->order[i],
                          tree->order[other * CWI_WIDTH + (size_t)__builtin_ctz(unproved)]);
    }
    v->to->cut = v->to->work > v->to->max_work;
    return !v->to->cut && !v->to->failed;
}

/* --- chunks ------------------------------------------------------------------------------- */

static void search_chunk(void *context, size_t k)
{
    const cwi_pair_search *s = context;
    cwi_pair_list *to = &s->lists[k];
    if (to->max_work && k >= s->node_chunks) {
        cwi_search_fan(s, (uint32_t)(k - s->node_chunks), to);
        return;
    }
    const size_t nodes = cwi_boxes_nodes(&s->tree), end = (k + 1) * CHUNK_NODES;
    if (to->max_work == 0)
        return;
    to->count = to->work = 0;
    to->cut = false;
    for (size_t n = k * CHUNK_NODES; n < end && n < nodes && !to->cut && !to->failed; n++) {
        visit v = {.s = s, .to = to, .node = n};
        float around[6];
        cwi_pack_planes(&s->packs[n], s->underflow, &v.planes);
        cwi_boxes_around(&s->tree.nodes[n], around);
        cwi_boxes_visit(&s->tree, around, n, meet_node, &v);
    }
}

static size_t first_allowance(const cwi_pair_search *s)
{
    const size_t work_per_node = MAX_REPEATED_WORK / (s->tree.count + 1);
    const size_t a_triangle = work_per_node < MIN_WORK   ? MIN_WORK
                              : work_per_node > MAX_WORK ? MAX_WORK
                                                         : work_per_node;
    return CHUNK_NODES * CWI_WIDTH * a_triangle;
}

static void pack_chunk(void *context, size_t k)
{
    cwi_pair_search *s = context;
    const size_t nodes = cwi_boxes_nodes(&s->tree), end = (k + 1) * CHUNK_NODES;
    for (size_t n = k * CHUNK_NODES; n < end && n < nodes; n++) {
        const size_t first = n * CWI_WIDTH, left = s->tree.count - first;
        cwi_pack_triangles(s->welded.points, s->welded.vertex, s->tree.order + first,
                           left < CWI_WIDTH ? left : CWI_WIDTH, &s->packs[n]);
    }
}

static bool prepare_search(cwi_pair_search *s, int threads)
{
    if (!cwi_find_fans(s) || !cwi_welded_sort(&s->welded, s->fans.fan_of, threads, &s->tree))
        return false;
    s->node_chunks = (cwi_boxes_nodes(&s->tree) + CHUNK_NODES - 1) / CHUNK_NODES;
    s->list_count = s->node_chunks + s->fans.count;
    s->lists = cwi_alloc_zeroed(s->list_count, sizeof *s->lists);
    s->packs = cwi_alloc_large(cwi_boxes_nodes(&s->tree), sizeof *s->packs);
    s->underflow = cwi_plane_underflow(s->tree.max);
    if (!s->lists || !s->packs)
        return false;
    for (size_t k = 0; k < s->list_count; k++)
        s->lists[k].max_work = first_allowance(s);
    cwi_parallel_for_all(s->node_chunks, CHUNK_NODES * CWI_WIDTH, threads, pack_chunk, s);
    return true;
}

/* Gives the chunks that were cut off another allowance, the others none; false when there is
 * nothing to gain. */
static bool allow_more(cwi_pair_search *s)
{
    size_t cut = 0;
    for (size_t k = 0; k < s->list_count; k++)
        cut += s->lists[k].cut;
    const size_t work_per_node = cut ? MAX_EXTRA_WORK / cut : 0;
    if (work_per_node <= first_allowance(s))
        return false;
    for (size_t k = 0; k < s->list_count; k++)
        s->lists[k].max_work = s->lists[k].cut ? work_per_node : 0;
    return true;
}

static int compare_pairs(const void *x, const void *y)
{
    const cwi_meeting_pair *p = x, *q = y;
    if (p->a != q->a)
        return p->a < q->a ? -1 : 1;
    return p->b < q->b ? -1 : p->b > q->b;
}

static cw_status collect_pairs(const cwi_pair_search *s, cw_crossings *out, cw_error *err)
{
    size_t count = 0;
    bool failed = false;
    for (size_t k = 0; k < s->list_count; k++) {
        count += s->lists[k].count;
        failed |= s->lists[k].failed;
        out->undecided |= s->lists[k].cut;
    }
    cwi_meeting_pair *pairs = failed ? NULL : cwi_alloc_array(count, sizeof *pairs);
    if (!pairs)
        return cwi_fail_memory(err);
    for (size_t k = 0; k < s->list_count; k++)
        for (size_t n = 0; n < s->lists[k].count; n++)
            pairs[out->count++] = s->lists[k].pairs[n];
    qsort(pairs, count, sizeof *pairs, compare_pairs);
    out->pairs = (uint32_t *)pairs;
    return CW_OK;
}

static cw_status search_chunks(cwi_pair_search *s, const cw_crossings_desc *d, cw_error *err)
{
    return cwi_parallel_for(s->list_count, CHUNK_NODES * CWI_WIDTH * 64, d->threads,
                            &d->progress, "self-intersections", search_chunk, s, err);
}

static cw_status run_search(cwi_pair_search *s, const cw_crossings_desc *d, cw_error *err)
{
    if (!prepare_search(s, d->threads))
        return cwi_fail_memory(err);
    cw_status st = search_chunks(s, d, err);
    return st == CW_OK && allow_more(s) ? search_chunks(s, d, err) : st;
}

cw_status cw_self_intersections(const cw_mesh *mesh, const cw_crossings_desc *desc,
                                cw_crossings *out, cw_error *err)
{
    CWI_REQUIRE(err, mesh, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_crossings_desc d = desc ? *desc : (cw_crossings_desc){0};
    cwi_pair_search s = {0};
    *out = (cw_crossings){0};
    cw_status st = cwi_welded_init(&s.welded, mesh, d.weld, err);
    if (st == CW_OK)
        st = run_search(&s, &d, err);
    if (st == CW_OK)
        st = collect_pairs(&s, out, err);
    for (size_t n = 0; n < 2 * out->count && d.defects; n++)
        d.defects[out->pairs[n]] |= CW_DEFECT_INTERSECTING;
    for (size_t k = 0; k < s.list_count && s.lists; k++)
        cwi_free(s.lists[k].pairs);
    cwi_free(s.lists);
    cwi_free(s.packs);
    cwi_boxes_free(&s.tree);
    cwi_wide_fans_free(&s.fans);
    cwi_free(s.around);
    cwi_welded_free(&s.welded);
    return st;
}

void cw_crossings_free(cw_crossings *crossings)
{
    if (!crossings)
        return;
    cwi_free(crossings->pairs);
    *crossings = (cw_crossings){0};
}
