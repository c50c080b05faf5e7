/* Fills holes: walks along their rims, and makes a patch for each. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"
#include "simplify/repair/hole_patch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Patches of rims with more edges are made coarse first: triangles are this many times larger, then
 * half of that, and so on. Each surface is where the next one begins, which the solver needs. */
enum { LARGE_LOOP = 100 };

/* Passes of the first, coarsest patch. Each one grows: edges have the lengths of the pass before. */
enum { FIRST_PASSES = 6 };
static const double MAX_TIMES = 8;

/* Where a plane, or the box of a scan, cut the surface off, holes across more than this share of the mesh's diagonal get
 * patches of least area: a dome there may be half as large as the mesh. */
static const double MAX_DOME = 0.25;

/* How near to the box a rim's vertices are that end there, as a share of the diagonal. */
static const double AT_BOX = 1e-4;

/* A walk along open edges. A vertex that is met again ends a rim of its own. */
typedef struct loop_walk {
    const cwi_repair *r;
    uint32_t *path;   /* corners whose edges are open, in the direction of the mesh */
    uint32_t *at;     /* of a vertex: its place in the path + 1; 0: none */
    uint8_t *visited; /* of a corner */
    cwi_rims rims;
    size_t vertex_count, vertex_capacity, rim_capacity; /* of the rims */
} loop_walk;

/* New vertices and triangles of all patches. */
typedef struct hole_fill {
    cwi_repair *r;
    cwi_patch_kind kind;
    double low[3], high[3]; /* the mesh's box */
    cwi_hole_mesh around;
    float *positions;
    uint32_t *triangles;
    size_t vertices, vertex_capacity, count, capacity;
} hole_fill;

static void free_rims(cwi_rims *l)
{
    cwi_free(l->vertices);
    cwi_free(l->beside);
    cwi_free(l->end);
}

/* Ensures that an array has room for `needed` elements. */
static bool grow_array(void *array, size_t *capacity, size_t needed, size_t size)
{
    void *memory;
    memcpy(&memory, array, sizeof memory);
    if (needed <= *capacity)
        return true;
    const size_t more = needed + needed / 2 + 64;
    memory = cwi_realloc_array(memory, more, size);
    if (!memory)
        return false;
    memcpy(array, &memory, sizeof memory);
    *capacity = more;
    return true;
}

/* --- rims --------------------------------------------------------------------------------- */

/* Adds the end of a path as a rim, in the direction of the triangles that will fill it. Two edges
 * that lie along each other are no hole: they are joined later. */
static bool push_loop(loop_walk *w, size_t from, size_t to)
{
    cwi_rims *l = &w->rims;
    const size_t size = to - from;
    size_t capacity = w->vertex_capacity;
    if (size < 3)
        return true;
    if (!grow_array(&l->vertices, &capacity, w->vertex_count + size, sizeof *l->vertices) ||
        !grow_array(&l->beside, &w->vertex_capacity, w->vertex_count + size,
                    sizeof *l->beside) ||
        !grow_array(&l->end, &w->rim_capacity, l->count + 1, sizeof *l->end))
        return false;
    for (size_t n = 0; n < size; n++) {
        const uint32_t c = w->path[to - 1 - n], *v = w->r->mesh.triangles;
        l->vertices[w->vertex_count] = v[cwi_corner_next(c)];
        l->beside[w->vertex_count++] = v[cwi_corner_prev(c)];
    }
    l->end[l->count++] = w->vertex_count;
    return true;
}

/* Returns the open edge that follows an open edge: around the fan at its end. */
static uint32_t follow_loop(const cwi_repair *r, uint32_t corner)
{
    uint32_t c = cwi_corner_next(corner);
    while (r->twin[c] != CWI_NO_CORNER)
        c = cwi_corner_next(r->twin[c]);
    return c;
}

static bool walk_loop(loop_walk *w, uint32_t start)
{
    const uint32_t *v = w->r->mesh.triangles;
    size_t length = 0;
    bool ok = true;
    for (uint32_t c = start; !w->visited[c] && ok; c = follow_loop(w->r, c)) {
        w->visited[c] = 1;
        if (w->at[v[c]]) {
            const size_t from = w->at[v[c]] - 1;
            ok = push_loop(w, from, length);
            for (size_t n = from; n < length; n++)
                w->at[v[w->path[n]]] = 0;
            length = from;
        }
        w->at[v[c]] = (uint32_t)length + 1;
        w->path[length++] = c;
    }
    for (size_t n = 0; n < length; n++)
        w->at[v[w->path[n]]] = 0;
    return ok && push_loop(w, 0, length);
}

