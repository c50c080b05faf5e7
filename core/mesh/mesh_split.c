/* Parts a mesh into its solids: components, each with the cavities inside it. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/bvh.h"
#include "core/geometry/exact_predicates.h"
#include "core/mesh/components.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"
#include "core/mesh/weld.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NONE UINT32_MAX

enum { MAX_TRIES = 64 };

/* A solid, and the volume by which solids are ordered. */
typedef struct ranked_solid {
    cwi_volume_sum volume;
    uint32_t set;
} ranked_solid;

/* A set that a ray crosses, and whether it leaves (1) or enters it. */
typedef struct crossing {
    uint32_t set;
    int winding;
} crossing;

typedef struct splitting {
    const cw_mesh *mesh;
    cwi_components c;
    uint32_t *owner; /* of sets: the set of their solid; NONE: no triangle */
    cwi_boxes tree;  /* of the triangles `items` of sets that are no cavities */
    uint32_t *items;
    ranked_solid *solids;
    size_t solid_count;
} splitting;

/* A ray along +x from inside a triangle of a cavity. */
typedef struct cavity_ray {
    const splitting *s;
    uint32_t set;
    float start[3];
    crossing *crossings;
    size_t count, capacity;
    bool touches; /* an edge, or starts in a plane: another start is taken */
    bool starved;
} cavity_ray;

/* --- the solid around a cavity ------------------------------------------------------------ */

static const float *corner_of(const cw_mesh *m, size_t t, size_t k)
{
    return m->positions + 3 * (size_t)m->triangles[3 * t + k];
}

/* Crosses a triangle, exactly: where the ray meets an edge, nothing is said. */
static void cross_triangle(cavity_ray *r, size_t t)
{
    const cw_mesh *m = r->s->mesh;
    const float *p[3] = {corner_of(m, t, 0), corner_of(m, t, 1), corner_of(m, t, 2)};
    int side[3];
    for (int k = 0; k < 3; k++)
        side[k] = cwi_orient2d(p[k], p[(k + 1) % 3], r->start, 0);
    const bool is_left = side[0] >= 0 && side[1] >= 0 && side[2] >= 0;
    const bool is_right = side[0] <= 0 && side[1] <= 0 && side[2] <= 0;
    if (!is_left && !is_right)
        return;
    const int beyond = cwi_orient3d(p[0], p[1], p[2], r->start);
    if (!side[0] || !side[1] || !side[2] || beyond == 0) {
        r->touches = true;
        return;
    }
    if ((is_left ? 1 : -1) * beyond > 0)
        return; /* it lies behind the start */
    if (r->count == r->capacity) {
        const size_t capacity = r->capacity ? 2 * r->capacity : 64;
        crossing *more = cwi_realloc_array(r->crossings, capacity, sizeof *more);
        r->starved = !more;
        if (!more)
            return;
        r->crossings = more;
        r->capacity = capacity;
    }
    r->crossings[r->count++] = (crossing){r->s->c.set[m->triangles[3 * t]], is_left ? 1 : -1};
}

static bool cross_node(void *context, size_t node)
{
    cavity_ray *r = context;
    const splitting *s = r->s;
    const float box[6] = {r->start[0], r->start[1], r->start[2],
                          INFINITY,    r->start[1], r->start[2]};
    unsigned near = cwi_boxes_meeting(s->tree.nodes + node, box);
    for (; near && !r->starved && !r->touches; near &= near - 1) {
        const size_t slot = node * CWI_WIDTH + (size_t)__builtin_ctz(near);
        cross_triangle(r, s->items[s->tree.order[slot]]);
    }
    return !r->starved && !r->touches;
}

static int compare_crossings(const void *a, const void *b)
{
    const crossing *x = a, *y = b;
    return (x->set > y->set) - (x->set < y->set);
}

/* Returns the smallest of the solids around the start; NONE: there is none. */
static uint32_t find_around(cavity_ray *r)
{
    const cwi_components *c = &r->s->c;
    uint32_t found = NONE;
    if (r->count > 1)
        qsort(r->crossings, r->count, sizeof *r->crossings, compare_crossings);
    for (size_t n = 0; n < r->count;) {
        const uint32_t set = r->crossings[n].set;
        int winding = 0;
        for (; n < r->count && r->crossings[n].set == set; n++)
            winding += r->crossings[n].winding;
        if (winding && (found == NONE || c->sums[set] < c->sums[found]))
            found = set;
    }
    return found;
}

