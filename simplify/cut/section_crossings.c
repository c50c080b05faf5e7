/* Finds where rounding has made the section cross itself, or triangles at the section cross others.
 * Boxes find the candidates, exact signs decide. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/bvh.h"
#include "core/geometry/exact_predicates.h"
#include "core/geometry/triangle_intersect.h"
#include "simplify/cut/cut_state.h"

#include <math.h>

/* A search of items of a tree against each other. */
typedef struct crossing_search {
    const cwi_cut *cut;
    uint8_t *marks;
    size_t *count;
    size_t first_cap; /* triangles from here on fill the section */
    uint32_t *items;  /* edges or triangles in the tree */
    size_t item_count;
    cwi_boxes tree;
    double highest; /* distance of the highest vertex of the triangles to the plane */
    uint32_t query; /* the edge or triangle that is searched now */
    float box[6];   /* around it */
    bool (*meets)(struct crossing_search *s, uint32_t a, uint32_t b);
} crossing_search;

static const float *find_place(const cwi_cut *c, uint32_t v)
{
    return c->positions + 3 * (size_t)v;
}

static void mark_vertex(crossing_search *s, uint32_t v, unsigned mark)
{
    if (s->cut->is_section[v])
        s->marks[v] |= (uint8_t)mark;
}

static bool visit_node(void *context, size_t node)
{
    crossing_search *s = context;
    unsigned meeting = cwi_boxes_meeting(&s->tree.nodes[node], s->box);
    for (; meeting; meeting &= meeting - 1) {
        const size_t slot = node * CWI_WIDTH + (size_t)__builtin_ctz(meeting);
        const uint32_t item = s->items[s->tree.order[slot]];
        *s->count += s->meets(s, s->query, item);
    }
    return true;
}

static cw_status build_tree(crossing_search *s,
                            void (*set_box)(const crossing_search *s, uint32_t item,
                                            float box[6]),
                            cw_error *err)
{
    float(*boxes)[6] = cwi_alloc_array(s->item_count, sizeof *boxes);
    if (!boxes)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < s->item_count; n++)
        set_box(s, s->items[n], boxes[n]);
    cw_status st = cwi_boxes_build(&s->tree, (const float(*)[6])boxes, s->item_count, err);
    cwi_free(boxes);
    return st;
}

/* --- edges, as the plane's axis shows them ------------------------------------------------- */

static void set_edge_box(const crossing_search *s, uint32_t item, float box[6])
{
    const cwi_cut_edge e = s->cut->edges[item];
    const uint32_t ends[3] = {e.start, e.end, e.end};
    cwi_boxes_triangle(s->cut->positions, ends, box);
    box[s->cut->axis] = box[s->cut->axis + 3] = 0;
}

static bool is_between(const float *p, const float *a, const float *b)
{
    for (int k = 0; k < 3; k++)
        if ((p[k] < a[k] && p[k] < b[k]) || (p[k] > a[k] && p[k] > b[k]))
            return false;
    return true;
}

/* Returns true if two edges of the section without a common end share a point, touching included. */
static bool segments_meet(const float *a, const float *b, const float *p, const float *q,
                          int axis)
{
    const int ap = cwi_orient2d(a, b, p, axis), aq = cwi_orient2d(a, b, q, axis),
              pa = cwi_orient2d(p, q, a, axis), pb = cwi_orient2d(p, q, b, axis);
    if (ap || aq || pa || pb)
        return ap * aq <= 0 && pa * pb <= 0;
    return is_between(p, a, b) || is_between(q, a, b) || is_between(a, p, q);
}

/* Returns true if two edges from one vertex lie on each other. */
static bool is_folded(const float *from, const float *a, const float *b, int axis)
{
    double dot = 0;
    for (int k = 0; k < 3; k++)
        if (k != axis)
            dot += ((double)a[k] - (double)from[k]) * ((double)b[k] - (double)from[k]);
    return cwi_orient2d(from, a, b, axis) == 0 && dot > 0;
}

static bool edges_meet(crossing_search *s, uint32_t a, uint32_t b)
{
    const cwi_cut *c = s->cut;
    const cwi_cut_edge e = c->edges[a], f = c->edges[b];
    const bool same[4] = {e.start == f.start, e.start == f.end, e.end == f.start,
                          e.end == f.end};
    bool meet;
    float p[4][3];
    const uint32_t v[4] = {e.start, e.end, f.start, f.end};
    if (a >= b || (same[0] && same[3]) || (same[1] && same[2]))
        return false;
    for (int n = 0; n < 4; n++) {
        for (int k = 0; k < 3; k++)
            p[n][k] = find_place(c, v[n])[k];
        p[n][c->axis] = 0;
    }
    if (same[0] || same[1])
        meet = is_folded(p[0], p[1], same[0] ? p[3] : p[2], c->axis);
    else if (same[2] || same[3])
        meet = is_folded(p[1], p[0], same[2] ? p[3] : p[2], c->axis);
    else
        meet = segments_meet(p[0], p[1], p[2], p[3], c->axis);
    for (int n = 0; n < 4 && meet; n++)
        mark_vertex(s, v[n], CWI_CUT_SHIFT);
    return meet;
}

