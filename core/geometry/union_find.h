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

#endif
