/* A hash table with open addressing. */
#include "core/volume/key_counts.h"

#include "core/base/memory.h"

enum { FIRST_SIZE = 64 };

static size_t find_place(const cwi_key_counts *t, uint64_t key)
{
    uint64_t hash = key * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 32;
    size_t n = (size_t)hash & (t->size - 1);
    while (t->entries[n].key != 0 && t->entries[n].key != key)
        n = (n + 1) & (t->size - 1);
    return n;
}

static bool grow(cwi_key_counts *t)
{
    cwi_key_counts larger = {.size = t->size ? 2 * t->size : FIRST_SIZE, .used = t->used};
    larger.entries = cwi_alloc_zeroed(larger.size, sizeof *larger.entries);
    if (!larger.entries)
        return false;
    for (size_t n = 0; n < t->size; n++)
        if (t->entries[n].key != 0)
            larger.entries[find_place(&larger, t->entries[n].key)] = t->entries[n];
    cwi_free(t->entries);
    *t = larger;
    return true;
}

cwi_key_count *cwi_key_counts_need(cwi_key_counts *t, uint64_t key)
{
    if (2 * (t->used + 1) > t->size && !grow(t))
        return NULL;
    cwi_key_count *entry = &t->entries[find_place(t, key)];
    t->used += entry->key == 0;
    entry->key = key;
    return entry;
}

const cwi_key_count *cwi_key_counts_find(const cwi_key_counts *t, uint64_t key)
{
    const cwi_key_count *entry = t->size > 0 ? &t->entries[find_place(t, key)] : NULL;
    return entry && entry->key == key ? entry : NULL;
}

bool cwi_key_counts_has(const cwi_key_counts *t, uint64_t key)
{
    return cwi_key_counts_find(t, key) != NULL;
}

void cwi_key_counts_free(cwi_key_counts *t)
{
    cwi_free(t->entries);
    *t = (cwi_key_counts){0};
}
