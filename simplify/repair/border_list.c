/* Lists open edges, and finds those that lie along each other by a tree of boxes. */
#include "simplify/repair/border_list.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/bvh.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"

#include <math.h>

/* Edges that lie along each other are nearer than this share of the length that both have in common. A distance that
 * the user gives may be a larger share. */
static const double FOUND_SHARE = 0.1, GIVEN_SHARE = 0.5;

/* Triangles at two edges whose directions away from them have a larger cosine lie on each other: they are the two walls
 * of something thin, which ends there. Walls are MIN_WALL times higher than they are apart, unlike slivers. */
static const double MAX_FOLD = 0.98, MIN_WALL = 4;

/* Edges between two reports of progress. */
enum { PROGRESS_STEP = 4096 };

void cwi_borders_free(cwi_border_list *list)
{
    cwi_free(list->edges);
    cwi_free(list->pairs);
    *list = (cwi_border_list){0};
}

/* --- open edges --------------------------------------------------------------------------- */

/* Returns true if all sides along an edge are of triangles with the same vertices. */
static bool is_open(const cw_mesh *m, const cwi_side *sides, size_t along)
{
    const uint32_t tip = m->triangles[cwi_corner_prev(sides->corner)];
    for (size_t n = 1; n < along; n++)
        if (m->triangles[cwi_corner_prev(sides[n].corner)] != tip)
            return false;
    return true;
}

static double measure_length(const cw_mesh *m, uint32_t corner)
{
    const float *p = m->positions + 3 * (size_t)m->triangles[corner],
                *q = m->positions + 3 * (size_t)m->triangles[cwi_corner_next(corner)];
    return sqrt(cwi_point_distance_sq(p, q));
}

static bool list_edges(cwi_border_list *list)
{
    const cw_mesh *m = list->mesh;
    const size_t corners = 3 * m->triangle_count;
    cwi_side *sides = cwi_alloc_array(corners, sizeof *sides);
    size_t count = 0;
    if (!sides)
        return false;
    cwi_sides_list(m->triangles, corners, sides);
    for (size_t n = 0, along; n < corners; n += along) {
        along = cwi_sides_along(sides, corners, n);
        for (size_t k = 0; k < along && is_open(m, sides + n, along); k++)
            sides[count++].corner = sides[n + k].corner;
    }
    list->edges = cwi_alloc_array(count, sizeof *list->edges);
    for (size_t n = 0; n < count && list->edges; n++) {
        const double length = measure_length(m, sides[n].corner);
        if (length > 0)
            list->edges[list->count++] = (cwi_open_edge){sides[n].corner, length, INFINITY};
    }
    cwi_free(sides);
    return list->edges != NULL;
}

/* --- two edges ---------------------------------------------------------------------------- */

/* A vertex in the frame of the longer edge: along it from its start, and as it is. */
typedef struct edge_end {
    uint32_t vertex;
    double along;
    const float *p;
} edge_end;

/* The ends of two edges, in the direction of the longer one, a. */
typedef struct edge_frame {
    edge_end a[2], b[2];
    uint32_t corner[2];
    double common; /* the length that both have in common */
} edge_frame;

static edge_end make_end(const cw_mesh *m, uint32_t vertex, const float *from,
                         const double along[3])
{
    double to[3];
    const float *p = m->positions + 3 * (size_t)vertex;
    cwi_sub_points(p, from, to);
    return (edge_end){vertex, cwi_dot(to, along), p};
}

static void set_frame(const cwi_border_list *list, const uint32_t edges[2], edge_frame *f)
{
    const cw_mesh *m = list->mesh;
    double along[3];
    for (int n = 0; n < 2; n++)
        f->corner[n] = list->edges[edges[n]].corner;
    const uint32_t c = f->corner[0], d = f->corner[1];
    const float *from = m->positions + 3 * (size_t)m->triangles[c];
    cwi_sub_points(m->positions + 3 * (size_t)m->triangles[cwi_corner_next(c)], from, along);
    cwi_normalise(along);
    for (int n = 0; n < 2; n++) {
        f->a[n] = make_end(m, m->triangles[n ? cwi_corner_next(c) : c], from, along);
        f->b[n] = make_end(m, m->triangles[n ? cwi_corner_next(d) : d], from, along);
    }
    if (f->b[0].along > f->b[1].along) {
        const edge_end e = f->b[0];
        f->b[0] = f->b[1];
        f->b[1] = e;
    }
    f->common = fmin(f->a[1].along, f->b[1].along) - fmax(f->a[0].along, f->b[0].along);
}

