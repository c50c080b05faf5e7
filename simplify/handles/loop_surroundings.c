/* Gathers the triangles around a loop and near it, and moves the rims of the cut apart. */
#include "simplify/handles/loop_surroundings.h"

#include "core/base/memory.h"
#include "core/geometry/triangle.h"
#include "core/geometry/triangle_intersect.h"
#include "core/mesh/corner_table.h"

#include <stdlib.h>
#include <string.h>

/* A corner at a vertex of a rim. */
typedef struct rim_corner {
    uint32_t corner, rim_vertex;
} rim_corner;

/* Numbers in a list that grows. */
typedef struct number_list {
    uint32_t *items;
    size_t count, capacity;
    bool is_memory_out;
} number_list;

typedef struct corner_list {
    rim_corner *items;
    size_t count, capacity;
} corner_list;

void cwi_surroundings_free(cwi_surroundings *s)
{
    cw_mesh_free(&s->mesh);
    cwi_free(s->ids);
    cwi_free(s->vertices);
    cwi_free(s->steps);
    *s = (cwi_surroundings){0};
}

static void add_number(number_list *l, uint32_t n)
{
    uint32_t *grown = cwi_grow_array(l->items, l->count, &l->capacity, sizeof *grown);
    l->is_memory_out = l->is_memory_out || !grown;
    if (!grown)
        return;
    l->items = grown;
    l->items[l->count++] = n;
}

