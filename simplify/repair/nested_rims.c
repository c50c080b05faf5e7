/* Finds rims that lie in each other in one plane, such as those of the two walls of a cup that lost its brim: what is
 * missing lies between them. It is filled as a section of a cut is. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/bvh.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"
#include "simplify/cut/cut_state.h"
#include "simplify/repair/hole_patch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How far from the plane rims may lie, as a fraction of the diagonal of the outer one. */
static const double MAX_HEIGHT = 0.05;

/* The same for a rim that is flat by itself: it is where a plane cut the surface off. */
static const double FLAT_HEIGHT = 1e-3;

typedef struct rim_frame {
    uint32_t rim;
    double low[3], high[3], middle[3], diagonal;
    double normal[3], area;
    double height; /* largest distance from the plane through the middle */
} rim_frame;

typedef struct rim_search {
    const cw_mesh *mesh;
    const cwi_rims *rims;
    rim_frame *frames; /* of the rims */
    cwi_boxes tree;    /* of their boxes */
    uint32_t inner;    /* the rim around which another is looked for */
    uint32_t outer;    /* the smallest one found so far; CWI_NO_RIM */
} rim_search;

static const float *find_point(const rim_search *s, size_t n)
{
    return s->mesh->positions + 3 * (size_t)s->rims->vertices[n];
}

static double measure_height(const rim_frame *f, const float *p)
{
    double sum = 0;
    for (int a = 0; a < 3; a++)
        sum += f->normal[a] * ((double)p[a] - f->middle[a]);
    return fabs(sum);
}

static void measure_rim(const rim_search *s, uint32_t rim, rim_frame *f)
{
    const size_t from = cwi_rim_start(s->rims, rim), to = s->rims->end[rim];
    *f = (rim_frame){.rim = rim};
    cwi_box_clear(f->low, f->high);
    for (size_t n = from; n < to; n++)
        cwi_box_add_points(f->low, f->high, find_point(s, n), 1);
    for (int a = 0; a < 3; a++)
        f->middle[a] = (f->low[a] + f->high[a]) / 2;
    f->diagonal = cwi_distance(f->low, f->high);
    for (size_t n = from; n < to; n++) { /* Newell's normal */
        const float *p = find_point(s, n), *q = find_point(s, n + 1 < to ? n + 1 : from);
        double u[3], v[3], cross[3];
        for (int a = 0; a < 3; a++) {
            u[a] = (double)p[a] - f->middle[a];
            v[a] = (double)q[a] - f->middle[a];
        }
        cwi_cross(u, v, cross);
        for (int a = 0; a < 3; a++)
            f->normal[a] += cross[a] / 2;
    }
    f->area = cwi_length(f->normal);
    cwi_normalise(f->normal);
    for (size_t n = from; n < to; n++)
        f->height = fmax(f->height, measure_height(f, find_point(s, n)));
}

/* Returns true if a point is inside of a rim, seen along its normal: by the parity of edges to the right of it. */
static bool is_inside(const rim_search *s, const rim_frame *f, const float *point)
{
    const int axis = cwi_longest_axis(f->normal), u = (axis + 1) % 3, v = (axis + 2) % 3;
    const size_t from = cwi_rim_start(s->rims, f->rim), to = s->rims->end[f->rim];
    bool inside = false;
    for (size_t n = from; n < to; n++) {
        const float *p = find_point(s, n), *q = find_point(s, n + 1 < to ? n + 1 : from);
        if ((p[v] > point[v]) == (q[v] > point[v]))
            continue;
        const double share = ((double)point[v] - (double)p[v]) / ((double)q[v] - (double)p[v]);
        inside ^= (double)point[u] < (double)p[u] + share * ((double)q[u] - (double)p[u]);
    }
    return inside;
}

/* Returns true if a rim lies in another, and in its plane. */
static bool is_nested(const rim_search *s, const rim_frame *inner, const rim_frame *outer)
{
    const double most = MAX_HEIGHT * outer->diagonal;
    const size_t from = cwi_rim_start(s->rims, inner->rim), to = s->rims->end[inner->rim];
    for (int a = 0; a < 3; a++)
        if (inner->low[a] < outer->low[a] - most || inner->high[a] > outer->high[a] + most)
            return false;
    if (outer->height > most)
        return false;
    for (size_t n = from; n < to; n++)
        if (measure_height(outer, find_point(s, n)) > most ||
            !is_inside(s, outer, find_point(s, n)))
            return false;
    return true;
}

