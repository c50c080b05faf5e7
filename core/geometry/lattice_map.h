/* Places of a lattice, numbered in the order in which they were first added. */
#ifndef CORE_GEOMETRY_LATTICE_MAP_H
#define CORE_GEOMETRY_LATTICE_MAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CWI_NO_LATTICE_POINT UINT32_MAX

/* The table of places. Zeroed: empty. */
typedef struct cwi_lattice_map {
    uint64_t *keys; /* three numbers of 21 bits, as cwi_lattice_key() packs them */
    size_t count, capacity;
    uint32_t *table; /* of `slots`, a power of two: number of a place + 1 */
    size_t slots;
} cwi_lattice_map;

enum { CWI_LATTICE_MAX = 1 << 21 };

void cwi_lattice_free(cwi_lattice_map *map);

/* Returns the number of a place; CWI_NO_LATTICE_POINT if it is not in the table. */
uint32_t cwi_lattice_find(const cwi_lattice_map *map, uint64_t key);

/* Returns the number of a place, adding it if needed; CWI_NO_LATTICE_POINT: no memory. */
uint32_t cwi_lattice_add(cwi_lattice_map *map, uint64_t key);

static inline uint64_t cwi_lattice_key(const uint32_t at[3])
{
    return at[0] | (uint64_t)at[1] << 21 | (uint64_t)at[2] << 42;
}

static inline void cwi_lattice_point(uint64_t key, uint32_t at[3])
{
    for (int a = 0; a < 3; a++)
        at[a] = (uint32_t)(key >> 21 * a) & (CWI_LATTICE_MAX - 1);
}

#endif
