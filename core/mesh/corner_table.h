/* Sides, twins and fans of indexed triangles. Corner c is corner c % 3 of triangle c / 3; side c runs
 * from it to the next corner of its triangle. */
#ifndef CORE_MESH_CORNER_TABLE_H
#define CORE_MESH_CORNER_TABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define CWI_NO_CORNER UINT32_MAX /* the twin of a side at an open edge */

/* A side: the edge that it lies along, and the corner where it begins. */
typedef struct cwi_side {
    uint64_t key; /* see cwi_edge_key() */
    uint32_t corner;
} cwi_side;

/* Makes the key of an edge: the lower vertex, then the higher one. */
static inline uint64_t cwi_edge_key(uint32_t a, uint32_t b)
{
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/* Sorts sides by edges, then by corners. */
void cwi_sides_sort(cwi_side *sides, size_t count);

/* Lists all sides of triangles, and sorts them. sides: one for each corner, set */
void cwi_sides_list(const uint32_t *corners, size_t count, cwi_side *sides);

/* Counts the sides from `first` on that lie along the same edge. */
size_t cwi_sides_along(const cwi_side *sides, size_t count, size_t first);

static inline void cwi_twins_join(uint32_t *twin, uint32_t a, uint32_t b)
{
    twin[a] = b;
    twin[b] = a;
}

/* Returns the sorted keys of the edges of all sides, to look up edges; NULL when memory is out. */
uint64_t *cwi_edge_keys(const uint32_t *corners, size_t count);
bool cwi_edge_exists(const uint64_t *keys, size_t count, uint32_t a, uint32_t b);

/* Sorts the triangles around vertices: those around v are around[first[v]] up to, without it,
 * around[first[v + 1]].
 * first   vertices + 2, set: one more than is needed then
 * around  3 x triangles, set */
void cwi_fans_sort(const uint32_t *corners, size_t triangles, size_t vertices, uint32_t *first,
                   uint32_t *around);

#ifdef __cplusplus
}
#endif

#endif