/* Marks the ends of an edge that is seen as a point. */
static bool is_point(crossing_search *s, uint32_t item)
{
    const cwi_cut_edge e = s->cut->edges[item];
    const float *p = find_place(s->cut, e.start), *q = find_place(s->cut, e.end);
    for (int k = 0; k < 3; k++)
        if (k != s->cut->axis && p[k] != q[k])
            return false;
    mark_vertex(s, e.start, CWI_CUT_SHIFT);
    mark_vertex(s, e.end, CWI_CUT_SHIFT);
    return true;
}

cw_status cwi_cut_find_edge_crossings(const cwi_cut *c, uint8_t *marks, size_t *count,
                                      cw_error *err)
{
    crossing_search s = {.cut = c, .marks = marks, .count = count, .meets = edges_meet};
    *count = 0;
    if (!c->edge_count)
        return CW_OK;
    s.items = cwi_alloc_array(c->edge_count, sizeof *s.items);
    if (!s.items)
        return cwi_fail_memory(err);
    for (uint32_t e = 0; e < c->edge_count; e++)
        s.items[s.item_count++] = e;
    cw_status st = build_tree(&s, set_edge_box, err);
    for (uint32_t e = 0; e < c->edge_count && st == CW_OK; e++) {
        s.query = e;
        set_edge_box(&s, e, s.box);
        *count += is_point(&s, e);
        cwi_boxes_visit(&s.tree, s.box, 0, visit_node, &s);
    }
    cwi_boxes_free(&s.tree);
    cwi_free(s.items);
    return st;
}

/* --- triangles ----------------------------------------------------------------------------- */

static const uint32_t *find_corners(const crossing_search *s, uint32_t triangle)
{
    return s->cut->triangles + 3 * (size_t)triangle;
}

static void set_triangle_box(const crossing_search *s, uint32_t item, float box[6])
{
    cwi_boxes_triangle(s->cut->positions, find_corners(s, item), box);
}

static bool is_cap(const crossing_search *s, uint32_t triangle)
{
    return triangle >= s->first_cap;
}

static bool has_section_corner(const crossing_search *s, uint32_t triangle)
{
    const uint32_t *v = find_corners(s, triangle);
    const bool *is_section = s->cut->is_section;
    return is_section[v[0]] || is_section[v[1]] || is_section[v[2]];
}

/* Finds the triangle of the mesh that a triangle is part of. Returns false where vertices of several
 * have merged. */
static bool find_origin(const crossing_search *s, uint32_t triangle, uint32_t corners[3])
{
    int count = 0;
    for (int n = 0; n < 6; n++) {
        const cwi_cut_source *source = s->cut->sources + find_corners(s, triangle)[n / 2];
        const uint32_t v = n % 2 ? source->b : source->a;
        bool is_known = false;
        for (int k = 0; k < count; k++)
            is_known = is_known || corners[k] == v;
        if (is_known)
            continue;
        if (count == 3)
            return false;
        corners[count++] = v;
    }
    return count == 3;
}

static int count_common(const uint32_t a[3], const uint32_t b[3])
{
    int count = 0;
    for (int n = 0; n < 3; n++)
        count += b[n] == a[0] || b[n] == a[1] || b[n] == a[2];
    return count;
}

/* Returns true if two triangles that fill no section come from ones that crossed already, or had no
 * area. */
static bool was_faulty(const crossing_search *s, uint32_t a, uint32_t b)
{
    uint32_t from_a[3], from_b[3];
    const float *p = s->cut->mesh->positions;
    if (is_cap(s, a) || is_cap(s, b) || !find_origin(s, a, from_a) ||
        !find_origin(s, b, from_b))
        return false;
    if (!cwi_has_area(p, from_a) || !cwi_has_area(p, from_b))
        return true;
    return a != b && count_common(from_a, from_b) < 3 && cwi_triangles_meet(p, from_a, from_b);
}

/* Marks vertices of the section to shift, and those of a cap's triangle to lower, away from the
 * triangle above. */
static void mark_triangles(crossing_search *s, uint32_t a, uint32_t b)
{
    for (int n = 0; n < 3; n++) {
        mark_vertex(s, find_corners(s, a)[n], CWI_CUT_SHIFT);
        mark_vertex(s, find_corners(s, b)[n], CWI_CUT_SHIFT);
    }
    if (is_cap(s, a) == is_cap(s, b))
        return;
    const uint32_t *cap = find_corners(s, is_cap(s, a) ? a : b),
                   *above = find_corners(s, is_cap(s, a) ? b : a);
    for (int n = 0; n < 3; n++)
        if (cap[n] != above[0] && cap[n] != above[1] && cap[n] != above[2])
            mark_vertex(s, cap[n], CWI_CUT_LOWER);
}

