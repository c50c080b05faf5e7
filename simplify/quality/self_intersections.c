/* Pairs of triangles that meet where they should not: boxes find the candidates, exact signs
 * decide. Around vertices of very many triangles boxes overlap nearly all: there the boxes are those
 * of directions. */
#include <cubewright/quality.h>

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/bvh.h"
#include "core/geometry/triangle_intersect.h"
#include "core/mesh/wide_fans.h"
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
    cwi_wide_fans fans;
    cwi_boxes tree; /* of the triangles of no fan */
    chunk *chunks;  /* of its nodes, and then one for each fan */
    size_t chunk_count, node_chunks;
    float (*around)[6]; /* the box of each fan */
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

/* --- fans --------------------------------------------------------------------------------- */

/* A fan, its triangles by their directions, and the triangle that is held against them. */
typedef struct fan_visit {
    const search *s;
    chunk *to;
    uint32_t fan;
    cwi_boxes directions;
    uint32_t triangle;
    float box[6], direction[6];
    size_t triangles; /* held against it so far */
} fan_visit;

static void set_direction(const fan_visit *v, uint32_t triangle, float box[6])
{
    const float *points = v->s->welded.points, *corners[3];
    const uint32_t *vertex = v->s->welded.vertex + 3 * (size_t)triangle,
                   hub = v->s->fans.hubs[v->fan];
    for (int k = 0; k < 3; k++)
        corners[k] = points + 3 * (size_t)vertex[k];
    cwi_direction_box(points + 3 * (size_t)hub, corners,
                      vertex[0] == hub || vertex[1] == hub || vertex[2] == hub, box);
}

static bool boxes_meet(const float a[6], const float b[6])
{
    for (int k = 0; k < 3; k++)
        if (a[k] > b[k + 3] || b[k] > a[k + 3])
            return false;
    return true;
}

static bool is_within_work(const fan_visit *v)
{
    return v->to->work <= v->to->max_work + MAX_WORK * v->triangles;
}

static bool meet_directions(void *context, size_t node)
{
    fan_visit *v = context;
    const search *s = v->s;
    const visit test = {s, v->to, 0};
    const bool same = s->fans.fan_of[v->triangle] == v->fan;
    unsigned meeting = cwi_boxes_meeting(&v->directions.nodes[node], v->direction);
    for (size_t c = 0; meeting >> c; c++) {
        if (!(meeting >> c & 1))
            continue;
        const uint32_t other = v->directions.order[node * CWI_WIDTH + c];
        float box[6];
        cwi_boxes_triangle(s->welded.points, s->welded.vertex + 3 * (size_t)other, box);
        v->to->work++;
        if ((!same || other > v->triangle) && boxes_meet(box, v->box)) /* each pair once */
            test_pair(&test, v->triangle, other);
    }
    return is_within_work(v) && !v->to->failed;
}

/* Holds a triangle against those of the fan, if it is near. */
static void meet_fan(fan_visit *v, uint32_t triangle)
{
    const cwi_welded *w = &v->s->welded;
    cwi_boxes_triangle(w->points, w->vertex + 3 * (size_t)triangle, v->box);
    if (v->to->cut || v->to->failed || !boxes_meet(v->box, v->s->around[v->fan]))
        return;
    v->triangle = triangle;
    v->triangles++;
    set_direction(v, triangle, v->direction);
    cwi_boxes_visit(&v->directions, v->direction, 0, meet_directions, v);
    v->to->cut = !is_within_work(v);
}

static bool meet_near_node(void *context, size_t node)
{
    fan_visit *v = context;
    const cwi_boxes *tree = &v->s->tree;
    for (size_t i = node * CWI_WIDTH; i < (node + 1) * CWI_WIDTH && i < tree->count; i++)
        meet_fan(v, tree->order[i]);
    return !v->to->cut && !v->to->failed;
}

static bool sort_directions(fan_visit *v)
{
    const uint32_t *triangles = v->s->fans.triangles + v->s->fans.first[v->fan];
    const size_t count = v->s->fans.first[v->fan + 1] - v->s->fans.first[v->fan];
    float(*boxes)[6] = cwi_alloc_array(count, sizeof *boxes);
    for (size_t n = 0; n < count && boxes; n++)
        set_direction(v, triangles[n], boxes[n]);
    const bool ok = boxes && cwi_boxes_build(&v->directions, (const float(*)[6])boxes, count,
                                             NULL) == CW_OK;
    for (size_t n = 0; n < count && ok; n++)
        v->directions.order[n] = triangles[v->directions.order[n]];
    cwi_free(boxes);
    return ok;
}

/* Holds triangles of no fan, those of the fan, and those of later fans against the fan. */
static void search_fan(const search *s, uint32_t fan, chunk *to)
{
    fan_visit v = {.s = s, .to = to, .fan = fan};
    to->count = to->work = 0;
    to->cut = false;
    to->failed = !sort_directions(&v);
    if (!to->failed)
        cwi_boxes_visit(&s->tree, s->around[fan], 0, meet_near_node, &v);
    for (size_t f = fan; f < s->fans.count && !to->failed; f++)
        if (boxes_meet(s->around[f], s->around[fan]))
            for (size_t n = s->fans.first[f]; n < s->fans.first[f + 1]; n++)
                meet_fan(&v, s->fans.triangles[n]);
    cwi_boxes_free(&v.directions);
}

static bool is_flat(const void *context, size_t triangle)
{
    return cwi_is_flat(context, triangle);
}

/* Finds the fans, and the box around each. */
static bool find_fans(search *s)
{
    const cwi_welded *w = &s->welded;
    if (cwi_wide_fans_find(&s->fans, w->mesh->vertex_count, w->vertex, w->mesh->triangle_count,
                           is_flat, w, NULL) != CW_OK)
        return false;
    s->around = cwi_alloc_array(s->fans.count, sizeof *s->around);
    for (size_t f = 0; f < s->fans.count && s->around; f++) {
        float *around = s->around[f];
        cwi_boxes_triangle(w->points,
                           w->vertex + 3 * (size_t)s->fans.triangles[s->fans.first[f]], around);
        for (size_t n = s->fans.first[f]; n < s->fans.first[f + 1]; n++) {
            float box[6];
            cwi_boxes_triangle(w->points, w->vertex + 3 * (size_t)s->fans.triangles[n], box);
            for (int a = 0; a < 3; a++) {
                around[a] = fminf(around[a], box[a]);
                around[a + 3] = fmaxf(around[a + 3], box[a + 3]);
            }
        }
    }
    return s->around;
}

/* --- chunks ------------------------------------------------------------------------------- */

static void search_chunk(void *context, size_t k)
{
    const search *s = context;
    chunk *to = &s->chunks[k];
    if (to->max_work && k >= s->node_chunks) {
        search_fan(s, (uint32_t)(k - s->node_chunks), to);
        return;
    }
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
    if (!find_fans(s) || !cwi_welded_sort(&s->welded, s->fans.fan_of, &s->tree))
        return false;
    s->node_chunks = (cwi_boxes_nodes(&s->tree) + CHUNK_NODES - 1) / CHUNK_NODES;
    s->chunk_count = s->node_chunks + s->fans.count;
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
