/* Removes crossings: unites solids, moves other surfaces apart that only touch, and drops triangles around all
 * other crossings [Attene2010]. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "simplify/repair/repair_state.h"

#include <cubewright/quality.h>

#include <math.h>
#include <string.h>

/* How far touching vertices move, as a fraction of their shortest edge, and in steps of single
 * precision at least. */
static const double APART_FRACTION = 1e-3, APART_STEPS = 8, APART_MAX = 0.1;

/* Triangles are not dropped when more than this fraction of all area would go. */
static const double MAX_DROPPED = 0.95;

/* A part that is left of a component is dropped if it has less than this fraction of the area of the largest
 * part that is left of it. */
static const double MIN_FRAGMENT = 0.05;

/* Finds pairs of triangles that meet. Those that share positions of corners or edges alone do not when
 * welded. */
static cw_status find_crossings(cwi_repair *r, cw_weld weld, cw_crossings *found, cw_error *err)
{
    const cw_crossings_desc desc = {.weld = weld, .threads = r->desc.threads};
    cw_crossings_free(found);
    cw_status st = cw_self_intersections(&r->mesh, &desc, found, err);
    r->facts.is_undecided = r->facts.is_undecided || found->undecided;
    return st;
}

/* --- touching surfaces -------------------------------------------------------------------- */

/* Vertices of triangles that meet, and where they were. */
typedef struct touching {
    cwi_repair *r;
    float *before;
    bool *meets;
    double (*normal)[3];
    double *shortest_sq;
} touching;

static void free_touching(touching *t)
{
    cwi_free(t->before);
    cwi_free(t->meets);
    cwi_free(t->normal);
    cwi_free(t->shortest_sq);
}

static bool init_touching(touching *t)
{
    const size_t count = t->r->mesh.vertex_count;
    t->before = cwi_alloc_array(count, 3 * sizeof *t->before);
    t->meets = cwi_alloc_zeroed(count, sizeof *t->meets);
    t->normal = cwi_alloc_zeroed(count, sizeof *t->normal);
    t->shortest_sq = cwi_alloc_zeroed(count, sizeof *t->shortest_sq);
    if (!t->before || !t->meets || !t->normal || !t->shortest_sq)
        return false;
    memcpy(t->before, t->r->mesh.positions, 3 * count * sizeof *t->before);
    return true;
}

static void mark_vertices(const cw_mesh *m, const cw_crossings *found, bool *meets)
{
    for (size_t n = 0; n < 2 * found->count; n++)
        for (size_t k = 0; k < 3; k++)
            meets[m->triangles[3 * (size_t)found->pairs[n] + k]] = true;
}

/* Sums the normals around vertices that meet, and finds their shortest edges. */
static void measure_one_rings(touching *t)
{
    const cw_mesh *m = &t->r->mesh;
    for (size_t n = 0; n < m->triangle_count; n++) {
        const uint32_t *v = m->triangles + 3 * n;
        double edges[3][3], area[3];
        if (!t->meets[v[0]] && !t->meets[v[1]] && !t->meets[v[2]])
            continue;
        for (size_t k = 0; k < 3; k++)
            cwi_sub_points(cwi_mesh_point(m, n, (k + 1) % 3), cwi_mesh_point(m, n, k),
                           edges[k]);
        cwi_cross(edges[0], edges[1], area);
        for (int k = 0; k < 6; k++) {
            const uint32_t w = v[k % 3];
            const double distance_sq =
                cwi_dot(edges[k < 3 ? k : (k + 2) % 3], edges[k < 3 ? k : (k + 2) % 3]);
            if (t->shortest_sq[w] == 0 || distance_sq < t->shortest_sq[w])
                t->shortest_sq[w] = distance_sq;
            for (int a = 0; a < 3 && k < 3; a++)
                t->normal[w][a] += area[a];
        }
    }
}

static void move_inward(touching *t, size_t v)
{
    float *p = t->r->mesh.positions + 3 * v;
    const double shortest = sqrt(t->shortest_sq[v]);
    double largest = 0;
    if (!t->meets[v] || !cwi_normalise(t->normal[v]))
        return;
    for (int a = 0; a < 3; a++)
        largest = fmax(largest, fabs((double)p[a]));
    const double step = fmin(fmax(APART_FRACTION * shortest, APART_STEPS * largest * 0x1p-24),
                             APART_MAX * shortest);
    for (int a = 0; a < 3; a++)
        p[a] = (float)((double)p[a] - step * t->normal[v][a]);
}

/* Counts the vertices that stayed away from their first place, and how far they are. */
static void count_moves(touching *t)
{
    cw_repair_facts *f = &t->r->facts;
    for (size_t v = 0; v < t->r->mesh.vertex_count; v++) {
        const float *p = t->r->mesh.positions + 3 * v, *q = t->before + 3 * v;
        const double distance_sq = cwi_point_distance_sq(p, q);
        f->touching_vertices += distance_sq > 0;
        f->parted_mm = fmax(f->parted_mm, sqrt(distance_sq));
    }
}

