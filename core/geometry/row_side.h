/* Exact decisions on which triangles a row along x crosses, for corners on a grid of whole numbers. No row slips
 * through between two triangles that share an edge, and none meets both. */
#ifndef CORE_GEOMETRY_ROW_SIDE_H
#define CORE_GEOMETRY_ROW_SIDE_H

#include <stdbool.h>
#include <stdint.h>

/* Returns twice the area of a, b and the row, seen along it: positive when they run
 * counter-clockwise. Points are y and z, of up to 2^30, or 2^29 on both sides of 0. */
static inline int64_t cwi_row_area(const int64_t a[2], const int64_t b[2], int64_t y, int64_t z)
{
    return (b[0] - a[0]) * (z - a[1]) - (b[1] - a[1]) * (y - a[0]);
}

/* Returns true if the row is to the left of the edge. A row that meets the edge is treated as
 * if it stood at (y + e, z + e * e), for an e that is smaller than any number. */
static inline bool cwi_row_is_left(int64_t twice_area, const int64_t a[2], const int64_t b[2])
{
    if (twice_area != 0)
        return twice_area > 0;
    return a[1] != b[1] ? a[1] > b[1] : b[0] > a[0];
}

#endif