static bool find_loops(loop_walk *w)
{
    const size_t corners = 3 * w->r->mesh.triangle_count;
    w->path = cwi_alloc_array(corners, sizeof *w->path);
    w->at = cwi_alloc_zeroed(w->r->mesh.vertex_count, sizeof *w->at);
    w->visited = cwi_alloc_zeroed(corners, 1);
    bool ok = w->path && w->at && w->visited;
    for (uint32_t c = 0; c < corners && ok; c++)
        if (w->r->twin[c] == CWI_NO_CORNER && !w->visited[c])
            ok = walk_loop(w, c);
    cwi_free(w->path);
    cwi_free(w->at);
    cwi_free(w->visited);
    return ok;
}

/* --- the mesh around ---------------------------------------------------------------------- */

static bool init_around(cwi_hole_mesh *h, const cw_mesh *m)
{
    const size_t corners = 3 * m->triangle_count;
    h->mesh = m;
    h->edge_count = corners;
    h->edges = cwi_edge_keys(m->triangles, corners);
    h->first = cwi_alloc_zeroed(m->vertex_count + 2, sizeof *h->first);
    h->around = cwi_alloc_array(corners, sizeof *h->around);
    if (!h->edges || !h->first || !h->around)
        return false;
    cwi_fans_sort(m->triangles, m->triangle_count, m->vertex_count, h->first, h->around);
    return true;
}

static void free_around(cwi_hole_mesh *h)
{
    cwi_free(h->edges);
    cwi_free(h->first);
    cwi_free(h->around);
}

/* --- patches ------------------------------------------------------------------------------ */

/* Measures the diagonal of the box of a hole's rims, and their length. */
static void measure_hole(const cw_mesh *m, const cwi_rims *rims, double *diagonal,
                         double *length)
{
    double low[3], high[3];
    size_t from = 0;
    *length = 0;
    cwi_box_clear(low, high);
    for (size_t n = 0; n < rims->count; from = rims->end[n++])
        for (size_t i = from; i < rims->end[n]; i++) {
            const size_t next = i + 1 < rims->end[n] ? i + 1 : from;
            const float *p = m->positions + 3 * (size_t)rims->vertices[i],
                        *q = m->positions + 3 * (size_t)rims->vertices[next];
            cwi_box_add_points(low, high, p, 1);
            *length += sqrt(cwi_point_distance_sq(p, q));
        }
    *diagonal = cwi_distance(low, high);
}

static double measure_patch(const cwi_hole_patch *p)
{
    double sum = 0;
    for (size_t t = 0; t < p->triangle_count; t++) {
        const uint32_t *v = p->triangles[t];
        sum += cwi_triangle_area(p->points[v[0]], p->points[v[1]], p->points[v[2]]);
    }
    return sum;
}

static bool add_rim_points(const hole_fill *f, const cwi_boundary_loop *loop,
                           cwi_hole_patch *patch)
{
    bool ok = true;
    for (size_t n = 0; n < loop->size && ok; n++) {
        double point[3];
        for (size_t a = 0; a < 3; a++)
            point[a] = (double)f->around.mesh->positions[3 * (size_t)loop->vertices[n] + a];
        ok = cwi_patch_add_point(patch, point);
    }
    patch->loop = loop->size;
    return ok;
}

bool cwi_patch_shape(cwi_hole_patch *patch, const cwi_boundary_loop *loop,
                     const cwi_hole_mesh *around, bool is_fair)
{
    bool ok = true;
    const double first = loop->size > LARGE_LOOP ? MAX_TIMES : 1;
    int passes = is_fair ? FIRST_PASSES : 1;
    for (double times = first; ok && times >= 1; times /= 2) {
        for (int n = 0; n < passes && ok; n++)
            ok = cwi_patch_refine(patch, loop, around, times) &&
                 cwi_patch_fair(patch, loop, around, is_fair, times < first || n > 0);
        passes = 1;
    }
    return ok;
}

/* Returns true if a rim ends in a plane, or at the mesh's box. */
static bool is_cut_off(const hole_fill *f, const cwi_rims *rims)
{
    const double near = AT_BOX * cwi_distance(f->low, f->high);
    bool is_at_box = true;
    for (size_t n = 0; n < rims->end[0] && is_at_box; n++) {
        const float *p = f->around.mesh->positions + 3 * (size_t)rims->vertices[n];
        is_at_box = false;
        for (int a = 0; a < 3; a++)
            is_at_box = is_at_box || (double)p[a] - f->low[a] <= near ||
                        f->high[a] - (double)p[a] <= near;
    }
    return is_at_box || cwi_is_rim_flat(f->around.mesh, rims);
}