/* Finds the end that is on the other edge, the fraction there, and the distance from it. side: 0 or 1 */
static double reach_edge(const edge_frame *f, int side, bool *is_b, double *at)
{
    const bool b_is_inside =
        side == 0 ? f->b[0].along >= f->a[0].along : f->b[1].along <= f->a[1].along;
    const edge_end *in = b_is_inside ? &f->b[side] : &f->a[side],
                   *on = b_is_inside ? f->a : f->b;
    const double length = on[1].along - on[0].along;
    double distance_sq = 0;
    *is_b = b_is_inside;
    *at = fmin(fmax((in->along - on[0].along) / length, 0), 1);
    for (int k = 0; k < 3; k++) {
        const double p = (double)on[0].p[k] + *at * ((double)on[1].p[k] - (double)on[0].p[k]);
        distance_sq += (p - (double)in->p[k]) * (p - (double)in->p[k]);
    }
    return sqrt(distance_sq);
}

/* Measures how far two edges that lie along each other are apart: at ends that are near each other from end to end,
 * else from an end to the other edge. Infinite if they do not. */
static double measure_pair(const cwi_border_list *list, const edge_frame *f)
{
    double most = 0;
    const double limit = list->share * f->common;
    for (int n = 0; n < 2 && f->common > 0; n++) {
        const double apart = sqrt(cwi_point_distance_sq(f->a[n].p, f->b[n].p));
        bool is_b;
        double at;
        most = fmax(most, apart <= limit ? apart : reach_edge(f, n, &is_b, &at));
    }
    return f->common > 0 && most <= limit ? most : INFINITY;
}

/* Computes the direction from a triangle's side into it. Returns the triangle's height. */
static double find_inward(const cw_mesh *m, uint32_t corner, double out[3])
{
    const uint32_t *v = m->triangles;
    const float *p = m->positions + 3 * (size_t)v[corner];
    double along[3];
    cwi_sub_points(m->positions + 3 * (size_t)v[cwi_corner_next(corner)], p, along);
    cwi_sub_points(m->positions + 3 * (size_t)v[cwi_corner_prev(corner)], p, out);
    if (!cwi_normalise(along))
        return 0;
    cwi_add_scaled(out, -cwi_dot(out, along), along, out);
    const double height = cwi_length(out);
    return cwi_normalise(out) ? height : 0;
}

/* Returns true if the triangles at two edges lie on each other, at a distance. */
static bool are_walls(const cwi_border_list *list, const uint32_t edges[2], double distance)
{
    double inward[2][3];
    for (int n = 0; n < 2; n++)
        if (!(find_inward(list->mesh, list->edges[edges[n]].corner, inward[n]) >
              MIN_WALL * distance))
            return false;
    return cwi_dot(inward[0], inward[1]) > MAX_FOLD;
}

bool cwi_borders_overlap(const cwi_border_list *list, const uint32_t edges[2], double reach_mm,
                         cwi_overlap ends[2])
{
    edge_frame f;
    set_frame(list, edges, &f);
    const double limit = fmin(reach_mm, list->share * f.common);
    for (int n = 0; n < 2; n++) {
        const double apart = sqrt(cwi_point_distance_sq(f.a[n].p, f.b[n].p));
        bool is_b;
        double at;
        ends[n] = (cwi_overlap){.vertex = f.a[n].vertex, .other = f.b[n].vertex};
        if (apart <= limit)
            continue;
        if (!(reach_edge(&f, n, &is_b, &at) <= limit))
            return false;
        ends[n].is_split = true;
        ends[n].vertex = is_b ? f.b[n].vertex : f.a[n].vertex;
        ends[n].corner = f.corner[is_b ? 0 : 1];
        const edge_end *on = is_b ? f.a : f.b;
        const bool runs_along = list->mesh->triangles[ends[n].corner] == on[0].vertex;
        ends[n].at = runs_along ? at : 1 - at;
    }
    return true;
}

/* --- pairs -------------------------------------------------------------------------------- */

typedef struct pair_search {
    cwi_border_list *list;
    cwi_boxes tree;
    uint32_t edge; /* whose partners are sought: those that are not longer */
    float box[6];
    bool is_out_of_memory;
} pair_search;

