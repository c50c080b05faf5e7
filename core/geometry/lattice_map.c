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

void cwi_places_free(cwi_places *p)
{
    cwi_free(p->keys);
    cwi_free(p->table);
    *p = (cwi_places){0};
}

uint32_t cwi_places_find(const cwi_places *p, uint64_t key)
{
    if (!p->slots)
        return CWI_NO_PLACE;
    for (size_t s = slot_of(key, p->slots); p->table[s]; s = (s + 1) & (p->slots - 1))
        if (p->keys[p->table[s] - 1] == key)
            return p->table[s] - 1;
    return CWI_NO_PLACE;
}

static void enter_slot(cwi_places *p, uint32_t n)
{
    size_t s = slot_of(p->keys[n], p->slots);
    while (p->table[s])
        s = (s + 1) & (p->slots - 1);
    p->table[s] = n + 1;
}

static bool grow_table(cwi_places *p)
{
    const size_t room = p->room ? 2 * p->room : 256;
    uint64_t *keys = cwi_realloc_array(p->keys, room, sizeof *keys);
    p->keys = keys ? keys : p->keys;
    uint32_t *table =
        keys && room < CWI_NO_PLACE ? cwi_alloc_zeroed(2 * room, sizeof *table) : NULL;
    if (!table)
        return false;
    cwi_free(p->table);
    p->table = table;
    p->slots = 2 * room;
    p->room = room;
    for (uint32_t n = 0; n < p->count; n++)
        enter_slot(p, n);
    return true;
}

uint32_t cwi_places_add(cwi_places *p, uint64_t key)
{
    const uint32_t known = cwi_places_find(p, key);
    if (known != CWI_NO_PLACE)
        return known;
    if (p->count == p->room && !grow_table(p))
        return CWI_NO_PLACE;
    p->keys[p->count] = key;
    enter_slot(p, (uint32_t)p->count);
    return (uint32_t)p->count++;
}
