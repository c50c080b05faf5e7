/* Directions spread evenly over a half sphere, for gradients that are quantised. A
 * gradient is along a direction or opposite to it, which looks the same if both sides are lit. */
#ifndef VIEWER_PROXY_QUANTIZED_NORMALS_H
#define VIEWER_PROXY_QUANTIZED_NORMALS_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_MAX_DIRECTIONS = 8192 };

/* A spherical Fibonacci lattice: direction n is at height z = 1 - (n + 1/2) / count, each a
 * golden angle further around than the last. No line is farther from one of them than
 * 2.2 / sqrt(count) radians, for 16 or more. */
typedef struct cwi_directions {
    size_t count;
    double (*all)[3]; /* unit length, z > 0 */
    /* Candidates for the nearest direction, for cells of an octahedron's map
     * [Engelhardt2008]. */
    size_t edge;     /* cells along a side of the map */
    uint32_t *first; /* candidate of each cell, row by row, and the end */
    uint16_t *candidates;
} cwi_directions;

/* count: 1 to CWI_MAX_DIRECTIONS. CW_ERR_ARGUMENT, CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_directions_make(size_t count, cwi_directions *directions,
                                           cw_error *err);
void cwi_directions_free(cwi_directions *directions);

/* Returns the direction with the smallest angle to a line through the origin along v, of any
 * length; `count` when v is 0 or not finite. */
size_t cwi_directions_nearest(const cwi_directions *directions, const double v[3]);

#ifdef __cplusplus
}
#endif

#endif
