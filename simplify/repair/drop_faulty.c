/* Drops what belongs to no surface: repeated triangles, those without area, and open sheets. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/triangle_intersect.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"
#include "core/mesh/mesh.h"
#include "simplify/repair/repair_state.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rounds of flips; what is then left without area is dropped. */
enum { FLIP_ROUNDS = 24 };

/* Twice the area of a triangle that has one, as a fraction of the square of its longest edge. */
static const double LEAST_AREA = 8 * DBL_EPSILON;

/* An open component is a sheet if it would enclose less than this fraction of its area^(3/2). Of
 * a sphere it is 0.094, and of a spherical cap 1 % as high as wide 0.0014. Closed components are
 * sheets when only rounding is left of their volume. */
static const double SHEET_VOLUME = 1e-4, CLOSED_SHEET_VOLUME = 1e-7;

/* --- duplicates --------------------------------------------------------------------------- */

typedef struct vertex_triple {
    uint32_t v[3]; /* rising */
    uint32_t triangle;
    bool is_even; /* the triangle runs through them in rising order */
} vertex_triple;

static int compare_triples(const void *a, const void *b)
{
    const vertex_triple *s = a, *t = b;
    for (int n = 0; n < 3; n++)
        if (s->v[n] != t->v[n])
            return s->v[n] < t->v[n] ? -1 : 1;
    return s->triangle < t->triangle ? -1 : s->triangle > t->triangle;
}

static void sort_corners(vertex_triple *t)
{
    t->is_even = true;
    for (int n = 0; n < 3; n++) {
        const int a = n % 2;
        if (t->v[a] > t->v[a + 1]) {
            const uint32_t v = t->v[a];
            t->v[a] = t->v[a + 1];
            t->v[a + 1] = v;
            t->is_even = !t->is_even;
        }
    }
}

/* Marks the later triangles of equal ones; with cancel also the first, where one faces it. */
static void mark_duplicates(const vertex_triple *triples, size_t count, bool cancel,
                            bool *marked)
{
    for (size_t i = 0, same; i < count; i += same) {
        bool faces = false;
        for (same = 1;
             i + same < count && !memcmp(triples[i].v, triples[i + same].v, sizeof triples->v);
             same++) {
            marked[triples[i + same].triangle] = true;
            faces = faces || triples[i + same].is_even != triples[i].is_even;
        }
        marked[triples[i].triangle] = cancel && faces;
    }
}

static size_t count_marked(const bool *marked, size_t count)
{
    size_t sum = 0;
    for (size_t t = 0; t < count; t++)
        sum += marked[t];
    return sum;
}

/* Adds the direction of each side of an edge: what is not 0 is open. */
static void sum_sides(const cw_mesh *m, const cwi_side *sides, size_t count, const bool *marked,
                      int *all, int *kept)
{
    *all = *kept = 0;
    for (size_t n = 0; n < count; n++) {
        const bool runs_up = m->triangles[sides[n].corner] == (uint32_t)(sides[n].key >> 32);
        *all += runs_up ? 1 : -1;
        *kept += marked[sides[n].corner / 3] ? 0 : runs_up ? 1 : -1;
    }
}

/* Unmarks what closed solids share, as a wall between them: without it they would be open. */
static bool keep_walls(const cw_mesh *m, bool *marked)
{
    enum { OPEN = 1, OPENED = 2 };
    const size_t count = m->triangle_count;
    cwi_side *sides = cwi_alloc_array(3 * count, sizeof *sides);
    uint32_t *set = cwi_sets_alloc(count);
    uint8_t *state = cwi_alloc_zeroed(count, 1);
    const bool ok = sides && set && state;
    if (ok)
        cwi_sides_list(m->triangles, 3 * count, sides);
    for (int pass = 0; pass < 2 && ok; pass++)
        for (size_t i = 0, along; i < 3 * count; i += along) {
            int all, kept;
            along = cwi_sides_along(sides, 3 * count, i);
            for (size_t n = 1; n < along && pass == 0; n++)
                cwi_sets_join(set, sides[i].corner / 3, sides[i + n].corner / 3);
            sum_sides(m, sides + i, along, marked, &all, &kept);
            if (pass == 1)
                state[cwi_sets_find(set, sides[i].corner / 3)] |=
                    (all ? OPEN : 0) | (kept ? OPENED : 0);
        }
    for (uint32_t t = 0; t < count && ok; t++)
        marked[t] = marked[t] && state[cwi_sets_find(set, t)] != OPENED;
    cwi_free(sides);
    cwi_free(set);
    cwi_free(state);
    return ok;
}