static int compare_numbers(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Sorts numbers, and keeps one of each. */
static size_t sort_numbers(uint32_t *items, size_t count)
{
    size_t kept = 0;
    if (count)
        qsort(items, count, sizeof *items, compare_numbers);
    for (size_t n = 0; n < count; n++)
        if (n == 0 || items[n] != items[n - 1])
            items[kept++] = items[n];
    return kept;
}

static bool has_number(const uint32_t *items, size_t count, uint32_t n)
{
    return count && bsearch(&n, items, count, sizeof *items, compare_numbers);
}

/* --- around the loop ---------------------------------------------------------------------- */

static int compare_corners(const void *a, const void *b)
{
    const rim_corner *c = a, *d = b;
    return (c->corner > d->corner) - (c->corner < d->corner);
}

/* Adds the corners at a vertex of a rim: from a side around the vertex up to the side before `end`. */
static bool add_fan(const cwi_handles *h, corner_list *l, uint32_t from, uint32_t end,
                    uint32_t rim_vertex)
{
    for (uint32_t c = from;; c = h->twin[cwi_corner_prev(c)]) {
        rim_corner *grown = cwi_grow_array(l->items, l->count, &l->capacity, sizeof *grown);
        if (!grown)
            return false;
        l->items = grown;
        l->items[l->count++] = (rim_corner){c, rim_vertex};
        if (cwi_corner_prev(c) == end)
            return true;
    }
}

/* Lists the corners at the vertices of both rims, rising. */
static bool list_corners(const cwi_surroundings *s, corner_list *l)
{
    const cwi_handles *h = s->h;
    bool ok = true;
    for (uint32_t n = 0; n < s->rim && ok; n++) {
        const uint32_t before = s->sides[n ? n - 1 : s->rim - 1], after = s->sides[n];
        ok = add_fan(h, l, after, before, n) &&
             add_fan(h, l, h->twin[before], h->twin[after], s->rim + n);
    }
    if (ok)
        qsort(l->items, l->count, sizeof *l->items, compare_corners);
    return ok;
}

/* --- near the loop ------------------------------------------------------------------------ */

typedef struct near_search {
    const cwi_handles *h;
    const cwi_boxes *tree;
    const uint32_t
        *ids; /* of the tree's items; NULL: those of the input that have not changed */
    const float *box;
    number_list *found;
} near_search;

static bool visit_near(void *context, size_t node)
{
    const near_search *s = context;
    unsigned meeting = cwi_boxes_meeting(&s->tree->nodes[node], s->box);
    for (; meeting; meeting &= meeting - 1) {
        const uint32_t item = s->tree->order[node * CWI_WIDTH + (size_t)__builtin_ctz(meeting)];
        if (s->ids || !s->h->changed[item])
            add_number(s->found, s->ids ? s->ids[item] : item);
    }
    return !s->found->is_memory_out;
}

/* Lists the triangles around the loop, rising, then all others in the box, rising. */
static bool list_triangles(cwi_surroundings *s, const corner_list *corners,
                           const cwi_boxes *changed, const uint32_t *ids, const float box[6])
{
    number_list around = {0}, near = {0};
    near_search search = {s->h, &s->h->tree, NULL, box, &near};
    for (size_t n = 0; n < corners->count; n++)
        add_number(&around, corners->items[n].corner / 3);
    cwi_boxes_visit(search.tree, box, 0, visit_near, &search);
    search.tree = changed;
    search.ids = ids;
    cwi_boxes_visit(search.tree, box, 0, visit_near, &search);
    bool ok = !around.is_memory_out && !near.is_memory_out;
    s->around = ok ? sort_numbers(around.items, around.count) : 0;
    near.count = ok ? sort_numbers(near.items, near.count) : 0;
    s->ids = ok ? cwi_alloc_array(s->around + near.count, sizeof *s->ids) : NULL;
    ok = s->ids;
    if (ok)
        memcpy(s->ids, around.items, s->around * sizeof *s->ids);
    s->mesh.triangle_count = s->around;
    for (size_t n = 0; n < near.count && ok; n++)
        if (!has_number(around.items, s->around, near.items[n]))
            s->ids[s->mesh.triangle_count++] = near.items[n];
    cwi_free(around.items);
    cwi_free(near.items);
    return ok;
}

/* --- the mesh ----------------------------------------------------------------------------- */

static const rim_corner *find_corner(const corner_list *l, uint32_t corner)
{
    const rim_corner key = {corner, 0};
    return bsearch(&key, l->items, l->count, sizeof key, compare_corners);
}

/* Lists the vertices of the triangles that are not in the loop. */
static bool list_vertices(cwi_surroundings *s, const corner_list *corners)
{
    number_list l = {0};
    for (size_t n = 0; n < s->mesh.triangle_count; n++)
        for (uint32_t c = 3 * s->ids[n]; c < 3 * s->ids[n] + 3; c++)
            if (n >= s->around || !find_corner(corners, c))
                add_number(&l, s->h->triangles[c]);
    s->vertices = l.items;
    s->vertex_count = sort_numbers(l.items, l.count);
    return !l.is_memory_out;
}

static uint32_t find_vertex(const cwi_surroundings *s, uint32_t v)
{
    const uint32_t *at = bsearch(&v, s->vertices, s->vertex_count, sizeof v, compare_numbers);
    return 2 * s->rim + (uint32_t)(at - s->vertices);
}

static bool make_mesh(cwi_surroundings *s, const corner_list *corners)
{
    cw_mesh *m = &s->mesh;
    m->vertex_count = 2 * (size_t)s->rim + s->vertex_count;
    m->positions = cwi_alloc_array(m->vertex_count, 3 * sizeof *m->positions);
    m->triangles = cwi_alloc_array(m->triangle_count, 3 * sizeof *m->triangles);
    if (!m->positions || !m->triangles)
        return false;
    for (size_t n = 0; n < m->vertex_count; n++) {
        const uint32_t v = n < 2 * s->rim ? s->h->triangles[s->sides[n % s->rim]]
                                          : s->vertices[n - 2 * s->rim];
        memcpy(m->positions + 3 * n, s->h->positions + 3 * (size_t)v, 3 * sizeof(float));
    }
    for (size_t n = 0; n < 3 * m->triangle_count; n++) {
        const uint32_t c = 3 * s->ids[n / 3] + n % 3;
        const rim_corner *at = n / 3 < s->around ? find_corner(corners, c) : NULL;
        m->triangles[n] = at ? at->rim_vertex : find_vertex(s, s->h->triangles[c]);
    }
    return true;
}

/* Finds the steps to the middle of neighbours that are in no rim; 0 where there are none. */
static bool find_steps(cwi_surroundings *s)
{
    const cw_mesh *m = &s->mesh;
    const uint32_t rims = 2 * s->rim;
    double(*sums)[4] = cwi_alloc_zeroed(rims, sizeof *sums);
    s->steps = cwi_alloc_zeroed(rims, 3 * sizeof *s->steps);
    if (!sums || !s->steps) {
        cwi_free(sums);
        return false;
    }
    for (size_t c = 0; c < 3 * s->around; c++)
        for (size_t k = 1; k < 3 && m->triangles[c] < rims; k++) {
            const uint32_t other = m->triangles[c / 3 * 3 + (c + k) % 3];
            double *sum = sums[m->triangles[c]];
            for (size_t a = 0; a < 3 && other >= rims; a++)
                sum[a] += (double)m->positions[3 * (size_t)other + a];
            sum[3] += other >= rims;
        }
    for (size_t v = 0; v < rims; v++)
        for (size_t a = 0; a < 3 && sums[v][3] > 0; a++)
            s->steps[3 * v + a] =
                (float)(sums[v][a] / sums[v][3] - (double)m->positions[3 * v + a]);
    cwi_free(sums);
    return true;
}

bool cwi_surroundings_gather(cwi_surroundings *s, const cwi_handles *h, const cwi_loops *loops,
                             const cwi_loop *loop, const cwi_boxes *changed,
                             const uint32_t *ids, const float box[6])
{
    corner_list corners = {0};
    s->h = h;
    s->sides = loops->sides + loop->first;
    s->rim = loop->count;
    const bool ok = list_corners(s, &corners) &&
                    list_triangles(s, &corners, changed, ids, box) &&
                    list_vertices(s, &corners) && make_mesh(s, &corners) && find_steps(s);
    cwi_free(corners.items);
    return ok;
}

bool cwi_surroundings_part_rims(cwi_surroundings *s, float fraction)
{
    const cw_mesh *m = &s->mesh;
    for (size_t n = 0; n < 6 * (size_t)s->rim; n++) {
        const uint32_t v = s->h->triangles[s->sides[n / 3 % s->rim]];
        m->positions[n] = s->h->positions[3 * (size_t)v + n % 3] + fraction * s->steps[n];
    }
    for (size_t t = 0; t < s->around; t++) {
        const uint32_t *old = s->h->triangles + 3 * (size_t)s->ids[t],
                       *now = m->triangles + 3 * t;
        double before[3], after[3];
        cwi_facet_normal(s->h->positions + 3 * (size_t)old[0],
                         s->h->positions + 3 * (size_t)old[1],
                         s->h->positions + 3 * (size_t)old[2], before);
        cwi_facet_normal(m->positions + 3 * (size_t)now[0], m->positions + 3 * (size_t)now[1],
                         m->positions + 3 * (size_t)now[2], after);
        if (cwi_has_area(s->h->positions, old) &&
            (!cwi_has_area(m->positions, now) || !(cwi_dot(before, after) > 0)))
            return false;
    }
    return true;
}
