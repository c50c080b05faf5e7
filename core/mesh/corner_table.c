/* Sorts the sides of triangles by edges, and triangles around vertices. */
#include "core/mesh/corner_table.h"

#include "core/base/memory.h"
#include "core/geometry/triangle.h"

#include <stdlib.h>
#include <string.h>

static int compare_sides(const void *a, const void *b)
{
    const cwi_side *s = a, *t = b;
    if (s->key != t->key)
        return s->key < t->key ? -1 : 1;
    return (s->corner > t->corner) - (s->corner < t->corner);
}

void cwi_sides_sort(cwi_side *sides, size_t count)
{
    qsort(sides, count, sizeof *sides, compare_sides);
}

void cwi_sides_list(const uint32_t *corners, size_t count, cwi_side *sides)
{
    for (uint32_t c = 0; c < count; c++)
        sides[c] = (cwi_side){cwi_edge_key(corners[c], corners[cwi_corner_next(c)]), c};
    cwi_sides_sort(sides, count);
}

size_t cwi_sides_along(const cwi_side *sides, size_t count, size_t first)
{
    size_t n = 1;
    while (first + n < count && sides[first + n].key == sides[first].key)
        n++;
    return n;
}

static int compare_keys(const void *a, const void *b)
{
    const uint64_t s = *(const uint64_t *)a, t = *(const uint64_t *)b;
    return (s > t) - (s < t);
}

uint64_t *cwi_edge_keys(const uint32_t *corners, size_t count)
{
    uint64_t *keys = cwi_alloc_array(count, sizeof *keys);
    for (uint32_t c = 0; keys && c < count; c++)
        keys[c] = cwi_edge_key(corners[c], corners[cwi_corner_next(c)]);
    if (keys)
        qsort(keys, count, sizeof *keys, compare_keys);
    return keys;
}

bool cwi_edge_exists(const uint64_t *keys, size_t count, uint32_t a, uint32_t b)
{
    const uint64_t key = cwi_edge_key(a, b);
    return bsearch(&key, keys, count, sizeof key, compare_keys);
}

void cwi_fans_sort(const uint32_t *corners, size_t triangles, size_t vertices, uint32_t *first,
                   uint32_t *around)
{
    memset(first, 0, (vertices + 2) * sizeof *first);
    for (size_t c = 0; c < 3 * triangles; c++)
        first[corners[c] + 2]++;
    for (size_t v = 0; v < vertices; v++)
        first[v + 2] += first[v + 1];
    for (size_t c = 0; c < 3 * triangles; c++)
        around[first[corners[c] + 1]++] = (uint32_t)(c / 3);
}
