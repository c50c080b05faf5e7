/* Triangles filed under ranges of neighbouring vertices. */
#ifndef SIMPLIFY_QUALITY_VERTEX_RANGES_H
#define SIMPLIFY_QUALITY_VERTEX_RANGES_H

#include <cubewright/core.h>

/* Vertices of a range: the corners around them fit into a second-level cache. */
enum { CWI_RANGE_VERTICES = 4096 };

/* The triangles around the vertices of each range, in rising order. A triangle is in the ranges
 * of all its corners. A zeroed struct is valid and empty. */
typedef struct cwi_vertex_ranges {
    size_t count;
    uint32_t *begin;    /* first of each range in `triangle`; count + 1 */
    uint32_t *triangle; /* numbers */
} cwi_vertex_ranges;

/* Files the triangles of the vertices from begin to end, in time proportional to them for any
 * order.
 * triangles  count x 3 vertices; count is at most 2^32 / 3
 * Returns false when memory is out. */
bool cwi_vertex_ranges_init(cwi_vertex_ranges *ranges, const uint32_t *triangles, size_t count,
                            uint32_t begin, uint32_t end, int threads);
void cwi_vertex_ranges_free(cwi_vertex_ranges *ranges);

#endif