/* Makes the patch of a hole. diagonal: of its box; is_made: false where it has several rims, and none was found between them */
static cw_status make_patch(const hole_fill *f, const cwi_rims *rims, double diagonal,
                            cwi_hole_patch *patch, bool *is_made, cw_error *err)
{
    const cwi_boundary_loop loop = {rims->vertices, rims->beside, rims->end[rims->count - 1]};
    const bool is_single = rims->count == 1;
    *is_made = true;
    if (!add_rim_points(f, &loop, patch))
        return cwi_fail_memory(err);
    if (is_single && !cwi_patch_triangulate(patch, &loop, &f->around))
        return cwi_fail_memory(err);
    const cw_status st =
        is_single ? CW_OK : cwi_patch_between_rims(patch, rims, &f->around, is_made, err);
    if (st != CW_OK || !*is_made)
        return st;
    const bool is_fair =
        is_single && f->kind == CWI_PATCH_FAIR &&
        !(diagonal > MAX_DOME * cwi_distance(f->low, f->high) && is_cut_off(f, rims));
    if (f->kind == CWI_PATCH_PLAIN)
        return CW_OK;
    return cwi_patch_shape(patch, &loop, &f->around, is_fair) ? CW_OK : cwi_fail_memory(err);
}

/* Adds a patch to those that the mesh gets. */
static bool keep_patch(hole_fill *f, const uint32_t *rim, const cwi_hole_patch *patch)
{
    const size_t points = patch->count - patch->loop;
    if (!grow_array(&f->positions, &f->vertex_capacity, f->vertices + points,
                    3 * sizeof *f->positions) ||
        !grow_array(&f->triangles, &f->capacity, f->count + patch->triangle_count,
                    3 * sizeof *f->triangles))
        return false;
    const uint32_t base = (uint32_t)(f->around.mesh->vertex_count + f->vertices - patch->loop);
    for (size_t t = 0; t < patch->triangle_count; t++, f->count++)
        for (size_t k = 0; k < 3; k++) {
            const uint32_t v = patch->triangles[t][k];
            f->triangles[3 * f->count + k] = v < patch->loop ? rim[v] : base + v;
        }
    for (size_t n = patch->loop; n < patch->count; n++, f->vertices++)
        for (size_t a = 0; a < 3; a++)
            f->positions[3 * f->vertices + a] = (float)patch->points[n][a];
    return true;
}

/* Returns true if a hole stays open: it is too large, and one of the input's. */
static bool stays_open(const hole_fill *f, const cwi_rims *rims, double diagonal)
{
    const cwi_repair *r = f->r;
    const size_t count = rims->end[rims->count - 1];
    size_t flagged = 0;
    if (!(r->desc.max_hole_mm > 0) || !(diagonal > r->desc.max_hole_mm))
        return false;
    for (size_t n = 0; n < count; n++)
        flagged += r->mesh.colors[4 * (size_t)rims->vertices[n]];
    return !r->is_later || 2 * flagged >= count;
}

static void count_hole(cwi_repair *r, double diagonal, double length, double area, bool is_open)
{
    if (r->is_later)
        return;
    r->facts.holes_filled += !is_open;
    r->facts.holes_left += is_open;
    if (diagonal > r->facts.largest_hole_mm) {
        r->facts.largest_hole_mm = diagonal;
        r->facts.largest_rim_mm = length;
        r->facts.largest_fill_mm2 = area;
    }
}

/* Fills the hole of one rim, or of several, the outer one first. is_made: as of make_patch() */
static cw_status fill_hole(hole_fill *f, const cwi_rims *rims, bool *is_made, cw_error *err)
{
    cwi_hole_patch patch = {0};
    double diagonal, length;
    *is_made = true;
    measure_hole(f->around.mesh, rims, &diagonal, &length);
    if (stays_open(f, rims, diagonal)) {
        for (size_t n = 0; n < rims->end[rims->count - 1]; n++)
            f->r->mesh.colors[4 * (size_t)rims->vertices[n]] = 1;
        count_hole(f->r, diagonal, length, 0, true);
        return CW_OK;
    }
    cw_status st = make_patch(f, rims, diagonal, &patch, is_made, err);
    if (st == CW_OK && *is_made) {
        st = keep_patch(f, rims->vertices, &patch) ? CW_OK : cwi_fail_memory(err);
        count_hole(f->r, diagonal, length, measure_patch(&patch), false);
    }
    cwi_patch_free(&patch);
    return st;
}

static cw_status fill_rim(hole_fill *f, const cwi_rims *rims, size_t n, cw_error *err)
{
    const size_t from = cwi_rim_start(rims, n);
    size_t end = rims->end[n] - from;
    const cwi_rims one = {rims->vertices + from, rims->beside + from, &end, 1};
    bool is_made;
    return fill_hole(f, &one, &is_made, err);
}