static bool visit_node(void *context, size_t node)
{
    rim_search *s = context;
    const rim_frame *inner = s->frames + s->inner;
    for (size_t n = node * CWI_WIDTH; n < s->tree.count && n < (node + 1) * CWI_WIDTH; n++) {
        const rim_frame *f = s->frames + s->tree.order[n];
        const double found = s->outer == CWI_NO_RIM ? INFINITY : s->frames[s->outer].area;
        if (f->area > inner->area && f->area < found && is_nested(s, inner, f))
            s->outer = f->rim;
    }
    return true;
}

static bool faces_away(const rim_search *s, uint32_t rim, uint32_t other)
{
    return cwi_dot(s->frames[rim].normal, s->frames[other].normal) < 0;
}

/* Sets the rim next around each. */
static void search_rims(rim_search *s, uint32_t *outer)
{
    for (uint32_t n = 0; n < s->rims->count; n++) {
        float box[6];
        for (int a = 0; a < 3; a++) {
            box[a] = (float)s->frames[n].low[a];
            box[a + 3] = (float)s->frames[n].high[a];
        }
        s->inner = n;
        s->outer = CWI_NO_RIM;
        cwi_boxes_visit(&s->tree, box, 0, visit_node, s);
        outer[n] = s->outer;
    }
}

/* Keeps those that face the other way, and are not in such a rim themselves: an island in a hole has rims of its own. */
static bool keep_pairs(const rim_search *s, uint32_t *outer)
{
    uint8_t *is_inner = cwi_alloc_zeroed(s->rims->count, 1);
    if (!is_inner)
        return false;
    for (uint32_t n = 0; n < s->rims->count; n++)
        is_inner[n] = outer[n] != CWI_NO_RIM && faces_away(s, n, outer[n]);
    for (uint32_t n = 0; n < s->rims->count; n++)
        if (!is_inner[n] || is_inner[outer[n]])
            outer[n] = CWI_NO_RIM;
    cwi_free(is_inner);
    return true;
}

static cw_status build_tree(rim_search *s, cw_error *err)
{
    const size_t count = s->rims->count;
    float(*boxes)[6] = cwi_alloc_array(count, sizeof *boxes);
    if (!boxes)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < count; n++) {
        const rim_frame *f = s->frames + n;
        const double most = MAX_HEIGHT * f->diagonal;
        for (int a = 0; a < 3; a++) {
            boxes[n][a] = (float)(f->low[a] - most);
            boxes[n][a + 3] = (float)(f->high[a] + most);
        }
    }
    const cw_status st = cwi_boxes_build(&s->tree, (const float(*)[6])boxes, count, err);
    cwi_free(boxes);
    return st;
}

cw_status cwi_find_nested_rims(const cw_mesh *mesh, const cwi_rims *rims, uint32_t *outer,
                               cw_error *err)
{
    rim_search s = {.mesh = mesh, .rims = rims};
    s.frames = cwi_alloc_array(rims->count, sizeof *s.frames);
    cw_status st = s.frames ? CW_OK : cwi_fail_memory(err);
    for (uint32_t n = 0; n < rims->count && st == CW_OK; n++)
        measure_rim(&s, n, s.frames + n);
    if (st == CW_OK)
        st = build_tree(&s, err);
    if (st == CW_OK) {
        search_rims(&s, outer);
        st = keep_pairs(&s, outer) ? CW_OK : cwi_fail_memory(err);
    }
    cwi_boxes_free(&s.tree);
    cwi_free(s.frames);
    return st;
}

bool cwi_is_rim_flat(const cw_mesh *mesh, const cwi_rims *rims)
{
    rim_frame frame;
    const rim_search s = {.mesh = mesh, .rims = rims};
    measure_rim(&s, 0, &frame);
    return frame.height <= FLAT_HEIGHT * frame.diagonal;
}

/* --- triangles ---------------------------------------------------------------------------- */

typedef struct rim_vertex {
    uint32_t vertex, number; /* of the mesh; in the rims */
} rim_vertex;

static int compare_vertices(const void *a, const void *b)
{
    const rim_vertex *u = a, *v = b;
    return (u->vertex > v->vertex) - (u->vertex < v->vertex);
}

