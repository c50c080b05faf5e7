/* Pairs of triangles that meet: a tree of boxes finds candidates, exact signs decide. In a mesh without
 * faults all candidates are neighbours, which a look at their planes settles. */
#include "simplify/boolean/arrangement.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/geometry/bvh.h"
#include "core/geometry/vec3.h"

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
    const bool *moved; /* triangles one of which each pair must have; NULL: all */
    cwi_boxes tree;
    uint32_t *near; /* the triangles of the tree; NULL: all */
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

/* Returns the triangle in a slot of the tree. */
static uint32_t triangle_at(const search *w, size_t slot)
{
    return w->near ? w->near[w->tree.order[slot]] : w->tree.order[slot];
}

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

/* Compares places by x, then y, then z: the order along any line. */
static int compare_places(const double *p, const double *q)
{
    for (int k = 0; k < 3; k++)
        if (p[k] != q[k])
            return p[k] < q[k] ? -1 : 1;
    return 0;
}

/* Where corners of a triangle are that lie on the line of an edge. */
typedef struct on_line {
    bool before, within,
        after; /* the edge's first corner, or that itself; between them; after the last */
    bool first, last; /* the corner is the edge's own */
} on_line;

static void add_corner(const cwi_soup *s, uint32_t v0, uint32_t v1, uint32_t v, on_line *found)
{
    const double *p = s->vertices[v], *low = s->vertices[v0], *high = s->vertices[v1];
    const int forward = compare_places(low, high); /* -1: places rise along the edge */
    if (compare_places(p, low) * forward > 0)
        found->before = true;
    else if (compare_places(p, high) * forward < 0)
        found->after = true;
    else
        found->within = true;
}

/* Returns true if what is on an edge's line meets the edge in a corner that both triangles have, or not at all. */
static bool is_clear(const on_line *found)
{
    if (found->within)
        return false;
    return found->before || found->after
               ? (found->before ? !found->after && !found->last : !found->first)
               : true;
}

