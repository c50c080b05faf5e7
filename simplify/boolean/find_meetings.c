/* Pairs of triangles that meet: a tree of boxes finds candidates, exact signs decide. In a mesh without
 * faults all candidates are neighbours, which a look at their planes settles. */
#include "simplify/boolean/arrangement.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/geometry/bvh.h"

#include <math.h>
#include <stdlib.h>

enum { CHUNK_NODES = 512 };

typedef struct chunk {
    size_t count, capacity;
    cwi_meeting *pairs;
    bool failed;
} chunk;

typedef struct search {
    const cwi_soup *s;
    cwi_boxes tree;
    size_t chunk_count;
    chunk *chunks;
} search;

/* The plane of a triangle: n . (x - origin). The products in n have the size `size`. */
typedef struct plane {
    double origin[3], n[3], size[3];
} plane;

typedef struct visit {
    const search *search;
    chunk *to;
    size_t node;
    plane planes[CWI_WIDTH]; /* of the triangles of the node */
} visit;

static void find_plane(const cwi_soup *s, uint32_t t, plane *out)
{
    const uint32_t *v = s->triangles[t];
    double a[3], b[3];
    for (int k = 0; k < 3; k++) {
        out->origin[k] = s->vertices[v[0]][k];
        a[k] = s->vertices[v[1]][k] - out->origin[k];
        b[k] = s->vertices[v[2]][k] - out->origin[k];
    }
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double p = a[i] * b[j], q = a[j] * b[i];
        out->n[k] = p - q;
        out->size[k] = fabs(p) + fabs(q);
    }
}

/* Returns the side of a plane on which a vertex is. */
static int side_of(const cwi_soup *s, const plane *p, uint32_t t, uint32_t v)
{
    const double *x = s->vertices[v];
    double sum = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        const double d = x[k] - p->origin[k];
        sum += p->n[k] * d;
        size += p->size[k] * fabs(d);
    }
    if (fabs(sum) > 0x1p-50 * size)
        return sum > 0 ? 1 : -1;
    return cwi_soup_side(s, t, v);
}

/* Returns true if all corners of triangle u, but for those of triangle t, are on one side of t's plane,
 * and none is in it. *coplanar: all corners are in it. */
static bool is_beside(const cwi_soup *s, const plane *p, uint32_t t, uint32_t u, bool *coplanar)
{
    const uint32_t *a = s->triangles[t], *b = s->triangles[u];
    int above = 0, below = 0, in = 0;
    for (int k = 0; k < 3; k++) {
        if (b[k] == a[0] || b[k] == a[1] || b[k] == a[2])
            continue;
        const int side = side_of(s, p, t, b[k]);
        above += side > 0;
        below += side < 0;
        in += side == 0;
        if (above && below)
            break;
    }
    *coplanar = !above && !below;
    return !in && (above > 0) != (below > 0);
}

/* Looks for an edge of t that has all of u beyond it or on it; *apart: beyond it but for corners that both have. */
static bool is_parted(const cwi_soup *s, uint32_t t, uint32_t u, int axis, bool *apart)
{
    const uint32_t *a = s->triangles[t], *b = s->triangles[u];
    const int turn = cwi_soup_turn(s, a[0], a[1], a[2], axis);
    bool parted = false;
    for (int e = 0; e < 3; e++) {
        const uint32_t v0 = a[e], v1 = a[(e + 1) % 3];
        bool beyond = true, strictly = true;
        for (int k = 0; k < 3 && beyond; k++) {
            if (b[k] == v0 || b[k] == v1)
                continue;
            const int side = turn * cwi_soup_turn(s, v0, v1, b[k], axis);
            beyond = side <= 0;
            strictly &= side < 0;
        }
        parted |= beyond;
        *apart |= beyond && strictly;
    }
    return parted;
}

static void keep_pair(chunk *to, cwi_meeting pair)
{
    cwi_meeting *pairs = cwi_grow_array(to->pairs, to->count, &to->capacity, sizeof *pairs);
    to->failed = !pairs;
    if (!pairs)
        return;
    to->pairs = pairs;
    to->pairs[to->count++] = pair;
}

static void test_pair(const visit *v, const plane *p, uint32_t t, uint32_t u)
{
    const cwi_soup *s = v->search->s;
    cwi_meeting pair = {t < u ? t : u, t < u ? u : t, false, false};
    plane q;
    bool apart = false;
    if (is_beside(s, p, t, u, &pair.coplanar))
        return;
    if (pair.coplanar) {
        const int axis = cwi_soup_axis(s, t);
        pair.overlap = !is_parted(s, t, u, axis, &apart) && !is_parted(s, u, t, axis, &apart);
        if (apart)
            return;
    } else {
        bool coplanar;
        find_plane(s, u, &q);
        if (is_beside(s, &q, u, t, &coplanar))
            return;
    }
    keep_pair(v->to, pair);
}

