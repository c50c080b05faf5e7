/* Union-find: joins numbers into sets; the minimum of a set names it. */
#ifndef CORE_GEOMETRY_UNION_FIND_H
#define CORE_GEOMETRY_UNION_FIND_H

#include "core/base/memory.h"

/* Makes each number a set by itself; returns NULL when memory is out. */
static inline uint32_t *cwi_sets_alloc(size_t count)
{
    uint32_t *parent = (uint32_t *)cwi_alloc_array(count, sizeof *parent);
    for (size_t i = 0; i < count && parent; i++)
        parent[i] = (uint32_t)i;
    return parent;
}

static inline uint32_t cwi_sets_find(uint32_t *parent, uint32_t x)
{
    while (parent[x] != x)
        x = parent[x] = parent[parent[x]];
    return x;
}

static inline void cwi_sets_join(uint32_t *parent, uint32_t x, uint32_t y)
{
    x = cwi_sets_find(parent, x);
    y = cwi_sets_find(parent, y);
    parent[x > y ? x : y] = x > y ? y : x;
}

/* As cwi_sets_find(), while other threads join sets. */
static inline uint32_t cwi_sets_find_shared(uint32_t *parent, uint32_t x)
{
    uint32_t up = __atomic_load_n(&parent[x], __ATOMIC_RELAXED);
    while (up != x) {
        const uint32_t above = __atomic_load_n(&parent[up], __ATOMIC_RELAXED);
        if (above != up)
            __atomic_store_n(&parent[x], above, __ATOMIC_RELAXED);
        x = up;
        up = above;
    }
    return x;
}

/* Joins two sets while other threads join sets of the same array; returns false when they are
 * one already. A root gets a parent once, and a lower one: for any order of the joins the
 * minimum of a set names it, and as many calls return true. */
static inline bool cwi_sets_join_shared(uint32_t *parent, uint32_t x, uint32_t y)
{
    for (;;) {
        x = cwi_sets_find_shared(parent, x);
        y = cwi_sets_find_shared(parent, y);
        if (x == y)
            return false;
        const uint32_t low = x < y ? x : y, high = x < y ? y : x;
        uint32_t root = high;
        if (__atomic_compare_exchange_n(&parent[high], &root, low, false, __ATOMIC_RELAXED,
                                        __ATOMIC_RELAXED))
            return true;
    }
}

#endif
