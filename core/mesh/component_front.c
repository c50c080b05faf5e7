/* Joins the vertices of a surface that passes by to components, and sums what they enclose. */
#include "core/mesh/component_front.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/union_find.h"

#include <string.h>

/* Elements of the smallest array. */
enum { MIN_CAPACITY = 512 };

#define NO_SLOT UINT32_MAX

/* Sums of the triangles of a component so far. The middle of its box is not known before its end:
 * the volume up to there follows from the volume up to the origin and the area vector. */
typedef struct cwi_front_component {
    cwi_volume_sum volume;  /* six times, up to the origin */
    cwi_volume_sum area[3]; /* twice the area vector; zero for a closed component */
    int32_t low[3], high[3];
    uint32_t next; /* of the list of unused ones */
} component;

enum { VERTEX_BYTES = 2 * sizeof(uint32_t) + 3 * sizeof(int32_t) };

/* --- memory ------------------------------------------------------------------------------- */

size_t cwi_front_bytes(const cwi_component_front *f)
{
    return f->capacity * VERTEX_BYTES + f->component_capacity * sizeof *f->components;
}

void cwi_front_free(cwi_component_front *f)
{
    cwi_free(f->sets);
    cwi_free(f->slots);
    cwi_free(f->points);
    cwi_free(f->components);
    f->sets = f->slots = NULL;
    f->points = NULL;
    f->components = NULL;
    f->capacity = f->component_capacity = 0;
}

static cw_status check_bytes(const cwi_component_front *f, size_t more, cw_error *err)
{
    const size_t bytes = cwi_front_bytes(f) + more;
    char needed[CWI_MEMORY_TEXT], limit[CWI_MEMORY_TEXT];
    if (!f->max_bytes || bytes <= f->max_bytes)
        return CW_OK;
    cwi_print_memory(bytes, needed);
    cwi_print_memory(f->max_bytes, limit);
    return cwi_fail(err, CW_ERR_LIMIT,
                    "the components at the surface's front need %s so far; the limit is %s",
                    needed, limit);
}

static cw_status grow_array(void **array, size_t count, size_t element, cw_error *err)
{
    void *memory = cwi_realloc_array(*array, count, element);
    if (!memory)
        return cwi_fail_memory(err);
    *array = memory;
    return CW_OK;
}

bool cwi_front_is_full(const cwi_component_front *f, size_t vertices)
{
    return f->end - f->begin + vertices > f->capacity;
}

cw_status cwi_front_reserve(cwi_component_front *f, size_t vertices, cw_error *err)
{
    const size_t needed = f->end - f->begin + vertices;
    if (needed <= f->capacity - f->capacity / 8)
        return CW_OK;
    const size_t capacity = needed + needed / 4 + MIN_CAPACITY;
    cw_status st = check_bytes(f, (capacity - f->capacity) * VERTEX_BYTES, err);
    if (st == CW_OK)
        st = grow_array((void **)&f->sets, capacity, sizeof *f->sets, err);
    if (st == CW_OK)
        st = grow_array((void **)&f->slots, capacity, sizeof *f->slots, err);
    if (st == CW_OK)
        st = grow_array((void **)&f->points, capacity, sizeof *f->points, err);
    if (st == CW_OK)
        f->capacity = capacity;
    return st;
}

/* Takes an unused component. Growth may move the others. */
static cw_status take_slot(cwi_component_front *f, uint32_t *slot, cw_error *err)
{
    if (f->free_slot) {
        *slot = f->free_slot - 1;
        f->free_slot = f->components[*slot].next;
        return CW_OK;
    }
    if (f->component_count == f->component_capacity) {
        const size_t more = f->component_capacity / 4 + MIN_CAPACITY;
        cw_status st = check_bytes(f, more * sizeof *f->components, err);
        if (st == CW_OK)
            st = grow_array((void **)&f->components, f->component_capacity + more,
                            sizeof *f->components, err);
        if (st != CW_OK)
            return st;
        f->component_capacity += more;
    }
    *slot = (uint32_t)f->component_count++;
    return CW_OK;
}

static void release_slot(cwi_component_front *f, uint32_t slot)
{
    f->components[slot].next = f->free_slot;
    f->free_slot = slot + 1;
}

/* --- vertices and triangles --------------------------------------------------------------- */

cw_status cwi_front_append(cwi_component_front *f, const float *positions, size_t vertices,
                           cw_error *err)
{
    for (size_t i = 0; i < 3 * vertices; i++)
        if (!isfinite(positions[i]))
            return cwi_fail(err, CW_ERR_ARGUMENT, "the position of vertex %zu is not finite",
                            f->end + i / 3);
    const size_t first = f->end - f->begin;
    for (size_t v = 0; v < vertices; v++) {
        f->sets[first + v] = (uint32_t)(first + v);
        f->slots[first + v] = NO_SLOT;
        for (size_t a = 0; a < 3; a++)
            f->points[first + v][a] =
                (int32_t)cwi_volume_coordinate(f->unit.scale, positions[3 * v + a]);
    }
    f->end += vertices;
    return CW_OK;
}

static void widen_box(component *c, const int32_t low[3], const int32_t high[3])
{
    for (int a = 0; a < 3; a++) {
        c->low[a] = low[a] < c->low[a] ? low[a] : c->low[a];
        c->high[a] = high[a] > c->high[a] ? high[a] : c->high[a];
    }
}

