/* Triangles of three points: normals, the middle, rays, and the order of corners. Corners of all
 * triangles of a mesh are numbered: corner c is corner c % 3 of triangle c / 3. */
#ifndef CORE_GEOMETRY_TRIANGLE_H
#define CORE_GEOMETRY_TRIANGLE_H

#include "core/geometry/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/* Returns true if a triangle names a vertex twice. v: its three vertices */
static inline bool cwi_triangle_is_collapsed(const uint32_t *v)
{
    return v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
}

/* Computes (b - a) x (c - a): along the normal, and as long as twice the area. */
static inline void cwi_triangle_normal(const double a[3], const double b[3], const double c[3],
                                       double normal[3])
{
    double u[3], v[3];
    cwi_sub(b, a, u);
    cwi_sub(c, a, v);
    cwi_cross(u, v, normal);
}

static inline double cwi_triangle_area(const double a[3], const double b[3], const double c[3])
{
    double normal[3];
    cwi_triangle_normal(a, b, c, normal);
    return cwi_length(normal) / 2;
}

static inline void cwi_triangle_centroid(const double a[3], const double b[3],
                                         const double c[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (a[k] + b[k] + c[k]) / 3;
}

/* Computes the same vector for positions of a mesh, which are floats. */
static inline void cwi_facet_normal(const float a[3], const float b[3], const float c[3],
                                    double normal[3])
{
    double u[3], v[3];
    cwi_sub_points(b, a, u);
    cwi_sub_points(c, a, v);
    cwi_cross(u, v, normal);
}

/* Returns six times the volume of a tetrahedron: the determinant of a - o, b - o and c - o. */
static inline double cwi_tetrahedron_sixfold(const double o[3], const double a[3],
                                             const double b[3], const double c[3])
{
    double normal[3], w[3];
    cwi_triangle_normal(o, a, b, normal);
    cwi_sub(c, o, w);
    return cwi_dot(normal, w);
}

/* Returns the next corner of the same triangle, or the one before it. */
static inline uint32_t cwi_corner_next(uint32_t corner)
{
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

static inline uint32_t cwi_corner_prev(uint32_t corner)
{
    return corner % 3 == 0 ? corner + 2 : corner - 1;
}

/* Exact decisions on which triangles a row along x crosses, for corners on a grid of whole numbers. No row slips
 * through between two triangles that share an edge, and none meets both. */

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

/* Returns the fraction of a vector after which a ray meets a triangle, from either side, or INFINITY;
 * below 0: behind its start.
 * Source  [Moeller1997] */
static inline double cwi_triangle_ray(const double p[3][3], const double from[3],
                                      const double vector[3])
{
    double sides[2][3], across[3], to[3], around[3];
    cwi_sub(p[1], p[0], sides[0]);
    cwi_sub(p[2], p[0], sides[1]);
    cwi_cross(vector, sides[1], across);
    const double det = cwi_dot(sides[0], across);
    if (det == 0)
        return INFINITY;
    cwi_sub(from, p[0], to);
    const double u = cwi_dot(to, across) / det;
    cwi_cross(to, sides[0], around);
    const double v = cwi_dot(vector, around) / det;
    const bool is_inside = u >= 0 && v >= 0 && u + v <= 1;
    return is_inside ? cwi_dot(sides[1], around) / det : INFINITY;
}

#endif
