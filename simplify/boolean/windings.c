/* How often each input winds around each cell. Across a facet the numbers change by the triangles it is part of.
 * For each set of facets that hangs together, a line along x finds a facet that is seen from outside, and
 * counts what other sets add there. */
#include "simplify/boolean/complex.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/bvh.h"

#include <math.h>
#include <stdlib.h>

/* Two cells that a facet parts. */
typedef struct passage {
    uint32_t from, to; /* cells */
    uint32_t facet;
} passage;

typedef struct search {
    const cwi_soup *s;
    const cwi_triangle_parts *parts;
    const cwi_facets *f;
    const cwi_space_cells *cells;
    const uint32_t *inputs;
    size_t passage_count;
    passage *passages; /* each both ways, ordered by the cell that they lead from */
    size_t *first;     /* cells + 1 */
    uint32_t
        *island; /* of each cell: facets that hang together stand between cells of one island */
    size_t island_count;
    uint32_t *stack;
    const cwi_boxes *tree; /* of triangles */
    cwi_boxes own;         /* the same, where none is given */
} search;

/* --- passages and islands ----------------------------------------------------------------- */

static uint32_t front_of(const search *w, uint32_t f)
{
    return w->cells->sides[2 * (size_t)f];
}

static uint32_t back_of(const search *w, uint32_t f)
{
    return w->cells->sides[2 * (size_t)f + 1];
}

static int compare_passages(const void *x, const void *y)
{
    const passage *a = x, *b = y;
    if (a->from != b->from)
        return a->from < b->from ? -1 : 1;
    if (a->to != b->to)
        return a->to < b->to ? -1 : 1;
    return a->facet < b->facet ? -1 : a->facet > b->facet;
}

/* Lists a facet between any two cells that have one. Facets in a row mostly part the same cells. */
static bool list_passages(search *w)
{
    size_t count = 0, capacity = 0;
    passage last = {CWI_NOTHING, CWI_NOTHING, 0};
    for (uint32_t f = 0; f < w->f->count; f++) {
        const passage p = {front_of(w, f), back_of(w, f), f};
        if ((p.from == last.from && p.to == last.to) || p.from == p.to)
            continue;
        last = p;
        passage *grown = cwi_grow_array(w->passages, count + 1, &capacity, sizeof *grown);
        if (!grown)
            return false;
        w->passages = grown;
        w->passages[count++] = p;
        w->passages[count++] = (passage){p.to, p.from, f};
    }
    if (count)
        qsort(w->passages, count, sizeof *w->passages, compare_passages);
    for (size_t n = 0; n < count; n++)
        if (n == 0 || w->passages[n].from != w->passages[w->passage_count - 1].from ||
            w->passages[n].to != w->passages[w->passage_count - 1].to)
            w->passages[w->passage_count++] = w->passages[n];
    w->first = cwi_alloc_array(w->cells->count + 1, sizeof *w->first);
    if (!w->first)
        return false;
    size_t n = 0;
    for (size_t c = 0; c <= w->cells->count; c++) {
        while (n < w->passage_count && w->passages[n].from < c)
            n++;
        w->first[c] = n;
    }
    return true;
}

static bool find_islands(search *w)
{
    w->island = cwi_alloc_array(w->cells->count, sizeof *w->island);
    w->stack = cwi_alloc_array(w->cells->count, sizeof *w->stack);
    if (!w->island || !w->stack)
        return false;
    for (size_t c = 0; c < w->cells->count; c++)
        w->island[c] = CWI_NOTHING;
    for (uint32_t c = 0; c < w->cells->count; c++) {
        if (w->island[c] != CWI_NOTHING)
            continue;
        size_t depth = 0;
        w->stack[depth++] = c;
        w->island[c] = (uint32_t)w->island_count;
        while (depth) {
            const uint32_t cell = w->stack[--depth];
            for (size_t n = w->first[cell]; n < w->first[cell + 1]; n++)
                if (w->island[w->passages[n].to] == CWI_NOTHING) {
                    w->island[w->passages[n].to] = (uint32_t)w->island_count;
                    w->stack[depth++] = w->passages[n].to;
                }
        }
        w->island_count++;
    }
    return true;
}