/* Casts a ray from the middle of a triangle. Returns false when another start has to be taken. */
static bool cast_ray(cavity_ray *r, size_t t)
{
    const cw_mesh *m = r->s->mesh;
    r->count = 0;
    r->touches = false;
    for (int a = 0; a < 3; a++)
        r->start[a] =
            (corner_of(m, t, 0)[a] + corner_of(m, t, 1)[a] + corner_of(m, t, 2)[a]) / 3;
    const float box[6] = {r->start[0], r->start[1], r->start[2],
                          INFINITY,    r->start[1], r->start[2]};
    cwi_boxes_visit(&r->s->tree, box, 0, cross_node, r);
    return !r->touches;
}

static bool is_cavity(const splitting *s, size_t t)
{
    return s->c.cavity[s->c.set[s->mesh->triangles[3 * t]]];
}

static cw_status build_tree(splitting *s, cw_error *err)
{
    const cw_mesh *m = s->mesh;
    size_t count = 0;
    for (size_t t = 0; t < m->triangle_count; t++)
        count += !is_cavity(s, t);
    s->items = cwi_alloc_array(count, sizeof *s->items);
    float(*boxes)[6] = cwi_alloc_array(count, sizeof *boxes);
    if (!s->items || !boxes) {
        cwi_free(boxes);
        return cwi_fail_memory(err);
    }
    count = 0;
    for (size_t t = 0; t < m->triangle_count; t++)
        if (!is_cavity(s, t)) {
            cwi_boxes_triangle(m->positions, m->triangles + 3 * t, boxes[count]);
            s->items[count++] = (uint32_t)t;
        }
    cw_status st = cwi_boxes_build(&s->tree, (const float(*)[6])boxes, count, err);
    cwi_free(boxes);
    return st;
}

/* Gives each cavity to the solid around it. One that no ray places stays by itself. */
static cw_status place_cavities(splitting *s, cw_error *err)
{
    const cw_mesh *m = s->mesh;
    cavity_ray ray = {.s = s};
    uint8_t *tries = cwi_alloc_zeroed(s->c.count, sizeof *tries);
    cw_status st = tries ? build_tree(s, err) : cwi_fail_memory(err);
    for (size_t t = 0; t < m->triangle_count && st == CW_OK; t++) {
        const uint32_t set = s->c.set[m->triangles[3 * t]];
        if (!s->c.cavity[set] || tries[set] == MAX_TRIES)
            continue;
        ray.set = set;
        tries[set]++;
        if (!cast_ray(&ray, t))
            continue;
        tries[set] = MAX_TRIES;
        const uint32_t around = find_around(&ray);
        s->owner[set] = around == NONE ? set : around;
        st = ray.starved ? cwi_fail_memory(err) : CW_OK;
    }
    cwi_free(ray.crossings);
    cwi_free(tries);
    return st;
}

/* --- the solids --------------------------------------------------------------------------- */

static cw_status find_owners(splitting *s, cw_error *err)
{
    const cw_mesh *m = s->mesh;
    bool has_cavities = false;
    s->owner = cwi_alloc_array(s->c.count, sizeof *s->owner);
    if (!s->owner)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < s->c.count; n++)
        s->owner[n] = NONE;
    for (size_t c = 0; c < 3 * m->triangle_count; c += 3) {
        const uint32_t set = s->c.set[m->triangles[c]];
        s->owner[set] = set;
        has_cavities = has_cavities || s->c.cavity[set];
    }
    return has_cavities ? place_cavities(s, err) : CW_OK;
}

/* Larger volumes come first, and of equal ones that with the first vertex. */
static int compare_solids(const void *a, const void *b)
{
    const ranked_solid *x = a, *y = b;
    return x->volume != y->volume ? (x->volume < y->volume ? 1 : -1)
                                  : (x->set > y->set) - (x->set < y->set);
}

/* Orders the solids, and replaces the owners of sets by the numbers of their solids. */
static cw_status rank_solids(splitting *s, cw_error *err)
{
    uint32_t *number = cwi_alloc_array(s->c.count, sizeof *number);
    s->solids = cwi_alloc_array(s->c.count, sizeof *s->solids);
    if (!number || !s->solids) {
        cwi_free(number);
        return cwi_fail_memory(err);
    }
    for (uint32_t n = 0; n < s->c.count; n++)
        if (s->owner[n] == n)
            s->solids[s->solid_count++] = (ranked_solid){s->c.sums[n], n};
    if (s->solid_count > 1)
        qsort(s->solids, s->solid_count, sizeof *s->solids, compare_solids);
    for (uint32_t n = 0; n < s->solid_count; n++)
        number[s->solids[n].set] = n;
    for (size_t n = 0; n < s->c.count; n++)
        s->owner[n] = s->owner[n] == NONE ? NONE : number[s->owner[n]];
    cwi_free(number);
    return CW_OK;
}

/* Counts what each solid gets, in its vertex_count and triangle_count, and the new number of each
 * vertex; NONE: no triangle names it. */
