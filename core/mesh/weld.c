/* Finds points at equal coordinates by a hash table. */
#include "core/mesh/weld.h"

#include "core/base/memory.h"

#include <string.h>

static bool same_point(const float *p, const float *q)
{
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

static size_t hash_point(const float *p)
{
    uint64_t hash = 0;
    for (int a = 0; a < 3; a++) {
        const float positive_zero = p[a] + 0.0f; /* -0 equals 0, so it must hash as 0 does */
        uint32_t bits;
        memcpy(&bits, &positive_zero, sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    return (size_t)hash;
}

/* Finds the slot that holds the point (as its number + 1), or the free one for it. The search
 * starts at the slot of the point's hash. */
static size_t find_slot(const uint32_t *table, size_t slots, size_t start, const float *points,
                        const float *point)
{
    size_t s = start;
    while (table[s] && !same_point(point, points + 3 * ((size_t)table[s] - 1)))
        s = (s + 1) & (slots - 1);
    return s;
}

bool cwi_weld(const float *points, size_t count, uint32_t *map)
{
    size_t slots = 1;
    while (slots < 2 * count)
        slots *= 2;
    uint32_t *table = cwi_alloc_zeroed(slots, sizeof *table);
    if (!table)
        return false;
    for (size_t v = 0; v < count; v++) {
        const float *p = points + 3 * v;
        const size_t s = find_slot(table, slots, hash_point(p) & (slots - 1), points, p);
        if (!table[s])
            table[s] = (uint32_t)v + 1;
        map[v] = table[s] - 1;
    }
    cwi_free(table);
    return true;
}

/* Doubles the capacity; the table is never more than half full. */
static bool grow_table(cwi_welder *w)
{
    const size_t capacity = w->capacity ? 2 * w->capacity : 1024, slots = 2 * capacity;
    float *points = cwi_realloc_array(w->points, capacity, 3 * sizeof *points);
    if (!points)
        return false;
    w->points = points;
    uint32_t *table = cwi_alloc_zeroed(slots, sizeof *table);
    if (!table)
        return false;
    for (size_t v = 0; v < w->count; v++) /* all differ, so each takes the first free slot */
        for (size_t s = hash_point(points + 3 * v) & (slots - 1);; s = (s + 1) & (slots - 1))
            if (!table[s]) {
                table[s] = (uint32_t)v + 1;
                break;
            }
    cwi_free(w->table);
    w->table = table;
    w->slots = slots;
    w->capacity = capacity;
    return true;
}

enum { BATCH = 64 };

/* Adds a batch of points. Slots of a table that is larger than the caches arrive late. So all
 * slots are prefetched first, then the points that they name, and only then are points
 * compared. */
static bool add_batch(cwi_welder *w, const float *points, size_t count, uint32_t *indices)
{
    size_t start[BATCH];
    for (size_t i = 0; i < count; i++) {
        start[i] = hash_point(points + 3 * i) & (w->slots - 1);
        __builtin_prefetch(&w->table[start[i]]);
    }
    for (size_t i = 0; i < count; i++)
        if (w->table[start[i]])
            __builtin_prefetch(w->points + 3 * ((size_t)w->table[start[i]] - 1));
    for (size_t i = 0; i < count; i++) {
        const float *p = points + 3 * i;
        const size_t s = find_slot(w->table, w->slots, start[i], w->points, p);
        if (!w->table[s]) {
            if (w->count == UINT32_MAX - 1)
                return false;
            memcpy(w->points + 3 * w->count, p, 3 * sizeof *p);
            w->table[s] = (uint32_t)++w->count;
        }
        indices[i] = w->table[s] - 1;
    }
    return true;
}

bool cwi_welder_add(cwi_welder *w, const float *points, size_t count, uint32_t *indices)
{
    bool ok = true;
    for (size_t i = 0; ok && i < count; i += BATCH) {
        const size_t batch = count - i < BATCH ? count - i : BATCH;
        while (ok && w->capacity - w->count < batch)
            ok = grow_table(w);
        ok = ok && add_batch(w, points + 3 * i, batch, indices + i);
    }
    return ok;
}

void cwi_welder_free(cwi_welder *w)
{
    cwi_free(w->points);
    cwi_free(w->table);
    *w = (cwi_welder){0};
}
