/* Pairs of triangles that meet where they should not: boxes find the candidates, exact signs
 * decide. */
#include <cubewright/quality.h>

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/bvh.h"
#include "core/geometry/triangle_intersect.h"
#include "simplify/quality/welded_mesh.h"

#include <stdlib.h>

/* Nodes of the tree are handed out in chunks. A chunk may do so much work, a test being 1 and a
 * pair kept 4: a sound mesh needs about 15 a triangle. When it is cut off, it is done again
 * with a share of what all such chunks have together. The result does not depend on threads. */
enum { CHUNK_NODES = 512, COST_OF_PAIR = 4, MIN_WORK = 32, MAX_WORK = 96 };
static const size_t MAX_REPEATED_WORK = (size_t)1 << 28, MAX_EXTRA_WORK = (size_t)1 << 25;

typedef struct pair {
    uint32_t a, b; /* a < b */
} pair;

typedef struct chunk {
    size_t count, capacity;
    pair *pairs;
    size_t work, max_work;
    bool cut, failed;
} chunk;

typedef struct search {
    cwi_welded welded;
    cwi_boxes tree;
    chunk *chunks;
    size_t chunk_count;
} search;

/* One node against those behind it on the curve. */
typedef struct visit {
    const search *s;
    chunk *to;
    size_t node;
} visit;

static void keep_pair(chunk *to, uint32_t a, uint32_t b)
{
    if (to->count == to->capacity) {
        const size_t capacity = to->capacity ? 2 * to->capacity : 16;
        pair *pairs = cwi_realloc_array(to->pairs, capacity, sizeof *pairs);
        to->failed = !pairs;
        if (!pairs)
            return;
        to->pairs = pairs;
        to->capacity = capacity;
    }
    to->work += COST_OF_PAIR;
    to->pairs[to->count++] = a < b ? (pair){a, b} : (pair){b, a};
}

static void get_box(const cwi_boxes_node *node, int c, float box[6])
{
    for (int a = 0; a < 3; a++) {
        box[a] = node->low[a][c];
        box[a + 3] = node->high[a][c];
    }
}

static void test_pair(const visit *v, uint32_t a, uint32_t b)
{
    const uint32_t *vertex = v->s->welded.vertex;
    v->to->work++;
    if (cwi_triangles_meet(v->s->welded.points, vertex + 3 * (size_t)a, vertex + 3 * (size_t)b))
        keep_pair(v->to, a, b);
}

static bool meet_node(void *context, size_t other)
{
    const visit *v = context;
    const cwi_boxes *tree = &v->s->tree;
    const size_t first = v->node * CWI_WIDTH;
    for (size_t i = first; i < first + CWI_WIDTH && i < tree->count; i++) {
        float box[6];
        get_box(&tree->nodes[v->node], (int)(i - first), box);
        unsigned meeting = cwi_boxes_meeting(&tree->nodes[other], box);
        if (other == v->node)
            meeting &= ~0u << (i - first + 1); /* each pair once */
        for (size_t c = 0; meeting >> c; c++)
            if (meeting >> c & 1)
                test_pair(v, tree->order[i], tree->order[other * CWI_WIDTH + c]);
    }
    v->to->cut = v->to->work > v->to->max_work;
    return !v->to->cut && !v->to->failed;
}

static void search_chunk(void *context, size_t k)
{
    const search *s = context;
    chunk *to = &s->chunks[k];
    const size_t nodes = cwi_boxes_nodes(&s->tree), end = (k + 1) * CHUNK_NODES;
    if (to->max_work == 0)
        return;
    to->count = to->work = 0;
    to->cut = false;
    for (size_t n = k * CHUNK_NODES; n < end && n < nodes && !to->cut && !to->failed; n++) {
        visit v = {s, to, n};
        float around[6];
        cwi_boxes_around(&s->tree.nodes[n], around);
        cwi_boxes_visit(&s->tree, around, n, meet_node, &v);
    }
}

static size_t first_allowance(const search *s)
{
    const size_t work_per_node = MAX_REPEATED_WORK / (s->tree.count + 1);
    const size_t a_triangle = work_per_node < MIN_WORK   ? MIN_WORK
                              : work_per_node > MAX_WORK ? MAX_WORK
                                                         : work_per_node;
    return CHUNK_NODES * CWI_WIDTH * a_triangle;
}

static bool prepare_search(search *s)
{
    if (!cwi_welded_sort(&s->welded, &s->tree))
        return false;
    s->chunk_count = (cwi_boxes_nodes(&s->tree) + CHUNK_NODES - 1) / CHUNK_NODES;
    s->chunks = cwi_alloc_zeroed(s->chunk_count, sizeof *s->chunks);
    for (size_t k = 0; k < s->chunk_count && s->chunks; k++)
        s->chunks[k].max_work = first_allowance(s);
    return s->chunks;
}

/* Gives the chunks that were cut off another allowance, the others none; false when there is
 * nothing to gain. */
static bool allow_more(search *s)
{
    size_t cut = 0;
    for (size_t k = 0; k < s->chunk_count; k++)
        cut += s->chunks[k].cut;
    const size_t work_per_node = cut ? MAX_EXTRA_WORK / cut : 0;
    if (work_per_node <= first_allowance(s))
        return false;
    for (size_t k = 0; k < s->chunk_count; k++)
        s->chunks[k].max_work = s->chunks[k].cut ? work_per_node : 0;
    return true;
}

static int compare_pairs(const void *x, const void *y)
{
    const pair *p = x, *q = y;
    if (p->a != q->a)
        return p->a < q->a ? -1 : 1;
    return p->b < q->b ? -1 : p->b > q->b;
}

static cw_status collect_pairs(const search *s, cw_crossings *out, cw_error *err)
{
    size_t count = 0;
    bool failed = false;
    for (size_t k = 0; k < s->chunk_count; k++) {
        count += s->chunks[k].count;
        failed |= s->chunks[k].failed;
        out->undecided |= s->chunks[k].cut;
    }
    pair *pairs = failed ? NULL : cwi_alloc_array(count, sizeof *pairs);
    if (!pairs)
        return cwi_fail_memory(err);
    for (size_t k = 0; k < s->chunk_count; k++)
        for (size_t n = 0; n < s->chunks[k].count; n++)
            pairs[out->count++] = s->chunks[k].pairs[n];
    qsort(pairs, count, sizeof *pairs, compare_pairs);
    out->pairs = (uint32_t *)pairs;
    return CW_OK;
}

static cw_status search_chunks(search *s, const cw_crossings_desc *d, cw_error *err)
{
    return cwi_parallel_for(s->chunk_count, CHUNK_NODES * CWI_WIDTH * 64, d->threads,
                            &d->progress, "self-intersections", search_chunk, s, err);
}

static cw_status run_search(search *s, const cw_crossings_desc *d, cw_error *err)
{
    if (!prepare_search(s))
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
    search s = {0};
    *out = (cw_crossings){0};
    cw_status st = cwi_welded_init(&s.welded, mesh, d.weld, err);
    if (st == CW_OK)
        st = run_search(&s, &d, err);
    if (st == CW_OK)
        st = collect_pairs(&s, out, err);
    for (size_t n = 0; n < 2 * out->count && d.defects; n++)
        d.defects[out->pairs[n]] |= CW_DEFECT_INTERSECTING;
    for (size_t k = 0; k < s.chunk_count && s.chunks; k++)
        cwi_free(s.chunks[k].pairs);
    cwi_free(s.chunks);
    cwi_boxes_free(&s.tree);
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