static uint32_t island_of(const search *w, uint32_t triangle)
{
    const uint32_t facet = w->f->facet_of[triangle];
    return facet == CWI_NOTHING ? CWI_NOTHING : w->island[front_of(w, facet)];
}

/* --- lines along x ------------------------------------------------------------------------ */

/* A line along x through the point (y / w, z / w). */
typedef struct line {
    cwi_wide y, z, w;
} line;

/* A triangle that a line meets, and where: x = top / bottom. */
typedef struct hit {
    uint32_t triangle;
    bool front; /* seen from large x */
    cwi_big top, bottom;
} hit;

typedef struct hits {
    const search *w;
    line line;
    size_t count, capacity;
    hit *hits;
    size_t last;        /* the outermost one of an island */
    bool failed, vague; /* no memory; the line meets an edge */
} hits;

/* Returns the side of the edge from p to q on which the line is, seen from large x. */
static int side_of_edge(const line *l, const double *p, const double *q)
{
    const cwi_wide py = (int64_t)p[1], pz = (int64_t)p[2], qy = (int64_t)q[1],
                   qz = (int64_t)q[2];
    const cwi_wide det = (qy - py) * (l->z - pz * l->w) - (qz - pz) * (l->y - py * l->w);
    return (det > 0) - (det < 0);
}

static void find_hit_x(const search *w, const line *l, uint32_t t, hit *out)
{
    const double *r = w->s->vertices[w->s->triangles[t][0]];
    cwi_wide n[3];
    cwi_big a, b, product;
    cwi_soup_normal(w->s, t, n);
    out->front = n[0] > 0;
    cwi_big_set(&a, n[0]);
    cwi_big_set(&b, l->w);
    cwi_big_mul(&a, &b, &out->bottom);
    cwi_big_set(&b, (int64_t)r[0]);
    cwi_big_mul(&out->bottom, &b, &out->top);
    for (int k = 1; k < 3; k++) {
        cwi_big_set(&a, n[k]);
        cwi_big_set(&b, (int64_t)r[k] * l->w - (k == 1 ? l->y : l->z));
        cwi_big_mul(&a, &b, &product);
        cwi_big_add(&out->top, &product, &out->top);
    }
    if (out->bottom.negative) {
        cwi_big_negate(&out->bottom);
        cwi_big_negate(&out->top);
    }
}

static void test_triangle(hits *h, uint32_t t)
{
    const cwi_soup *s = h->w->s;
    const uint32_t *v = s->triangles[t];
    int above = 0, below = 0;
    for (int k = 0; k < 3; k++) {
        const int side = side_of_edge(&h->line, s->vertices[v[k]], s->vertices[v[(k + 1) % 3]]);
        above += side >= 0;
        below += side <= 0;
    }
    if (above < 3 && below < 3)
        return;
    if (above + below > 3) { /* on an edge, or along the triangle */
        h->vague = true;
        return;
    }
    hit *grown = cwi_grow_array(h->hits, h->count, &h->capacity, sizeof *grown);
    h->failed = !grown;
    if (!grown)
        return;
    h->hits = grown;
    h->hits[h->count].triangle = t;
    find_hit_x(h->w, &h->line, t, &h->hits[h->count++]);
}

typedef struct line_visit {
    hits *h;
    float box[6];
} line_visit;

static bool visit_node(void *context, size_t node)
{
    const line_visit *v = context;
    const cwi_boxes *tree = v->h->w->tree;
    unsigned meeting = cwi_boxes_meeting(&tree->nodes[node], v->box);
    for (; meeting; meeting &= meeting - 1) {
        const size_t slot = node * CWI_WIDTH + (size_t)__builtin_ctz(meeting);
        if (slot < tree->count)
            test_triangle(v->h, tree->order[slot]);
    }
    return !v->h->failed && !v->h->vague;
}