/* Makes the section whose loops are the rims; its plane is that of the first. Returns false when memory is out. */
static bool make_section(const cw_mesh *m, const cwi_rims *rims, cwi_cut *c)
{
    rim_frame frame;
    const rim_search s = {.mesh = m, .rims = rims};
    const size_t vertices = rims->end[rims->count - 1];
    measure_rim(&s, 0, &frame);
    c->mesh = m;
    c->positions = m->positions;
    c->vertex_count = m->vertex_count;
    memcpy(c->normal, frame.normal, sizeof c->normal);
    c->axis = cwi_longest_axis(frame.normal);
    c->parent = UINT32_MAX;
    c->loop_vertices = cwi_alloc_array(vertices, sizeof *c->loop_vertices);
    c->loop_ends = cwi_alloc_array(rims->count, sizeof *c->loop_ends);
    if (!c->loop_vertices || !c->loop_ends)
        return false;
    memcpy(c->loop_vertices, rims->vertices, vertices * sizeof *c->loop_vertices);
    memcpy(c->loop_ends, rims->end, rims->count * sizeof *c->loop_ends);
    c->loop_count = rims->count;
    return true;
}

/* Returns true if all triangles face one way, and their edges are those of the rims or new. */
static bool is_fit(const cwi_cut *c, const cwi_hole_mesh *around, size_t rim_edges)
{
    size_t old = 0;
    for (size_t t = 0; t < c->triangle_count; t++) {
        const uint32_t *v = c->triangles + 3 * t;
        double normal[3], u[3], w[3];
        const float *p = c->positions + 3 * (size_t)v[0];
        cwi_sub_points(c->positions + 3 * (size_t)v[1], p, u);
        cwi_sub_points(c->positions + 3 * (size_t)v[2], p, w);
        cwi_cross(u, w, normal);
        if (!(cwi_dot(normal, c->normal) > 0))
            return false;
        for (int k = 0; k < 3; k++)
            old += cwi_edge_exists(around->edges, around->edge_count, v[k], v[(k + 1) % 3]);
    }
    return old == rim_edges;
}

/* Adds the triangles of a section to a patch. vertices: those of the rims, by number in the mesh */
static bool add_triangles(cwi_hole_patch *patch, const cwi_cut *c, const rim_vertex *vertices,
                          size_t count)
{
    for (size_t t = 0; t < c->triangle_count; t++) {
        uint32_t v[3];
        for (size_t k = 0; k < 3; k++) {
            const rim_vertex key = {c->triangles[3 * t + k], 0},
                             *found =
                                 bsearch(&key, vertices, count, sizeof key, compare_vertices);
            v[k] = found->number;
        }
        if (!cwi_patch_add_triangle(patch, v[0], v[1], v[2]))
            return false;
    }
    return true;
}

/* Returns true if no vertex is in two rims, or twice in one. */
static bool sort_vertices(const cwi_rims *rims, rim_vertex *out)
{
    const size_t count = rims->end[rims->count - 1];
    for (uint32_t n = 0; n < count; n++)
        out[n] = (rim_vertex){rims->vertices[n], n};
    qsort(out, count, sizeof *out, compare_vertices);
    for (size_t n = 0; n + 1 < count; n++)
        if (out[n].vertex == out[n + 1].vertex)
            return false;
    return true;
}

cw_status cwi_patch_between_rims(cwi_hole_patch *patch, const cwi_rims *rims,
                                 const cwi_hole_mesh *around, bool *is_made, cw_error *err)
{
    cwi_cut cut = {0};
    const size_t count = rims->end[rims->count - 1];
    rim_vertex *vertices = cwi_alloc_array(count, sizeof *vertices);
    cw_status st =
        vertices && make_section(around->mesh, rims, &cut) ? CW_OK : cwi_fail_memory(err);
    *is_made = st == CW_OK && sort_vertices(rims, vertices);
    if (*is_made)
        st = cwi_cut_fill(&cut, err);
    *is_made = *is_made && st == CW_OK && is_fit(&cut, around, count);
    if (*is_made && !add_triangles(patch, &cut, vertices, count))
        st = cwi_fail_memory(err);
    cwi_free(vertices);
    cwi_free(cut.triangles);
    cwi_free(cut.parents);
    cwi_free(cut.loop_vertices);
    cwi_free(cut.loop_ends);
    return st;
}