static bool meet_node(void *context, size_t other)
{
    const visit *v = context;
    const cwi_boxes *tree = &v->search->tree;
    const size_t first = v->node * CWI_WIDTH;
    for (size_t i = first; i < first + CWI_WIDTH && i < tree->count; i++) {
        float box[6];
        for (int a = 0; a < 3; a++) {
            box[a] = tree->nodes[v->node].low[a][i - first];
            box[a + 3] = tree->nodes[v->node].high[a][i - first];
        }
        unsigned meeting = cwi_boxes_meeting(&tree->nodes[other], box);
        if (other == v->node)
            meeting &= ~0u << (i - first + 1); /* each pair once */
        for (; meeting; meeting &= meeting - 1)
            test_pair(v, &v->planes[i - first], tree->order[i],
                      tree->order[other * CWI_WIDTH + (size_t)__builtin_ctz(meeting)]);
    }
    return !v->to->failed;
}

static int compare_pairs(const void *x, const void *y)
{
    const cwi_meeting *p = x, *q = y;
    if (p->a != q->a)
        return p->a < q->a ? -1 : 1;
    return p->b < q->b ? -1 : p->b > q->b;
}

static void search_chunk(void *context, size_t k)
{
    const search *s = context;
    const cwi_boxes *tree = &s->tree;
    visit v = {.search = s, .to = &s->chunks[k]};
    for (v.node = k * CHUNK_NODES;
         v.node < (k + 1) * CHUNK_NODES && v.node < cwi_boxes_nodes(tree) && !v.to->failed;
         v.node++) {
        float around[6];
        for (size_t i = 0; i < CWI_WIDTH && v.node * CWI_WIDTH + i < tree->count; i++)
            find_plane(s->s, tree->order[v.node * CWI_WIDTH + i], &v.planes[i]);
        cwi_boxes_around(&tree->nodes[v.node], around);
        cwi_boxes_visit(tree, around, v.node, meet_node, &v);
    }
}

static bool collect_pairs(const search *s, cwi_meetings *out)
{
    bool failed = false;
    for (size_t k = 0; k < s->chunk_count; k++) {
        out->count += s->chunks[k].count;
        failed |= s->chunks[k].failed;
    }
    out->pairs = failed ? NULL : cwi_alloc_array(out->count, sizeof *out->pairs);
    if (!out->pairs)
        return false;
    size_t n = 0;
    for (size_t k = 0; k < s->chunk_count; k++)
        for (size_t i = 0; i < s->chunks[k].count; i++)
            out->pairs[n++] = s->chunks[k].pairs[i];
    qsort(out->pairs, out->count, sizeof *out->pairs, compare_pairs);
    return true;
}

/* A float that is not above x. */
static float round_down(double x)
{
    const float f = (float)x;
    return (double)f > x ? nextafterf(f, -INFINITY) : f;
}

static cw_status build_tree(search *s, cw_error *err)
{
    const cwi_soup *soup = s->s;
    float(*boxes)[6] = cwi_alloc_array(soup->triangle_count, sizeof *boxes);
    if (!boxes)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < soup->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            const uint32_t *v = soup->triangles[t];
            const double x = soup->vertices[v[0]][k], y = soup->vertices[v[1]][k],
                         z = soup->vertices[v[2]][k];
            boxes[t][k] = round_down(fmin(fmin(x, y), z));
            boxes[t][k + 3] = -round_down(-fmax(fmax(x, y), z));
        }
    const cw_status st =
        cwi_boxes_build(&s->tree, (const float(*)[6])boxes, soup->triangle_count, err);
    cwi_free(boxes);
    return st;
}

cw_status cwi_find_meetings(const cwi_soup *s, int threads, const cw_progress *progress,
                            cwi_meetings *out, cw_error *err)
{
    search w = {.s = s};
    cw_status st = build_tree(&w, err);
    if (st == CW_OK) {
        w.chunk_count = (cwi_boxes_nodes(&w.tree) + CHUNK_NODES - 1) / CHUNK_NODES;
        w.chunks = cwi_alloc_zeroed(w.chunk_count, sizeof *w.chunks);
        st = w.chunks ? cwi_parallel_for(w.chunk_count, CHUNK_NODES * CWI_WIDTH * 64, threads,
                                         progress, "intersecting", search_chunk, &w, err)
                      : cwi_fail_memory(err);
    }
    if (st == CW_OK && !collect_pairs(&w, out))
        st = cwi_fail_memory(err);
    for (size_t k = 0; k < w.chunk_count && w.chunks; k++)
        cwi_free(w.chunks[k].pairs);
    cwi_free(w.chunks);
    cwi_boxes_free(&w.tree);
    return st;
}
