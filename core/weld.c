#include "core/weld.h"

#include "core/memory.h"

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

/* The slot that holds the point (as its number + 1), or the free one where it belongs. */
static size_t find_slot(const uint32_t *table, size_t slots, const float *points,
                        const float *point)
{
    size_t s = hash_point(point) & (slots - 1);
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
        const size_t s = find_slot(table, slots, points, points + 3 * v);
        if (!table[s])
            table[s] = (uint32_t)v + 1;
        map[v] = table[s] - 1;
    }
    cwi_free(table);
    return true;
}

/* Room for twice as many points, in a table that is never more than half full. */
static bool grow(cwi_welder *w)
{
    const size_t room = w->room ? 2 * w->room : 1024, slots = 2 * room;
    float *points = cwi_realloc_array(w->points, room, 3 * sizeof *points);
    if (!points)
        return false;
    w->points = points;
    uint32_t *table = cwi_alloc_zeroed(slots, sizeof *table);
    if (!table)
        return false;
    for (size_t v = 0; v < w->count; v++)
        table[find_slot(table, slots, points, points + 3 * v)] = (uint32_t)v + 1;
    cwi_free(w->table);
    w->table = table;
    w->slots = slots;
    w->room = room;
    return true;
}

bool cwi_welder_add(cwi_welder *w, const float point[3], uint32_t *index)
{
    if (w->count == w->room && !grow(w))
        return false;
    const size_t s = find_slot(w->table, w->slots, w->points, point);
    if (!w->table[s]) {
        if (w->count == UINT32_MAX - 1)
            return false;
        memcpy(w->points + 3 * w->count, point, 3 * sizeof *point);
        w->table[s] = (uint32_t)++w->count;
    }
    *index = w->table[s] - 1;
    return true;
}

void cwi_welder_free(cwi_welder *w)
{
    cwi_free(w->points);
    cwi_free(w->table);
    *w = (cwi_welder){0};
}
