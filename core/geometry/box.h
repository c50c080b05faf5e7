/* Boxes along the axes: a lower and an upper corner. Without a point, the lower is above the upper. */
#ifndef CORE_GEOMETRY_BOX_H
#define CORE_GEOMETRY_BOX_H

#include <math.h>
#include <stddef.h>

static inline void cwi_box_clear(double low[3], double high[3])
{
    for (int a = 0; a < 3; a++) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
    }
}

/* Widens a box by a point. Coordinates that are not numbers change nothing. */
static inline void cwi_box_add(double low[3], double high[3], const double p[3])
{
    for (int a = 0; a < 3; a++) {
        low[a] = p[a] < low[a] ? p[a] : low[a];
        high[a] = p[a] > high[a] ? p[a] : high[a];
    }
}

/* Widens a box by another one, which may be empty. */
static inline void cwi_box_join(double low[3], double high[3], const double other_low[3],
                                const double other_high[3])
{
    for (int a = 0; a < 3; a++) {
        low[a] = other_low[a] < low[a] ? other_low[a] : low[a];
        high[a] = other_high[a] > high[a] ? other_high[a] : high[a];
    }
}

/* Widens a box by positions of a mesh. points: count x 3 */
static inline void cwi_box_add_points(double low[3], double high[3], const float *points,
                                      size_t count)
{
    for (size_t a = 0; a < 3; a++) {
        float min = INFINITY, max = -INFINITY;
        for (size_t n = a; n < 3 * count; n += 3) {
            min = points[n] < min ? points[n] : min;
            max = points[n] > max ? points[n] : max;
        }
        low[a] = (double)min < low[a] ? (double)min : low[a];
        high[a] = (double)max > high[a] ? (double)max : high[a];
    }
}

static inline double cwi_box_diagonal(const double low[3], const double high[3])
{
    return hypot(hypot(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
}

#endif