static cw_status begin_component(cwi_component_front *f, uint32_t vertex, uint32_t *slot,
                                 cw_error *err)
{
    cw_status st = take_slot(f, slot, err);
    if (st != CW_OK)
        return st;
    component *c = f->components + *slot;
    *c = (component){0};
    memcpy(c->low, f->points[vertex], sizeof c->low);
    memcpy(c->high, f->points[vertex], sizeof c->high);
    f->slots[vertex] = *slot;
    return CW_OK;
}

/* Joins two sets, the first of which has a component, and returns the root. */
static uint32_t join_sets(cwi_component_front *f, uint32_t one, uint32_t other)
{
    const uint32_t slot = f->slots[one], gone = f->slots[other];
    component *c = f->components + slot;
    if (one == other)
        return one;
    if (gone == NO_SLOT) {
        widen_box(c, f->points[other], f->points[other]);
    } else {
        const component *d = f->components + gone;
        widen_box(c, d->low, d->high);
        c->volume += d->volume;
        for (int a = 0; a < 3; a++)
            c->area[a] += d->area[a];
        release_slot(f, gone);
    }
    const uint32_t root = one < other ? one : other;
    f->sets[one] = f->sets[other] = root;
    f->slots[root] = slot;
    return root;
}

cw_status cwi_front_join(cwi_component_front *f, const uint32_t corners[3], cw_error *err)
{
    uint32_t v[3], slot;
    int64_t p[3][3], area[3];
    for (int n = 0; n < 3; n++) {
        v[n] = corners[n] - (uint32_t)f->begin;
        for (int a = 0; a < 3; a++)
            p[n][a] = f->points[v[n]][a];
    }
    uint32_t root = cwi_sets_find(f->sets, v[0]);
    if (f->slots[root] == NO_SLOT) {
        cw_status st = begin_component(f, root, &slot, err);
        if (st != CW_OK)
            return st;
    }
    for (int n = 1; n < 3; n++)
        root = join_sets(f, root, cwi_sets_find(f->sets, v[n]));
    component *c = f->components + f->slots[root];
    cwi_volume_area(p[0], p[1], p[2], area);
    c->volume += cwi_volume_dot(p[0], area);
    for (int a = 0; a < 3; a++)
        c->area[a] += area[a];
    return CW_OK;
}

/* --- vertices that leave ------------------------------------------------------------------ */

/* Judges a component that is complete, and returns the link that says so. */
static uint32_t judge_component(cwi_component_front *f, uint32_t slot)
{
    cw_drop_counts *n = &f->counts;
    if (slot == NO_SLOT) /* a vertex of no triangle */
        return CWI_LINK_DROPPED;
    const component *c = f->components + slot;
    cwi_volume_sum sum = 2 * c->volume;
    for (int a = 0; a < 3; a++)
        sum -= c->area[a] * ((int64_t)c->low[a] + c->high[a]);
    const bool is_cavity = cwi_volume_is_cavity(sum, c->area);
    sum = cwi_volume_abs(sum);
    release_slot(f, slot);
    const double size = cwi_volume_mm3(&f->unit, sum);
    if (size >= f->least_mm3) {
        n->least_kept_mm3 = n->kept ? fmin(n->least_kept_mm3, size) : size;
        n->kept++;
        return CWI_LINK_KEPT;
    }
    f->dropped += sum;
    n->largest_mm3 = fmax(n->largest_mm3, size);
    n->dropped++;
    n->cavities += is_cavity;
    return CWI_LINK_DROPPED;
}

void cwi_front_settle(cwi_component_front *f, size_t final)
{
    uint32_t *sets = f->sets;
    const uint32_t count = (uint32_t)(final - f->begin), all = (uint32_t)(f->end - f->begin);
    for (uint32_t v = 0; v < all; v++)
        sets[v] = cwi_sets_find(sets, v);

    /* A set whose root leaves gets its first remaining vertex as the root. */
    for (uint32_t v = count; v < all; v++) {
        const uint32_t root = sets[v];
        if (root >= count)
            continue;
        if (sets[root] == root) {
            sets[root] = v;
            f->slots[v] = f->slots[root];
        }
        sets[v] = sets[root];
    }

    /* A root comes before the others of its set: its entry then is a link already. */
    for (uint32_t v = 0; v < count; v++) {
        const uint32_t to = sets[v];
        if (to == v)
            sets[v] = judge_component(f, f->slots[v]);
        else if (to >= count)
            sets[v] = to - v;
        else if (sets[to] != CWI_LINK_DROPPED && sets[to] != CWI_LINK_KEPT)
            sets[v] = to + sets[to] - v;
        else
            sets[v] = sets[to];
        if (to >= count && to - v > f->farthest)
            f->farthest = to - v;
    }
}

void cwi_front_drop(cwi_component_front *f, size_t final)
{
    const size_t count = final - f->begin, left = f->end - final;
    for (size_t v = 0; v < left; v++)
        f->sets[v] = f->sets[v + count] - (uint32_t)count;
    memmove(f->slots, f->slots + count, left * sizeof *f->slots);
    memmove(f->points, f->points + count, left * sizeof *f->points);
    f->begin = final;
}