/* Moves vertices inward where surfaces meet, and moves those back that still meet. */
static cw_status move_touching(cwi_repair *r, cw_crossings *found, cw_error *err)
{
    const size_t count = found->count;
    touching t = {.r = r};
    cw_status st = init_touching(&t) ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK) {
        mark_vertices(&r->mesh, found, t.meets);
        measure_one_rings(&t);
        for (size_t v = 0; v < r->mesh.vertex_count; v++)
            move_inward(&t, v);
        st = find_crossings(r, CW_WELD_NONE, found, err);
    }
    if (st == CW_OK && found->count) {
        memset(t.meets, 0, r->mesh.vertex_count * sizeof *t.meets);
        mark_vertices(&r->mesh, found, t.meets);
        for (size_t v = 0; v < r->mesh.vertex_count; v++)
            if (t.meets[v])
                memcpy(r->mesh.positions + 3 * v, t.before + 3 * v, 3 * sizeof *t.before);
        st = find_crossings(r, CW_WELD_NONE, found, err);
    }
    if (st == CW_OK && found->count >= count) { /* nothing gained */
        memcpy(r->mesh.positions, t.before, 3 * r->mesh.vertex_count * sizeof *t.before);
        st = find_crossings(r, CW_WELD_NONE, found, err);
    }
    if (st == CW_OK)
        count_moves(&t);
    free_touching(&t);
    return st;
}

/* --- triangles that go -------------------------------------------------------------------- */

/* Marks triangles that share a vertex with a marked one. */
static void grow_marks(const cw_mesh *m, bool *is_near, bool *marked)
{
    memset(is_near, 0, m->vertex_count * sizeof *is_near);
    for (size_t c = 0; c < 3 * m->triangle_count; c++)
        if (marked[c / 3])
            is_near[m->triangles[c]] = true;
    for (size_t c = 0; c < 3 * m->triangle_count; c++)
        if (is_near[m->triangles[c]])
            marked[c / 3] = true;
}

/* Marks small parts that the drop would leave of a component. */
static bool mark_fragments(const cwi_repair *r, bool *marked)
{
    const size_t count = r->mesh.triangle_count;
    uint32_t *whole = cwi_sets_alloc(count), *part = cwi_sets_alloc(count);
    double *area = cwi_alloc_zeroed(count, sizeof *area);    /* of a part's root */
    double *largest = cwi_alloc_zeroed(count, sizeof *area); /* of a whole's root */
    const bool ok = whole && part && area && largest;
    for (uint32_t c = 0; c < 3 * count && ok; c++) {
        const uint32_t other = r->twin[c];
        if (other == CWI_NO_CORNER)
            continue;
        cwi_sets_join(whole, c / 3, other / 3);
        if (!marked[c / 3] && !marked[other / 3])
            cwi_sets_join(part, c / 3, other / 3);
    }
    for (uint32_t t = 0; t < count && ok; t++)
        if (!marked[t])
            area[cwi_sets_find(part, t)] += cwi_mesh_area(&r->mesh, t);
    for (uint32_t t = 0; t < count && ok; t++) {
        double *max_area = &largest[cwi_sets_find(whole, t)];
        *max_area = fmax(*max_area, area[t]);
    }
    for (uint32_t t = 0; t < count && ok; t++)
        if (!marked[t] &&
            area[cwi_sets_find(part, t)] < MIN_FRAGMENT * largest[cwi_sets_find(whole, t)])
            marked[t] = true;
    cwi_free(whole);
    cwi_free(part);
    cwi_free(area);
    cwi_free(largest);
    return ok;
}

static bool mark_crossing(const cwi_repair *r, const cw_crossings *found, int rings,
                          bool *marked)
{
    bool *is_near = cwi_alloc_array(r->mesh.vertex_count, sizeof *is_near);
    if (!is_near)
        return false;
    for (size_t n = 0; n < 2 * found->count; n++)
        marked[found->pairs[n]] = true;
    for (int n = 0; n < rings; n++)
        grow_marks(&r->mesh, is_near, marked);
    cwi_free(is_near);
    return mark_fragments(r, marked);
}

static cw_status drop_crossing(cwi_repair *r, const cw_crossings *found, int round,
                               bool *changed, cw_error *err)
{
    const size_t count = r->mesh.triangle_count;
    bool *marked = cwi_alloc_zeroed(count, sizeof *marked);
    double all = 0, dropped = 0;
    cw_status st = CW_OK;
    size_t triangles = 0;
    if (!marked || !mark_crossing(r, found, (round + 1) / 2, marked))
        st = cwi_fail_memory(err);
    for (size_t t = 0; t < count && st == CW_OK; t++) {
        const double area = cwi_mesh_area(&r->mesh, t);
        all += area;
        dropped += marked[t] ? area : 0;
        triangles += marked[t];
    }
    *changed = st == CW_OK && dropped <= MAX_DROPPED * all;
    if (*changed) {
        st = cwi_mesh_drop_marked(&r->mesh, marked, err);
        r->facts.removed_triangles += triangles;
    }
    cwi_free(marked);
    return st;
}

cw_status cwi_unite_crossing(cwi_repair *r, bool *is_clear, bool *changed, cw_error *err)
{
    cw_crossings found = {0};
    cw_status st = find_crossings(r, CW_WELD_LOCAL, &found, err);
    *changed = false;
    *is_clear = !found.count && !found.undecided;
    r->facts.crossings_before = found.count;
    if (st == CW_OK && found.count && !r->desc.keep_crossings)
        st = cwi_unite_solids(r, &found, false, changed, err);
    cw_crossings_free(&found);
    return st;
}

cw_status cwi_remove_crossings(cwi_repair *r, int round, bool is_last, bool *changed,
                               cw_error *err)
{
    cw_crossings found = {0};
    *changed = false;
    if (r->desc.keep_crossings)
        return CW_OK;
    cw_status st = find_crossings(r, CW_WELD_NONE, &found, err);
    if (st == CW_OK && found.count && round == 0)
        st = move_touching(r, &found, err);
    if (st == CW_OK && found.count && !is_last)
        st = drop_crossing(r, &found, round, changed, err);
    if (st == CW_OK && found.count && !*changed)
        st = cwi_unite_solids(r, &found, true, changed, err);
    cw_crossings_free(&found);
    return st;
}
