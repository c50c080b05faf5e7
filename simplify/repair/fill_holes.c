/* Fills holes: walks along their rims, and makes a patch for each. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"
#include "simplify/repair/hole_patch.h"

#include <math.h>
#include <string.h>

/* Patches of rims with more edges are made coarse first: triangles are this many times larger, then
 * half of that, and so on. Each surface is where the next one begins, which the solver needs. */
enum { LARGE_LOOP = 100 };

/* Passes of the first, coarsest patch. Each one grows: edges have the lengths of the pass before. */
enum { FIRST_PASSES = 6 };
static const double MAX_TIMES = 8;

/* Rims, one after the other. */
typedef struct loop_list {
    uint32_t *vertices, *beside;
    size_t count, capacity;
    size_t *end; /* of each rim */
    size_t loops, rim_capacity;
} loop_list;

/* A walk along open edges. A vertex that is met again ends a rim of its own. */
typedef struct loop_walk {
    const cwi_repair *r;
    uint32_t *path;   /* corners whose edges are open, in the direction of the mesh */
    uint32_t *at;     /* of a vertex: its place in the path + 1; 0: none */
    uint8_t *visited; /* of a corner */
    loop_list loops;
} loop_walk;

/* New vertices and triangles of all patches. */
typedef struct hole_fill {
    cwi_repair *r;
    cwi_patch_kind kind;
    cwi_hole_mesh around;
    float *positions;
    uint32_t *triangles;
    size_t vertices, vertex_capacity, count, capacity;
} hole_fill;

static void free_loops(loop_list *l)
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
    loop_list *l = &w->loops;
    const size_t size = to - from;
    size_t capacity = l->capacity;
    if (size < 3)
        return true;
    if (!grow_array(&l->vertices, &capacity, l->count + size, sizeof *l->vertices) ||
        !grow_array(&l->beside, &l->capacity, l->count + size, sizeof *l->beside) ||
        !grow_array(&l->end, &l->rim_capacity, l->loops + 1, sizeof *l->end))
        return false;
    for (size_t n = 0; n < size; n++) {
        const uint32_t c = w->path[to - 1 - n], *v = w->r->mesh.triangles;
        l->vertices[l->count] = v[cwi_corner_next(c)];
        l->beside[l->count++] = v[cwi_corner_prev(c)];
    }
    l->end[l->loops++] = l->count;
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

/* Measures the diagonal of a rim's box, and its length. */
static void measure_hole(const cw_mesh *m, const cwi_boundary_loop *loop, double *diagonal,
                         double *length)
{
    double low[3], high[3];
    *length = 0;
    cwi_box_clear(low, high);
    for (size_t n = 0; n < loop->size; n++) {
        const float *p = m->positions + 3 * (size_t)loop->vertices[n],
                    *q = m->positions + 3 * (size_t)loop->vertices[(n + 1) % loop->size];
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

static bool make_patch(const hole_fill *f, const cwi_boundary_loop *loop, cwi_hole_patch *patch)
{
    bool ok = true;
    for (size_t n = 0; n < loop->size && ok; n++) {
        double point[3];
        for (size_t a = 0; a < 3; a++)
            point[a] = (double)f->around.mesh->positions[3 * (size_t)loop->vertices[n] + a];
        ok = cwi_patch_add_point(patch, point);
    }
    patch->loop = loop->size;
    ok = ok && cwi_patch_triangulate(patch, loop, &f->around);
    const double first = loop->size > LARGE_LOOP ? MAX_TIMES : 1;
    const bool is_fair = f->kind == CWI_PATCH_FAIR;
    int passes = is_fair ? FIRST_PASSES : 1;
    for (double times = first; ok && times >= 1 && f->kind != CWI_PATCH_PLAIN; times /= 2) {
        for (int n = 0; n < passes && ok; n++)
            ok = cwi_patch_refine(patch, loop, &f->around, times) &&
                 cwi_patch_fair(patch, loop, &f->around, is_fair, times < first || n > 0);
        passes = 1;
    }
    return ok;
}

/* Adds a patch to those that the mesh gets. */
static bool keep_patch(hole_fill *f, const cwi_boundary_loop *loop, const cwi_hole_patch *patch)
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
            f->triangles[3 * f->count + k] = v < patch->loop ? loop->vertices[v] : base + v;
        }
    for (size_t n = patch->loop; n < patch->count; n++, f->vertices++)
        for (size_t a = 0; a < 3; a++)
            f->positions[3 * f->vertices + a] = (float)patch->points[n][a];
    return true;
}

/* Returns true if a hole stays open: it is too large, and one of the input's. */
static bool stays_open(const hole_fill *f, const cwi_boundary_loop *loop, double diagonal)
{
    const cwi_repair *r = f->r;
    size_t flagged = 0;
    if (!(r->desc.max_hole_mm > 0) || !(diagonal > r->desc.max_hole_mm))
        return false;
    for (size_t n = 0; n < loop->size; n++)
        flagged += r->mesh.colors[4 * (size_t)loop->vertices[n]];
    return !r->is_later || 2 * flagged >= loop->size;
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

static bool fill_hole(hole_fill *f, const cwi_boundary_loop *loop)
{
    cwi_hole_patch patch = {0};
    double diagonal, length;
    measure_hole(f->around.mesh, loop, &diagonal, &length);
    if (stays_open(f, loop, diagonal)) {
        for (size_t n = 0; n < loop->size; n++)
            f->r->mesh.colors[4 * (size_t)loop->vertices[n]] = 1;
        count_hole(f->r, diagonal, length, 0, true);
        return true;
    }
    const bool ok = make_patch(f, loop, &patch) && keep_patch(f, loop, &patch);
    if (ok)
        count_hole(f->r, diagonal, length, measure_patch(&patch), false);
    cwi_patch_free(&patch);
    return ok;
}

static cw_status fill_loops(hole_fill *f, const loop_list *loops, cw_error *err)
{
    size_t from = 0;
    for (size_t n = 0; n < loops->loops; n++) {
        const cwi_boundary_loop loop = {loops->vertices + from, loops->beside + from,
                                        loops->end[n] - from};
        cw_status st =
            cwi_repair_progress(f->r, "filling holes", (double)n / (double)loops->loops, err);
        if (st != CW_OK)
            return st;
        if (!fill_hole(f, &loop))
            return cwi_fail_memory(err);
        from = loops->end[n];
    }
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
    if (!find_loops(&w) || (w.loops.loops && !init_around(&f.around, &r->mesh)))
        st = cwi_fail_memory(err);
    if (st == CW_OK && w.loops.loops)
        st = fill_loops(&f, &w.loops, err);
    free_loops(&w.loops);
    free_around(&f.around);
    cwi_free(f.positions);
    cwi_free(f.triangles);
    return st;
}