static void count_elements(const splitting *s, uint32_t *number, cw_mesh *solids)
{
    const cw_mesh *m = s->mesh;
    memset(number, 0xff, m->vertex_count * sizeof *number);
    for (size_t c = 0; c < 3 * m->triangle_count; c++)
        number[m->triangles[c]] = 0;
    for (size_t v = 0; v < m->vertex_count; v++)
        if (number[v] == 0)
            number[v] = (uint32_t)solids[s->owner[s->c.set[v]]].vertex_count++;
    for (size_t c = 0; c < 3 * m->triangle_count; c += 3)
        solids[s->owner[s->c.set[m->triangles[c]]]].triangle_count++;
}

static cw_status alloc_solid(const cw_mesh *from, cw_mesh *solid, cw_error *err)
{
    const size_t vertices = solid->vertex_count, triangles = solid->triangle_count;
    cw_status st = cwi_mesh_alloc(solid, vertices, triangles, false, err);
    if (st != CW_OK)
        return st;
    memcpy(solid->origin, from->origin, sizeof solid->origin);
    memcpy(solid->affine, from->affine, sizeof solid->affine);
    return cwi_attributes_alloc(from, solid, err);
}

static void fill_solids(const splitting *s, const uint32_t *number, cw_mesh *solids,
                        uint32_t *filled)
{
    const cw_mesh *m = s->mesh;
    for (size_t v = 0; v < m->vertex_count; v++) {
        if (number[v] == NONE)
            continue;
        cw_mesh *to = &solids[s->owner[s->c.set[v]]];
        memcpy(to->positions + 3 * (size_t)number[v], m->positions + 3 * v,
               3 * sizeof *m->positions);
        cwi_attributes_put(m, v, to, number[v]);
    }
    for (size_t t = 0; t < m->triangle_count; t++) {
        const uint32_t *corners = m->triangles + 3 * t, solid = s->owner[s->c.set[corners[0]]];
        const size_t n = filled[solid]++;
        for (size_t k = 0; k < 3; k++)
            solids[solid].triangles[3 * n + k] = number[corners[k]];
        cwi_attributes_put_triangle(m, t, corners, &solids[solid], n);
    }
}

static cw_status make_solids(const splitting *s, cw_mesh *solids, cw_error *err)
{
    uint32_t *number = cwi_alloc_array(s->mesh->vertex_count, sizeof *number);
    uint32_t *filled = cwi_alloc_zeroed(s->solid_count, sizeof *filled);
    cw_status st = number && filled ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        count_elements(s, number, solids);
    for (size_t n = 0; n < s->solid_count && st == CW_OK; n++)
        st = alloc_solid(s->mesh, &solids[n], err);
    if (st == CW_OK)
        fill_solids(s, number, solids, filled);
    cwi_free(filled);
    cwi_free(number);
    return st;
}

static cw_status find_solids(splitting *s, cw_error *err)
{
    uint32_t *same = cwi_alloc_array(s->mesh->vertex_count, sizeof *same);
    cw_status st = same && cwi_weld(s->mesh->positions, s->mesh->vertex_count, same)
                       ? cwi_components_find(s->mesh, same, &s->c, err)
                       : cwi_fail_memory(err);
    cwi_free(same);
    if (st == CW_OK)
        st = cwi_components_measure(s->mesh, &s->c, err);
    if (st == CW_OK)
        st = find_owners(s, err);
    return st == CW_OK ? rank_solids(s, err) : st;
}

void cw_meshes_free(cw_mesh *meshes, size_t count)
{
    for (size_t n = 0; n < count && meshes; n++)
        cw_mesh_free(&meshes[n]);
    cwi_free(meshes);
}

cw_status cw_mesh_split(const cw_mesh *mesh, cw_mesh **solids, size_t *count, cw_error *err)
{
    CWI_REQUIRE(err, mesh, solids, count);
    splitting s = {.mesh = mesh};
    *solids = NULL;
    *count = 0;
    cw_status st = cwi_mesh_check_size(mesh, "split", err);
    if (st == CW_OK)
        st = find_solids(&s, err);
    cw_mesh *out = st == CW_OK ? cwi_alloc_zeroed(s.solid_count, sizeof *out) : NULL;
    if (st == CW_OK)
        st = out ? make_solids(&s, out, err) : cwi_fail_memory(err);
    if (st == CW_OK) {
        *solids = out;
        *count = s.solid_count;
    } else {
        cw_meshes_free(out, s.solid_count);
    }
    cwi_components_free(&s.c);
    cwi_boxes_free(&s.tree);
    cwi_free(s.items);
    cwi_free(s.owner);
    cwi_free(s.solids);
    return st;
}
