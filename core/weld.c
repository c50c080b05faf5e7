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

/* The table holds point + 1 where its hash says, or in the next free slot. */
bool cwi_weld(const float *points, size_t count, uint32_t *map)
{
    size_t size = 1;
    while (size < 2 * count)
        size *= 2;
    uint32_t *table = cwi_alloc_zeroed(size, sizeof *table);
    if (!table)
        return false;
    for (size_t v = 0; v < count; v++) {
        const float *p = points + 3 * v;
        size_t s = hash_point(p) & (size - 1);
        while (table[s] && !same_point(p, points + 3 * ((size_t)table[s] - 1)))
            s = (s + 1) & (size - 1);
        if (!table[s])
            table[s] = (uint32_t)v + 1;
        map[v] = table[s] - 1;
    }
    cwi_free(table);
    return true;
}
