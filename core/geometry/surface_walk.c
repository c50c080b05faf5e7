/* Sorts the triangles of a surface around its vertices. */
#include "core/geometry/surface_walk.h"

#include <string.h>

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
