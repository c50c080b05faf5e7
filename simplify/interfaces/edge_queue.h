/* A queue of edges by cost, the cheapest first; equal ones in the order of their numbers. */
#ifndef SIMPLIFY_INTERFACES_EDGE_QUEUE_H
#define SIMPLIFY_INTERFACES_EDGE_QUEUE_H

#include "core/base/memory.h"

#include <string.h>

/* A heap with four children a node. An entry has the bits of the cost in its upper half: costs
 * are not negative, so their bits are in order, too. Each edge is in the queue at most once. */
typedef struct cwi_edge_queue {
    uint64_t *entries;
    bool *is_queued; /* one an edge */
    size_t count;
} cwi_edge_queue;

/* Makes an empty queue for edges with numbers below `edges`. Returns false when memory is out;
 * free it with cwi_edge_queue_free(). */
static inline bool cwi_edge_queue_init(cwi_edge_queue *q, size_t edges)
{
    q->count = 0;
    q->entries = cwi_alloc_array(edges, sizeof *q->entries);
    q->is_queued = cwi_alloc_zeroed(edges, sizeof *q->is_queued);
    return q->entries && q->is_queued;
}

static inline void cwi_edge_queue_free(cwi_edge_queue *q)
{
    cwi_free(q->entries);
    cwi_free(q->is_queued);
    memset(q, 0, sizeof *q);
}

static inline uint64_t cwi_edge_queue_entry(float cost, uint32_t edge)
{
    uint32_t bits;
    memcpy(&bits, &cost, sizeof bits);
    return (uint64_t)bits << 32 | edge;
}

/* Puts an entry at the first place, and moves it down to its own. */
static inline void cwi_edge_queue_sink(cwi_edge_queue *q, uint64_t entry)
{
    size_t at = 0;
    for (size_t child = 1; child < q->count; child = 4 * at + 1) {
        size_t smallest = child;
        for (size_t n = child + 1; n < child + 4 && n < q->count; n++)
            smallest = q->entries[n] < q->entries[smallest] ? n : smallest;
        if (entry <= q->entries[smallest])
            break;
        q->entries[at] = q->entries[smallest];
        at = smallest;
    }
    q->entries[at] = entry;
}

/* Adds an edge that is not in the queue. */
static inline void cwi_edge_queue_push(cwi_edge_queue *q, float cost, uint32_t edge)
{
    const uint64_t entry = cwi_edge_queue_entry(cost, edge);
    size_t at = q->count++;
    for (; at > 0 && entry < q->entries[(at - 1) / 4]; at = (at - 1) / 4)
        q->entries[at] = q->entries[(at - 1) / 4];
    q->entries[at] = entry;
    q->is_queued[edge] = true;
}

/* Takes the first edge out. */
static inline void cwi_edge_queue_pop(cwi_edge_queue *q)
{
    q->is_queued[(uint32_t)q->entries[0]] = false;
    if (--q->count > 0)
        cwi_edge_queue_sink(q, q->entries[q->count]);
}

#endif