/* Returns on which side of the line from a to b a point is, as the plane's axis shows them. */
static int find_side(const crossing_search *s, uint32_t a, uint32_t b, uint32_t point)
{
    const float *p = s->cut->positions;
    return cwi_orient2d(p + 3 * (size_t)a, p + 3 * (size_t)b, p + 3 * (size_t)point,
                        s->cut->axis);
}

/* Returns true if an edge, or a point if both ends are one, has no point in a triangle, as the plane's axis shows them:
 * a line along one of their sides parts them. */
static bool is_apart(const crossing_search *s, uint32_t a, uint32_t b, const uint32_t v[3])
{
    const int turn = find_side(s, v[0], v[1], v[2]);
    for (int n = 0; n < 3; n++)
        if (find_side(s, v[n], v[(n + 1) % 3], a) * turn < 0 &&
            find_side(s, v[n], v[(n + 1) % 3], b) * turn < 0)
            return true;
    const int first = find_side(s, a, b, v[0]);
    return first && find_side(s, a, b, v[1]) == first && find_side(s, a, b, v[2]) == first;
}

/* Returns true if a triangle of the surface stands on a cap's triangle, away from its corners. Loops do not cross, so this
 * one's lies inside of the other's: the shells are within each other, and no vertex that moves parts them. */
static bool stands_on(const crossing_search *s, uint32_t above, uint32_t cap)
{
    const uint32_t *v = find_corners(s, above), *c = find_corners(s, cap);
    uint32_t section[3];
    int count = 0;
    for (int n = 0; n < 3; n++) {
        if (!s->cut->is_section[v[n]])
            continue;
        if (v[n] == c[0] || v[n] == c[1] || v[n] == c[2])
            return false;
        section[count++] = v[n];
    }
    return count && !is_apart(s, section[0], section[count > 1], c);
}

/* a  a triangle at the section, or one above that is compared with those of the surface at it. Those of caps do not meet,
 *    unless one shell is within another. */
static bool triangles_meet(crossing_search *s, uint32_t a, uint32_t b)
{
    const float *p = s->cut->positions;
    const bool is_above = !is_cap(s, a) && !has_section_corner(s, a);
    if (is_cap(s, a) && is_cap(s, b))
        return false;
    if ((is_above ? is_cap(s, b) : a >= b) || !cwi_has_area(p, find_corners(s, a)) ||
        !cwi_has_area(p, find_corners(s, b)) || (is_cap(s, a) && stands_on(s, b, a)) ||
        (is_cap(s, b) && stands_on(s, a, b)) ||
        !cwi_triangles_meet(p, find_corners(s, a), find_corners(s, b)) || was_faulty(s, a, b))
        return false;
    mark_triangles(s, a, b);
    return true;
}

static double measure_height(const cwi_cut *c, uint32_t v)
{
    const float *p = find_place(c, v);
    return c->normal[0] * (double)p[0] + c->normal[1] * (double)p[1] +
           c->normal[2] * (double)p[2] - c->offset;
}

/* Gathers triangles with a corner in the section. */
static bool gather_triangles(crossing_search *s)
{
    const cwi_cut *c = s->cut;
    size_t capacity = 0;
    for (uint32_t t = 0; t < c->triangle_count; t++) {
        if (!has_section_corner(s, t))
            continue;
        void *grown = cwi_grow_array(s->items, s->item_count, &capacity, sizeof *s->items);
        if (!grown)
            return false;
        s->items = grown;
        s->items[s->item_count++] = t;
        for (int k = 0; k < 3; k++)
            s->highest = fmax(s->highest, measure_height(c, find_corners(s, t)[k]));
    }
    return true;
}

static bool is_near(const crossing_search *s, uint32_t triangle)
{
    for (int k = 0; k < 3; k++)
        if (measure_height(s->cut, find_corners(s, triangle)[k]) <= s->highest)
            return true;
    return false;
}

static void search_triangle(crossing_search *s, uint32_t triangle)
{
    s->query = triangle;
    if (has_section_corner(s, triangle)) {
        if (!cwi_has_area(s->cut->positions, find_corners(s, triangle)) &&
            !was_faulty(s, triangle, triangle)) {
            mark_triangles(s, triangle, triangle);
            ++*s->count;
        }
    } else if (!is_near(s, triangle)) {
        return;
    }
    set_triangle_box(s, triangle, s->box);
    cwi_boxes_visit(&s->tree, s->box, 0, visit_node, s);
}

cw_status cwi_cut_find_triangle_crossings(const cwi_cut *c, size_t first_cap, uint8_t *marks,
                                          size_t *count, cw_error *err)
{
    crossing_search s = {.cut = c,
                         .marks = marks,
                         .count = count,
                         .first_cap = first_cap,
                         .meets = triangles_meet};
    *count = 0;
    cw_status st = gather_triangles(&s) ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK && s.item_count)
        st = build_tree(&s, set_triangle_box, err);
    for (uint32_t t = 0; t < c->triangle_count && st == CW_OK && s.item_count; t++)
        search_triangle(&s, t);
    cwi_boxes_free(&s.tree);
    cwi_free(s.items);
    return st;
}