cw_status cwi_drop_duplicates(cwi_repair *r, bool cancel, size_t *dropped, cw_error *err)
{
    const size_t count = r->mesh.triangle_count;
    vertex_triple *triples = cwi_alloc_array(count, sizeof *triples);
    bool *marked = cwi_alloc_zeroed(count, sizeof *marked);
    cw_status st = triples && marked ? CW_OK : cwi_fail_memory(err);
    for (size_t t = 0; t < count && st == CW_OK; t++) {
        triples[t].triangle = (uint32_t)t;
        memcpy(triples[t].v, r->mesh.triangles + 3 * t, sizeof triples->v);
        sort_corners(&triples[t]);
    }
    size_t found = 0;
    if (st == CW_OK) {
        qsort(triples, count, sizeof *triples, compare_triples);
        mark_duplicates(triples, count, cancel, marked);
    }
    if (st == CW_OK && count_marked(marked, count) && !keep_walls(&r->mesh, marked))
        st = cwi_fail_memory(err);
    if (st == CW_OK && (found = count_marked(marked, count)))
        st = cwi_mesh_drop_marked(&r->mesh, marked, err);
    if (st == CW_OK)
        *dropped += found;
    cwi_free(triples);
    cwi_free(marked);
    return st;
}

/* --- triangles without area --------------------------------------------------------------- */

/* Returns true if a triangle has an area that double precision can tell from none, as judges of meshes do. */
static bool has_area(const cw_mesh *m, size_t t)
{
    double p[3][3], longest_sq = 0;
    cwi_mesh_corners(m, t, p);
    for (int k = 0; k < 3; k++)
        longest_sq = fmax(longest_sq, cwi_distance_sq(p[k], p[(k + 1) % 3]));
    return 2 * cwi_triangle_area(p[0], p[1], p[2]) > LEAST_AREA * longest_sq &&
           cwi_has_area(m->positions, m->triangles + 3 * t);
}

/* Returns the corner at which the longest edge of a triangle begins. */
static uint32_t longest_edge(const cw_mesh *m, uint32_t t)
{
    uint32_t best = 3 * t;
    double longest = -1;
    for (uint32_t c = 3 * t; c < 3 * t + 3; c++) {
        const float *p = m->positions + 3 * (size_t)m->triangles[c],
                    *q = m->positions + 3 * (size_t)m->triangles[cwi_corner_next(c)];
        const double distance_sq = cwi_point_distance_sq(p, q);
        if (distance_sq > longest) {
            longest = distance_sq;
            best = c;
        }
    }
    return best;
}

/* Flips the longest edge of a triangle without area: its neighbour is divided at the vertex on that
 * edge. Marks the triangle if that is not possible. */
static void flip_longest(cwi_repair *r, const uint64_t *edges, uint32_t t, bool *touched,
                         bool *marked)
{
    uint32_t *v = r->mesh.triangles;
    const uint32_t c = longest_edge(&r->mesh, t), other = r->twin[c];
    if (other == CWI_NO_CORNER) {
        marked[t] = touched[t] = true;
        return;
    }
    const uint32_t u = other / 3, p = v[c], q = v[cwi_corner_next(c)],
                   tip = v[cwi_corner_prev(c)], far = v[cwi_corner_prev(other)];
    if (touched[t] || touched[u])
        return;
    touched[t] = touched[u] = true;
    if (tip == far || cwi_edge_exists(edges, 3 * r->mesh.triangle_count, tip, far)) {
        marked[t] = true;
        marked[u] = tip == far;
        return;
    }
    const uint32_t made[2][3] = {{p, far, tip}, {far, q, tip}};
    memcpy(v + 3 * (size_t)t, made[0], sizeof *made);
    memcpy(v + 3 * (size_t)u, made[1], sizeof *made);
}

static cw_status flip_round(cwi_repair *r, bool give_up, size_t *found, cw_error *err)
{
    cw_mesh *m = &r->mesh;
    const size_t count = m->triangle_count;
    uint64_t *edges = NULL;
    bool *touched = NULL, *marked = NULL;
    size_t flat = 0;
    cw_status st = CW_OK;
    *found = 0;
    for (size_t t = 0; t < count; t++)
        *found += !has_area(m, t);
    if (!*found)
        return CW_OK;
    touched = cwi_alloc_zeroed(count, sizeof *touched);
    marked = cwi_alloc_zeroed(count, sizeof *marked);
    if (!touched || !marked || !(edges = cwi_edge_keys(m->triangles, 3 * count)))
        st = cwi_fail_memory(err);
    for (uint32_t t = 0; t < count && st == CW_OK; t++) {
        if (touched[t] || has_area(m, t))
            continue;
        if (give_up)
            marked[t] = true;
        else
            flip_longest(r, edges, t, touched, marked);
    }
    for (size_t t = 0; t < count && st == CW_OK; t++)
        flat += marked[t];
    if (flat)
        st = cwi_mesh_drop_marked(m, marked, err);
    if (st == CW_OK)
        st = cwi_repair_link(r, false, err);
    cwi_free(touched);
    cwi_free(marked);
    cwi_free(edges);
    return st;
}