static void find_hits(hits *h)
{
    const double y = (double)h->line.y / (double)h->line.w,
                 z = (double)h->line.z / (double)h->line.w;
    line_visit v = {h, {-INFINITY, 0, 0, INFINITY, 0, 0}};
    v.box[1] = nextafterf((float)y, -INFINITY);
    v.box[4] = nextafterf((float)y, INFINITY);
    v.box[2] = nextafterf((float)z, -INFINITY);
    v.box[5] = nextafterf((float)z, INFINITY);
    h->count = 0;
    h->vague = false;
    cwi_boxes_visit(h->w->tree, v.box, 0, visit_node, &v);
}

static int compare_x(const hit *a, const hit *b)
{
    cwi_big difference;
    cwi_big_cross(&a->top, &b->bottom, &b->top, &a->bottom, &difference);
    return cwi_big_sign(&difference);
}

/* Returns the side of an edge between points on which the line is, seen from large x. */
static int side_of_points(const search *w, const line *l, uint32_t from, uint32_t to)
{
    const cwi_exact_point p = cwi_point_at(w->s, w->parts, from),
                          q = cwi_point_at(w->s, w->parts, to);
    cwi_homogeneous a, b;
    cwi_big y, z, lw, minor, product, sum;
    cwi_point_exact(w->s, &p, &a);
    cwi_point_exact(w->s, &q, &b);
    cwi_big_set(&y, l->y);
    cwi_big_set(&z, l->z);
    cwi_big_set(&lw, l->w);
    cwi_big_cross(&a.x[1], &b.x[2], &a.x[2], &b.x[1], &minor);
    cwi_big_mul(&lw, &minor, &sum);
    cwi_big_cross(&a.x[2], &b.w, &a.w, &b.x[2], &minor);
    cwi_big_mul(&y, &minor, &product);
    cwi_big_add(&sum, &product, &sum);
    cwi_big_cross(&a.w, &b.x[1], &a.x[1], &b.w, &minor);
    cwi_big_mul(&z, &minor, &product);
    cwi_big_add(&sum, &product, &sum);
    return cwi_big_sign(&sum);
}

/* Finds the facet of a triangle that the line meets; CWI_NOTHING: it meets an edge, or a part for which another
 * triangle's stands. */
static uint32_t find_facet(const search *w, const line *l, uint32_t t)
{
    if (w->f->first_part[t] == w->f->first_part[t + 1]) {
        const uint32_t facet = w->f->facet_of[t];
        return facet != CWI_NOTHING && w->f->sources[facet] == t ? facet : CWI_NOTHING;
    }
    for (size_t i = w->f->first_part[t]; i < w->f->first_part[t + 1]; i++) {
        const uint32_t *c = w->parts->parts[i].corners;
        const int side = side_of_points(w, l, c[0], c[1]);
        if (side && side == side_of_points(w, l, c[1], c[2]) &&
            side == side_of_points(w, l, c[2], c[0]))
            return w->f->of_part[i];
    }
    return CWI_NOTHING;
}

/* Finds the outermost hit of an island on a line, and the cell that it is seen from. Returns false when the
 * line cannot tell. */
static bool look_along(hits *h, uint32_t island, uint32_t *cell)
{
    const search *w = h->w;
    find_hits(h);
    h->last = h->count;
    if (h->failed || h->vague)
        return false;
    for (size_t n = 0; n < h->count; n++)
        if (island_of(w, h->hits[n].triangle) == island &&
            (h->last == h->count || compare_x(&h->hits[n], &h->hits[h->last]) > 0))
            h->last = n;
    for (size_t n = 0; n < h->count; n++) { /* of triangles that overlap one has the facet */
        if (island_of(w, h->hits[n].triangle) != island ||
            compare_x(&h->hits[n], &h->hits[h->last]) != 0)
            continue;
        const uint32_t facet = find_facet(w, &h->line, h->hits[n].triangle);
        if (facet == CWI_NOTHING)
            continue;
        *cell = h->hits[n].front ? front_of(w, facet) : back_of(w, facet);
        return true;
    }
    return false;
}

/* --- all cells ---------------------------------------------------------------------------- */