/* Looks for an edge of t that has all of u beyond it or on it; *apart: they meet in shared corners alone. */
static bool is_parted(const cwi_soup *s, uint32_t t, uint32_t u, int axis, bool *apart)
{
    const uint32_t *a = s->triangles[t], *b = s->triangles[u];
    const int turn = cwi_soup_turn(s, a[0], a[1], a[2], axis);
    bool parted = false;
    for (int e = 0; e < 3; e++) {
        const uint32_t v0 = a[e], v1 = a[(e + 1) % 3];
        bool beyond = true;
        on_line found = {0};
        for (int k = 0; k < 3 && beyond; k++) {
            found.first |= b[k] == v0;
            found.last |= b[k] == v1;
            if (b[k] == v0 || b[k] == v1)
                continue;
            const int side = turn * cwi_soup_turn(s, v0, v1, b[k], axis);
            beyond = side <= 0;
            if (side == 0)
                add_corner(s, v0, v1, b[k], &found);
        }
        parted |= beyond;
        *apart |= beyond && is_clear(&found);
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

/* The interval that a triangle has on the line of two planes, by its coordinate along an axis. */
typedef struct interval {
    double low, high, slack; /* ends are known within the slack */
    double shared;           /* a corner that both triangles have */
    bool has_shared;
} interval;

/* Finds the interval of triangle t on the plane of u by doubles; false: they do not tell it well enough. */
static bool guess_interval(const cwi_soup *s, uint32_t t, const plane *p, uint32_t u, int axis,
                           interval *out)
{
    const uint32_t *v = s->triangles[t], *c = s->triangles[u];
    double d[3], x[3];
    *out = (interval){INFINITY, -INFINITY, 0, 0, false};
    for (int k = 0; k < 3; k++) {
        double size = 0;
        d[k] = 0;
        x[k] = s->vertices[v[k]][axis];
        if (v[k] == c[0] || v[k] == c[1] || v[k] == c[2]) {
            out->has_shared = true;
            out->shared = x[k];
            continue;
        }
        for (int i = 0; i < 3; i++) {
            const double e = s->vertices[v[k]][i] - p->origin[i];
            d[k] += p->n[i] * e;
            size += p->size[i] * fabs(e);
        }
        if (!(fabs(d[k]) > 0x1p-26 * size))
            return false;
    }
    for (int k = 0; k < 3; k++) {
        const int next = (k + 1) % 3;
        out->slack = fmax(out->slack, 0x1p-20 * fabs(x[next] - x[k]));
        if (d[k] * d[next] >= 0)
            continue;
        const double at = x[k] + (x[next] - x[k]) * (d[k] / (d[k] - d[next]));
        out->low = fmin(out->low, at);
        out->high = fmax(out->high, at);
    }
    return true;
}

/* Returns true if two triangles whose planes cross surely meet in a corner that both have at most. */
static bool are_apart(const cwi_soup *s, const plane *p, uint32_t t, const plane *q, uint32_t u)
{
    double along[3];
    int axis = 0;
    interval a, b;
    cwi_cross(p->n, q->n, along);
    for (int k = 1; k < 3; k++)
        if (fabs(along[k]) > fabs(along[axis]))
            axis = k;
    if (!guess_interval(s, t, q, u, axis, &a) || !guess_interval(s, u, p, t, axis, &b))
        return false;
    const double slack = a.slack + b.slack;
    if (!a.has_shared)
        return a.low > b.high + slack || b.low > a.high + slack;
    return (a.low > a.shared + slack && b.high < b.shared - slack) ||
           (b.low > b.shared + slack && a.high < a.shared - slack);
}

static void test_pair(const visit *v, const plane *p, uint32_t t, uint32_t u)
{
    const cwi_soup *s = v->search->s;
    const bool *moved = v->search->moved;
    cwi_meeting pair = {t < u ? t : u, t < u ? u : t, false, false};
    bool apart = false;
    if (moved && !moved[t] && !moved[u])
        return;
    if (is_beside(s, p, t, u, &pair.coplanar))
        return;
    if (pair.coplanar) {
        const int axis = cwi_soup_axis(s, t);
        pair.overlap = !is_parted(s, t, u, axis, &apart) && !is_parted(s, u, t, axis, &apart);
    } else {
        bool coplanar;
        plane q;
        find_plane(s, u, &q);
        apart = is_beside(s, &q, u, t, &coplanar) || are_apart(s, p, t, &q, u);
    }
    if (!apart)
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
            test_pair(
                v, &v->planes[i - first], triangle_at(v->search, i),
                triangle_at(v->search, other * CWI_WIDTH + (size_t)__builtin_ctz(meeting)));
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
            find_plane(s->s, triangle_at(s, v.node * CWI_WIDTH + i), &v.planes[i]);
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

static void find_box(const cwi_soup *soup, uint32_t t, float box[6])
{
    for (int k = 0; k < 3; k++) {
        const uint32_t *v = soup->triangles[t];
        const double x = soup->vertices[v[0]][k], y = soup->vertices[v[1]][k],
                     z = soup->vertices[v[2]][k];
        box[k] = round_down(fmin(fmin(x, y), z));
        box[k + 3] = -round_down(-fmax(fmax(x, y), z));
    }
}

cw_status cwi_soup_tree(const cwi_soup *soup, const uint32_t *list, size_t count,
                        cwi_boxes *tree, cw_error *err)
{
    float(*boxes)[6] = cwi_alloc_array(count, sizeof *boxes);
    if (!boxes)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < count; n++)
        find_box(soup, list ? list[n] : (uint32_t)n, boxes[n]);
    const cw_status st = cwi_boxes_build(tree, (const float(*)[6])boxes, count, err);
    cwi_free(boxes);
    return st;
}

static bool note_hit(void *context, size_t node)
{
    (void)node;
    *(bool *)context = true;
    return false;
}

/* Builds the tree of the triangles that moved, and of those whose boxes come close to one of these. */
static cw_status build_near_tree(search *w, cw_error *err)
{
    const size_t count = w->s->triangle_count;
    cwi_boxes moved = {0};
    size_t n = 0;
    w->near = cwi_alloc_array(count, sizeof *w->near);
    if (!w->near)
        return cwi_fail_memory(err);
    for (uint32_t t = 0; t < count; t++)
        if (w->moved[t])
            w->near[n++] = t;
    cw_status st = cwi_soup_tree(w->s, w->near, n, &moved, err);
    n = 0;
    for (uint32_t t = 0; t < count && st == CW_OK; t++) {
        float box[6];
        bool is_near = w->moved[t];
        find_box(w->s, t, box);
        if (!is_near)
            cwi_boxes_visit(&moved, box, 0, note_hit, &is_near);
        if (is_near)
            w->near[n++] = t;
    }
    cwi_boxes_free(&moved);
    return st == CW_OK ? cwi_soup_tree(w->s, w->near, n, &w->tree, err) : st;
}

void cwi_meetings_free(cwi_meetings *meetings)
{
    cwi_free(meetings->pairs);
    cwi_boxes_free(&meetings->tree);
    *meetings = (cwi_meetings){0};
}

cw_status cwi_find_meetings(const cwi_soup *s, const bool *moved, int threads,
                            const cw_progress *progress, cwi_meetings *out, cw_error *err)
{
    search w = {.s = s, .moved = moved};
    cw_status st = moved ? build_near_tree(&w, err)
                         : cwi_soup_tree(s, NULL, s->triangle_count, &w.tree, err);
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
    cwi_free(w.near);
    if (moved)
        cwi_boxes_free(&w.tree);
    else
        out->tree = w.tree;
    return st;
}