cw_status cwi_drop_degenerate(cwi_repair *r, size_t *dropped, cw_error *err)
{
    size_t found = 0;
    cw_status st = flip_round(r, false, &found, err);
    *dropped += found;
    for (int n = 1; n < FLIP_ROUNDS && found && st == CW_OK; n++)
        st = flip_round(r, false, &found, err);
    return st == CW_OK && found ? flip_round(r, true, &found, err) : st;
}

/* --- sheets ------------------------------------------------------------------------------- */

typedef struct component_size {
    double volume, area, middle[3]; /* volume: six times */
    size_t triangles, loop;
} component_size;

/* Sums areas, and the middles of rims. */
static void add_triangle(const cwi_repair *r, uint32_t t, component_size *s)
{
    double p[3][3];
    cwi_mesh_corners(&r->mesh, t, p);
    s->area += cwi_triangle_area(p[0], p[1], p[2]);
    s->triangles++;
    for (uint32_t k = 0; k < 3; k++)
        if (r->twin[3 * t + k] == CWI_NO_CORNER) {
            s->loop++;
            for (int a = 0; a < 3; a++)
                s->middle[a] += p[k][a];
        }
}

/* Adds the volume between a triangle and the middle of the rims: of a component that is closed by
 * fans from there. */
static void add_volume(const cwi_repair *r, uint32_t t, component_size *s)
{
    double p[3][3], area[3];
    cwi_mesh_corners(&r->mesh, t, p);
    for (int k = 0; k < 3; k++)
        cwi_sub(p[k], s->middle, p[k]);
    cwi_cross(p[1], p[2], area);
    s->volume += cwi_dot(p[0], area);
}

/* Sets the middle of the rims, or a point of a closed component. */
static void set_middle(const cw_mesh *m, uint32_t t, component_size *s)
{
    for (size_t a = 0; a < 3; a++)
        s->middle[a] = s->loop ? s->middle[a] / (double)s->loop
                               : (double)m->positions[3 * (size_t)m->triangles[3 * t] + a];
}

static bool is_sheet(const component_size *s)
{
    const double min_volume = s->loop ? SHEET_VOLUME : CLOSED_SHEET_VOLUME;
    return !(fabs(s->volume) / 6 >= min_volume * s->area * sqrt(s->area));
}

cw_status cwi_drop_sheets(cwi_repair *r, size_t *sheets, size_t *triangles, cw_error *err)
{
    const size_t count = r->mesh.triangle_count;
    uint32_t *set = cwi_sets_alloc(count);
    component_size *sizes = cwi_alloc_zeroed(count, sizeof *sizes);
    bool *marked = cwi_alloc_zeroed(count, sizeof *marked);
    size_t found = 0;
    cw_status st = set && sizes && marked ? CW_OK : cwi_fail_memory(err);
    for (uint32_t c = 0; c < 3 * count && st == CW_OK; c++)
        if (r->twin[c] != CWI_NO_CORNER)
            cwi_sets_join(set, c / 3, r->twin[c] / 3);
    for (uint32_t t = 0; t < count && st == CW_OK; t++)
        add_triangle(r, t, &sizes[cwi_sets_find(set, t)]);
    for (uint32_t t = 0; t < count && st == CW_OK; t++)
        if (set[t] == t)
            set_middle(&r->mesh, t, &sizes[t]);
    for (uint32_t t = 0; t < count && st == CW_OK; t++)
        add_volume(r, t, &sizes[cwi_sets_find(set, t)]);
    for (uint32_t t = 0; t < count && st == CW_OK; t++) {
        const uint32_t root = cwi_sets_find(set, t);
        marked[t] = is_sheet(&sizes[root]);
        found += marked[t];
        *sheets += marked[t] && root == t;
    }
    *triangles += found;
    if (found && st == CW_OK)
        st = cwi_mesh_drop_marked(&r->mesh, marked, err);
    if (found && st == CW_OK)
        st = cwi_repair_link(r, false, err);
    cwi_free(set);
    cwi_free(sizes);
    cwi_free(marked);
    return st;
}
