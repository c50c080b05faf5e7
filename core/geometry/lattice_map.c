/* Numbers the places of a lattice in a hash table with open addressing, keyed by packed
 * coordinates. */
#include "core/geometry/lattice_map.h"

#include "core/base/memory.h"

static size_t slot_of(uint64_t key, size_t slots)
{
    uint64_t h = key * UINT64_C(0x9E3779B97F4A7C15);
    h = (h ^ (h >> 32)) * UINT64_C(0xBF58476D1CE4E5B9);
    return (size_t)(h ^ (h >> 31)) & (slots - 1);
}

void cwi_lattice_free(cwi_lattice_map *p)
{
    cwi_free(p->keys);
    cwi_free(p->table);
    *p = (cwi_lattice_map){0};
}

uint32_t cwi_lattice_find(const cwi_lattice_map *p, uint64_t key)
{
    if (!p->slots)
        return CWI_NO_LATTICE_POINT;
    for (size_t s = slot_of(key, p->slots); p->table[s]; s = (s + 1) & (p->slots - 1))
        if (p->keys[p->table[s] - 1] == key)
            return p->table[s] - 1;
    return CWI_NO_LATTICE_POINT;
}

static void enter_slot(cwi_lattice_map *p, uint32_t n)
{
    size_t s = slot_of(p->keys[n], p->slots);
    while (p->table[s])
        s = (s + 1) & (p->slots - 1);
    p->table[s] = n + 1;
}

static bool grow_table(cwi_lattice_map *p)
{
    const size_t capacity = p->capacity ? 2 * p->capacity : 256;
    uint64_t *keys = cwi_realloc_array(p->keys, capacity, sizeof *keys);
    p->keys = keys ? keys : p->keys;
    uint32_t *table = keys && capacity < CWI_NO_LATTICE_POINT
                          ? cwi_alloc_zeroed(2 * capacity, sizeof *table)
                          : NULL;
    if (!table)
        return false;
    cwi_free(p->table);
    p->table = table;
    p->slots = 2 * capacity;
    p->capacity = capacity;
    for (uint32_t n = 0; n < p->count; n++)
        enter_slot(p, n);
    return true;
}

uint32_t cwi_lattice_add(cwi_lattice_map *p, uint64_t key)
{
    const uint32_t known = cwi_lattice_find(p, key);
    if (known != CWI_NO_LATTICE_POINT)
        return known;
    if (p->count == p->capacity && !grow_table(p))
        return CWI_NO_LATTICE_POINT;
    p->keys[p->count] = key;
    enter_slot(p, (uint32_t)p->count);
    return (uint32_t)p->count++;
}