/* The numbers of the cell that a walk is in. */
typedef struct walk {
    const search *w;
    cwi_keep_cell keep;
    const void *context;
    int32_t *windings;
    size_t positive, negative; /* inputs whose number is above 0, below 0 */
    uint8_t *kept;
    bool *seen;
    size_t *next; /* of each cell, the passage to try next */
} walk;

static void add_winding(walk *k, uint32_t triangle, int by)
{
    int32_t *n = &k->windings[k->w->inputs[triangle]];
    k->positive -= *n > 0;
    k->negative -= *n < 0;
    *n += by;
    k->positive += *n > 0;
    k->negative += *n < 0;
}

/* Changes the numbers as by a way through a facet: forwards from its front to its back. */
static void cross_facet(walk *k, uint32_t facet, bool forwards)
{
    const cwi_facets *f = k->w->f;
    size_t low = 0, high = f->cover_count;
    add_winding(k, f->sources[facet], forwards ? 1 : -1);
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (f->covers[middle].facet < facet)
            low = middle + 1;
        else
            high = middle;
    }
    for (; low < f->cover_count && f->covers[low].facet == facet; low++)
        add_winding(k, f->covers[low].triangle,
                    forwards ? f->covers[low].sign : -f->covers[low].sign);
}

static void judge_cell(walk *k, uint32_t cell)
{
    k->kept[cell] = k->keep(k->context, k->windings, k->positive, k->negative);
}

/* Visits all cells of an island, and comes back with the numbers that it began with. */
static void walk_island(walk *k, uint32_t cell, uint32_t *stack, uint32_t *ways)
{
    const search *w = k->w;
    size_t depth = 0;
    stack[depth++] = cell;
    k->seen[cell] = true;
    k->next[cell] = w->first[cell];
    judge_cell(k, cell);
    while (depth) {
        const uint32_t at = stack[depth - 1];
        if (k->next[at] == w->first[at + 1]) {
            if (--depth) /* back through the facet that led here */
                cross_facet(k, ways[depth], back_of(w, ways[depth]) != at);
            continue;
        }
        const passage *p = &w->passages[k->next[at]++];
        if (k->seen[p->to])
            continue;
        cross_facet(k, p->facet, front_of(w, p->facet) == at);
        k->seen[p->to] = true;
        k->next[p->to] = w->first[p->to];
        judge_cell(k, p->to);
        ways[depth] = p->facet;
        stack[depth++] = p->to;
    }
}

/* Returns true if a triangle lies along x: lines through its points tell nothing. */
static bool lies_along(const cwi_soup *s, const uint32_t v[3])
{
    cwi_wide d[2][2];
    for (int k = 0; k < 2; k++)
        for (int a = 0; a < 2; a++)
            d[k][a] = (cwi_wide)s->vertices[v[k + 1]][a + 1] - s->vertices[v[0]][a + 1];
    return d[0][0] * d[1][1] == d[0][1] * d[1][0];
}

/* Finds a cell of an island that is seen from outside: tries lines through points of its triangles, but for those
 * along x, which may be all but a few. */
static bool find_outside(hits *h, const uint32_t *triangles, size_t count, uint32_t island,
                         uint32_t *cell)
{
    enum { TRIES = 4096 };
    const cwi_soup *s = h->w->s;
    uint32_t random = 12345;
    for (size_t n = 0, tries = 0; tries < TRIES; n++) {
        if (n == count && tries == 0)
            return false;
        n %= count;
        const uint32_t *v = s->triangles[triangles[n]];
        cwi_wide weights[3];
        if (lies_along(s, v))
            continue;
        tries++;
        h->line = (line){0, 0, 0};
        for (int k = 0; k < 3; k++) {
            random = random * 1664525u + 1013904223u;
            weights[k] = 1 + (random >> 16) % 1000;
            h->line.y += weights[k] * (int64_t)s->vertices[v[k]][1];
            h->line.z += weights[k] * (int64_t)s->vertices[v[k]][2];
            h->line.w += weights[k];
        }
        if (look_along(h, island, cell))
            return true;
        if (h->failed)
            return false;
    }
    return false;
}