/* Adds rim n of a list to the end of another, which has memory for it. */
static void add_rim(cwi_rims *to, const cwi_rims *rims, size_t n)
{
    const size_t from = cwi_rim_start(rims, n), count = rims->end[n] - from,
                 at = cwi_rim_start(to, to->count);
    memcpy(to->vertices + at, rims->vertices + from, count * sizeof *to->vertices);
    memcpy(to->beside + at, rims->beside + from, count * sizeof *to->beside);
    to->end[to->count++] = at + count;
}

/* A rim, and the one around it. */
typedef struct rim_pair {
    uint32_t outer, inner;
} rim_pair;

static int compare_pairs(const void *a, const void *b)
{
    const rim_pair *p = a, *q = b;
    if (p->outer != q->outer)
        return p->outer < q->outer ? -1 : 1;
    return (p->inner > q->inner) - (p->inner < q->inner);
}

/* Fills the holes between rims that lie in each other. is_done: of rims; set where one was filled */
static cw_status fill_between(hole_fill *f, const cwi_rims *rims, const rim_pair *pairs,
                              size_t count, uint8_t *is_done, cw_error *err)
{
    const size_t vertices = rims->end[rims->count - 1];
    cwi_rims group = {cwi_alloc_array(vertices, sizeof *group.vertices),
                      cwi_alloc_array(vertices, sizeof *group.beside),
                      cwi_alloc_array(rims->count, sizeof *group.end), 0};
    cw_status st = group.vertices && group.beside && group.end ? CW_OK : cwi_fail_memory(err);
    for (size_t n = 0, next; n < count && st == CW_OK; n = next) {
        bool is_made;
        group.count = 0;
        add_rim(&group, rims, pairs[n].outer);
        for (next = n; next < count && pairs[next].outer == pairs[n].outer; next++)
            add_rim(&group, rims, pairs[next].inner);
        st = fill_hole(f, &group, &is_made, err);
        for (size_t i = n; i < next && is_made; i++)
            is_done[pairs[i].outer] = is_done[pairs[i].inner] = 1;
    }
    free_rims(&group);
    return st;
}

static cw_status fill_nested(hole_fill *f, const cwi_rims *rims, uint8_t *is_done,
                             cw_error *err)
{
    size_t count = 0;
    uint32_t *outer = cwi_alloc_array(rims->count, sizeof *outer);
    rim_pair *pairs = cwi_alloc_array(rims->count, sizeof *pairs);
    cw_status st = outer && pairs ? cwi_find_nested_rims(f->around.mesh, rims, outer, err)
                                  : cwi_fail_memory(err);
    for (uint32_t n = 0; n < rims->count && st == CW_OK; n++)
        if (outer[n] != CWI_NO_RIM)
            pairs[count++] = (rim_pair){outer[n], n};
    if (st == CW_OK && count) {
        qsort(pairs, count, sizeof *pairs, compare_pairs);
        st = fill_between(f, rims, pairs, count, is_done, err);
    }
    cwi_free(outer);
    cwi_free(pairs);
    return st;
}

static cw_status fill_rims(hole_fill *f, const cwi_rims *rims, cw_error *err)
{
    uint8_t *is_done = cwi_alloc_zeroed(rims->count, 1);
    cw_status st = is_done ? fill_nested(f, rims, is_done, err) : cwi_fail_memory(err);
    for (size_t n = 0; n < rims->count && st == CW_OK; n++) {
        st = cwi_repair_progress(f->r, "filling holes", (double)n / (double)rims->count, err);
        if (st == CW_OK && !is_done[n])
            st = fill_rim(f, rims, n, err);
    }
    cwi_free(is_done);
    if (st != CW_OK)
        return st;
    f->r->facts.added_triangles += f->count;
    return f->count
               ? cwi_repair_append(f->r, f->positions, f->vertices, f->triangles, f->count, err)
               : CW_OK;
}

cw_status cwi_fill_holes(cwi_repair *r, cwi_patch_kind kind, cw_error *err)
{
    loop_walk w = {.r = r};
    hole_fill f = {.r = r, .kind = kind};
    cw_status st = CW_OK;
    cw_mesh_bounds(&r->mesh, f.low, f.high);
    if (!find_loops(&w) || (w.rims.count && !init_around(&f.around, &r->mesh)))
        st = cwi_fail_memory(err);
    if (st == CW_OK && w.rims.count)
        st = fill_rims(&f, &w.rims, err);
    free_rims(&w.rims);
    free_around(&f.around);
    cwi_free(f.positions);
    cwi_free(f.triangles);
    return st;
}
