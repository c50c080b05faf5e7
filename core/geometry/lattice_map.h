/* Places of a lattice, numbered in the order in which they were first added. */
#ifndef CORE_GEOMETRY_LATTICE_MAP_H
#define CORE_GEOMETRY_LATTICE_MAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CWI_NO_PLACE UINT32_MAX

/* The table of places. Zeroed: empty. */
typedef struct cwi_places {
    uint64_t *keys; /* three numbers of 21 bits, as cwi_place_key() packs them */
    size_t count, room;
    uint32_t *table; /* of `slots`, a power of two: number of a place + 1 */
    size_t slots;
} cwi_places;

enum { CWI_PLACE_MAX = 1 << 21 };

void cwi_places_free(cwi_places *places);

/* Returns the number of a place; CWI_NO_PLACE if it is not in the table. */
uint32_t cwi_places_find(const cwi_places *places, uint64_t key);

/* Returns the number of a place, adding it if needed; CWI_NO_PLACE: no memory. */
uint32_t cwi_places_add(cwi_places *places, uint64_t key);

static inline uint64_t cwi_place_key(const uint32_t at[3])
{
    return at[0] | (uint64_t)at[1] << 21 | (uint64_t)at[2] << 42;
}

static inline void cwi_place_of_key(uint64_t key, uint32_t at[3])
{
    for (int a = 0; a < 3; a++)
        at[a] = (uint32_t)(key >> 21 * a) & (CWI_PLACE_MAX - 1);
}

#endif