static bool add_pair(cwi_border_list *list, uint32_t longer, uint32_t shorter)
{
    if (list->pair_count == list->pair_capacity) {
        const size_t capacity = 2 * list->pair_capacity + 64;
        cwi_border_pair *more = cwi_realloc_array(list->pairs, capacity, sizeof *more);
        if (!more)
            return false;
        list->pairs = more;
        list->pair_capacity = capacity;
    }
    list->pairs[list->pair_count++] = (cwi_border_pair){{longer, shorter}};
    return true;
}

/* Returns true if two edges may lie along each other: they are of two triangles, and not the same. */
static bool may_pair(const cwi_border_list *list, uint32_t a, uint32_t b)
{
    const uint32_t c = list->edges[a].corner, d = list->edges[b].corner;
    const uint32_t *v = list->mesh->triangles;
    return c / 3 != d / 3 && cwi_edge_key(v[c], v[cwi_corner_next(c)]) !=
                                 cwi_edge_key(v[d], v[cwi_corner_next(d)]);
}

static bool meet_node(void *context, size_t node)
{
    pair_search *s = context;
    cwi_border_list *list = s->list;
    cwi_open_edge *edge = &list->edges[s->edge];
    unsigned meeting = cwi_boxes_meeting(s->tree.nodes + s->tree.first[0] + node, s->box);
    for (; meeting; meeting &= meeting - 1) {
        const uint32_t n = s->tree.order[node * CWI_WIDTH + (size_t)__builtin_ctz(meeting)];
        cwi_open_edge *other = &list->edges[n];
        const bool is_longer =
            edge->length > other->length || (edge->length == other->length && s->edge < n);
        if (!is_longer || !may_pair(list, s->edge, n))
            continue;
        edge_frame f;
        const uint32_t edges[2] = {s->edge, n};
        set_frame(list, edges, &f);
        const double distance = measure_pair(list, &f);
        if (!isfinite(distance) ||
            (list->share < GIVEN_SHARE && are_walls(list, edges, distance)))
            continue;
        edge->nearest = fmin(edge->nearest, distance);
        other->nearest = fmin(other->nearest, distance);
        if (!add_pair(list, s->edge, n)) {
            s->is_out_of_memory = true;
            return false;
        }
    }
    return true;
}

/* Computes the box around an edge, widened. */
static void set_box(const cwi_border_list *list, size_t n, double wider, float box[6])
{
    const cw_mesh *m = list->mesh;
    const uint32_t c = list->edges[n].corner;
    const uint32_t v[3] = {m->triangles[c], m->triangles[cwi_corner_next(c)], m->triangles[c]};
    cwi_boxes_triangle(m->positions, v, box);
    for (int a = 0; a < 3; a++) {
        box[a] = nextafterf((float)((double)box[a] - wider), -INFINITY);
        box[a + 3] = nextafterf((float)((double)box[a + 3] + wider), INFINITY);
    }
}

static cw_status find_pairs(const cwi_repair *r, pair_search *s, cw_error *err)
{
    cwi_border_list *list = s->list;
    float(*boxes)[6] = cwi_alloc_array(list->count, sizeof *boxes);
    if (!boxes)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < list->count; n++)
        set_box(list, n, 0, boxes[n]);
    cw_status st = cwi_boxes_build(&s->tree, (const float(*)[6])boxes, list->count, err);
    cwi_free(boxes);
    for (size_t n = 0; n < list->count && st == CW_OK; n++) {
        double reach = list->share * list->edges[n].length;
        if (r->desc.weld_mm > 0)
            reach = fmin(reach, r->desc.weld_mm);
        s->edge = (uint32_t)n;
        set_box(list, n, reach, s->box);
        cwi_boxes_visit(&s->tree, s->box, 0, meet_node, s);
        if (s->is_out_of_memory)
            st = cwi_fail_memory(err);
        if (st == CW_OK && n % PROGRESS_STEP == 0)
            st = cwi_repair_progress((cwi_repair *)r, "stitching borders", 0, err);
    }
    cwi_boxes_free(&s->tree);
    return st;
}

cw_status cwi_borders_list(const cwi_repair *r, cwi_border_list *list, cw_error *err)
{
    pair_search s = {.list = list};
    list->mesh = &r->mesh;
    list->share = r->desc.weld_mm > 0 ? GIVEN_SHARE : FOUND_SHARE;
    if (!list_edges(list))
        return cwi_fail_memory(err);
    return list->count ? find_pairs(r, &s, err) : CW_OK;
}
