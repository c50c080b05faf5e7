/* Which closed shells face the wrong way: a solid's shell faces outward where nothing is around
 * it, a cavity's inward where one solid is. */
#include "simplify/quality/shell_orientation.h"

#include "core/base/parallel.h"
#include "core/geometry/bvh.h"
#include "core/geometry/exact_predicates.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

typedef struct work {
    const cwi_welded *welded;
    const cwi_shells *shells;
    uint32_t *part;
    cwi_boxes tree;
    uint32_t *closed; /* the roots of closed shells */
    int *around;      /* how often the other shells wind around each of these */
    size_t *depth;    /* how many triangles of closed ones a ray from it meets */
    size_t count;
} work;

/* A ray from a vertex along +x, met with the triangles of other shells. */
typedef struct ray {
    const work *w;
    uint32_t shell; /* where it starts */
    const float *start;
    int winding;
    size_t met; /* triangles of closed shells */
} ray;

static int sign_of(float x)
{
    return (x > 0) - (x < 0);
}

/* On which side of the edge a b, seen along x, the start is when moved by a little in z and far
 * less in y: then it is on none. */
static int side_of(const float *a, const float *b, const float *start)
{
    const int side = cwi_orient2d(a, b, start, 0);
    const int next = side ? side : sign_of(b[1] - a[1]);
    return next ? next : -sign_of(b[2] - a[2]);
}

/* How often the triangle, seen along x, winds around the start: -1, 0 or 1. */
static int winding_of(const float *const corner[3], const float *start)
{
    int winding = 0;
    for (int n = 0; n < 3; n++) {
        const float *a = corner[n], *b = corner[(n + 1) % 3];
        const bool a_above = a[2] > start[2], b_above = b[2] > start[2];
        if (a_above != b_above && side_of(a, b, start) == (b_above ? 1 : -1))
            winding += b_above ? 1 : -1;
    }
    return winding;
}

static void meet_triangle(ray *r, uint32_t triangle)
{
    const cwi_welded *w = r->w->welded;
    const uint32_t *v = w->vertex + 3 * (size_t)triangle;
    const float *corner[3];
    if (r->w->part[v[0]] == r->shell)
        return;
    for (int n = 0; n < 3; n++)
        corner[n] = w->points + 3 * (size_t)v[n];
    const int winding = winding_of(corner, r->start);
    if (winding && winding * cwi_orient3d(corner[0], corner[1], corner[2], r->start) < 0) {
        r->winding += winding;
        r->met += !r->w->shells->unbounded[r->w->part[v[0]]];
    }
}

static void box_around(const ray *r, float box[6])
{
    const float *s = r->start;
    const float ends[6] = {s[0], s[1], s[2], INFINITY, s[1], s[2]};
    memcpy(box, ends, sizeof ends);
}

static bool meet_node(void *context, size_t node)
{
    ray *r = context;
    const cwi_boxes *tree = &r->w->tree;
    float box[6];
    box_around(r, box);
    const unsigned meeting = cwi_boxes_meeting(&tree->nodes[node], box);
    for (size_t c = 0; meeting >> c; c++)
        if (meeting >> c & 1)
            meet_triangle(r, tree->order[node * CWI_WIDTH + c]);
    return true;
}

static void wind_around(void *context, size_t k)
{
    work *w = context;
    ray r = {w, w->closed[k], w->welded->points + 3 * (size_t)w->closed[k], 0, 0};
    float box[6];
    box_around(&r, box);
    cwi_boxes_visit(&w->tree, box, 0, meet_node, &r);
    w->around[k] = r.winding;
    w->depth[k] = r.met;
}

/* An open shell has no volume for certain. One that has a tenth of a sphere's of its area, seen
 * from a point of its own, is nearly closed, and its sign tells how it faces. */
static void find_open_inward(const work *w, uint8_t *wrong, cw_quality *q)
{
    for (size_t v = 0; v < w->welded->mesh->vertex_count; v++) {
        const double area = w->shells->area[v], whole = area * sqrt(area) / (6 * sqrt(CWI_PI));
        wrong[v] = wrong[v] == 1 && w->shells->volume[v] < -0.1 * whole;
        q->open_inward += wrong[v];
    }
}

enum { WRONG = 1, TURN = 2 };

/* Judges shells: the direction that a shell should face follows from its place, whichever way
 * others do. In a solid it faces inwards where it is inside an odd number of them. An open
 * shell is never turned: a bowl may face either way. */
static void judge_shells(const work *w, const cw_quality_desc *d, cw_quality *q)
{
    uint8_t *found = w->shells->unbounded; /* has served its purpose */
    find_open_inward(w, found, q);
    for (size_t k = 0; k < w->count; k++) {
        const bool inward = w->shells->volume[w->closed[k]] < 0;
        q->cavities += inward && w->around[k] == 1;
        q->inside_out += inward && w->around[k] != 1;
        q->nested += !inward && w->around[k] != 0;
        found[w->closed[k]] = (w->around[k] != (inward ? 1 : 0) ? WRONG : 0) |
                              (inward != (w->depth[k] % 2 == 1) ? TURN : 0);
        q->to_turn += (found[w->closed[k]] & TURN) != 0;
    }
    for (size_t t = 0; t < w->welded->mesh->triangle_count && (d->defects || d->turn); t++) {
        const uint8_t here = found[w->part[w->welded->vertex[3 * t]]];
        if (d->turn)
            d->turn[t] = here & TURN ? 1 : 0;
        if (d->defects && here & WRONG && !cwi_is_collapsed(w->welded, t))
            d->defects[t] |= CW_DEFECT_INSIDE_OUT;
    }
}

/* Roots are found once and for all, so that threads may read them. */
static void list_closed(work *w)
{
    const size_t vertices = w->welded->mesh->vertex_count;
    for (uint32_t v = 0; v < vertices; v++) {
        w->part[v] = cwi_sets_find(w->part, v);
        if (w->part[v] == v && w->shells->used[v] && !w->shells->unbounded[v])
            w->closed[w->count++] = v;
    }
}

bool cwi_measure_shells(const cwi_welded *welded, const cwi_shells *shells,
                        const cw_quality_desc *desc, cw_quality *q)
{
    const size_t vertices = welded->mesh->vertex_count;
    work w = {.welded = welded, .shells = shells, .part = shells->part};
    w.closed = cwi_alloc_array(vertices, sizeof *w.closed);
    w.around = cwi_alloc_zeroed(vertices, sizeof *w.around);
    w.depth = cwi_alloc_zeroed(vertices, sizeof *w.depth);
    bool ok = w.closed && w.around && w.depth && cwi_welded_sort(welded, &w.tree);
    if (ok) {
        list_closed(&w);
        ok = cwi_each_layer(w.count, 1 << 12, desc->threads, &desc->progress, "checking",
                            wind_around, &w, NULL) == CW_OK;
    }
    if (ok)
        judge_shells(&w, desc, q);
    cwi_boxes_free(&w.tree);
    cwi_free(w.closed);
    cwi_free(w.around);
    cwi_free(w.depth);
    return ok;
}