/* Adds what other islands count at the outermost hit of an island; or takes it away: sign -1. */
static void add_islands_around(walk *k, const hits *h, uint32_t island, int sign)
{
    for (size_t n = 0; n < h->count; n++) {
        const hit *x = &h->hits[n];
        if (island_of(h->w, x->triangle) != island && compare_x(x, &h->hits[h->last]) > 0)
            add_winding(k, x->triangle, x->front ? sign : -sign);
    }
}

/* Lists the triangles of each island. */
static bool list_islands(const search *w, size_t **first, uint32_t **triangles)
{
    const size_t count = w->s->triangle_count;
    *first = cwi_alloc_zeroed(w->island_count + 2, sizeof **first);
    *triangles = cwi_alloc_array(count, sizeof **triangles);
    if (!*first || !*triangles)
        return false;
    for (uint32_t t = 0; t < count; t++)
        if (island_of(w, t) != CWI_NOTHING)
            (*first)[island_of(w, t) + 2]++;
    for (size_t n = 0; n < w->island_count; n++)
        (*first)[n + 2] += (*first)[n + 1];
    for (uint32_t t = 0; t < count; t++)
        if (island_of(w, t) != CWI_NOTHING)
            (*triangles)[(*first)[island_of(w, t) + 1]++] = t;
    return true;
}

static cw_status walk_islands(search *w, walk *k, cw_error *err)
{
    hits h = {.w = w};
    size_t *first = NULL;
    uint32_t *triangles = NULL, *ways = cwi_alloc_array(w->cells->count + 1, sizeof *ways);
    cw_status st = ways && list_islands(w, &first, &triangles) ? CW_OK : cwi_fail_memory(err);
    for (uint32_t n = 0; n < w->island_count && st == CW_OK; n++) {
        uint32_t cell = 0;
        if (first[n] == first[n + 1])
            continue;
        if (!find_outside(&h, triangles + first[n], first[n + 1] - first[n], n, &cell)) {
            st = h.failed ? cwi_fail_memory(err)
                          : cwi_fail(err, CW_ERR_CHECK, "no line tells what is outside");
            break;
        }
        add_islands_around(k, &h, n, 1);
        walk_island(k, cell, w->stack, ways);
        add_islands_around(k, &h, n, -1);
    }
    cwi_free(h.hits);
    cwi_free(first);
    cwi_free(triangles);
    cwi_free(ways);
    return st;
}

cw_status cwi_find_windings(const cwi_soup *s, const cwi_triangle_parts *parts,
                            const cwi_facets *facets, const cwi_space_cells *cells,
                            const cwi_boxes *tree, const uint32_t *inputs, size_t input_count,
                            cwi_keep_cell keep, const void *context, uint8_t *kept,
                            cw_error *err)
{
    search w = {
        .s = s, .parts = parts, .f = facets, .cells = cells, .inputs = inputs, .tree = tree};
    walk k = {.w = &w, .keep = keep, .context = context, .kept = kept};
    k.windings = cwi_alloc_zeroed(input_count, sizeof *k.windings);
    k.seen = cwi_alloc_zeroed(cells->count, sizeof *k.seen);
    k.next = cwi_alloc_array(cells->count, sizeof *k.next);
    cw_status st = CW_OK;
    if (!k.windings || !k.seen || !k.next || !list_passages(&w) || !find_islands(&w))
        st = cwi_fail_memory(err);
    if (st == CW_OK && tree->count != s->triangle_count) {
        w.tree = &w.own;
        st = cwi_soup_tree(s, NULL, s->triangle_count, &w.own, err);
    }
    if (st == CW_OK)
        st = walk_islands(&w, &k, err);
    cwi_boxes_free(&w.own);
    cwi_free(w.passages);
    cwi_free(w.first);
    cwi_free(w.island);
    cwi_free(w.stack);
    cwi_free(k.windings);
    cwi_free(k.seen);
    cwi_free(k.next);
    return st;
}
