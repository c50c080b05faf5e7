/* Exact predicates: the side of a plane or line on which a point lies. Points are in single
 * precision, so their products are exact in doubles. */
#ifndef CORE_GEOMETRY_EXACT_PREDICATES_H
#define CORE_GEOMETRY_EXACT_PREDICATES_H

#include <cubewright/core.h>

#include <float.h>
#include <math.h>

/* Returns 1 when the determinant of b - a, c - a, d - a is positive, -1 when negative, 0 when
 * the four points lie in one plane. */
int cwi_orient3d(const float a[3], const float b[3], const float c[3], const float d[3]);

/* Returns 1 when a, b, c turn counter-clockwise, -1 when clockwise, 0 when they lie on one
 * line. The axis is left out, and the other two are taken in cyclic order. */
int cwi_orient2d(const float a[3], const float b[3], const float c[3], int axis);

/* Returns an axis along which the triangle is seen with an area; -1 when its corners lie on a
 * line. */
int cwi_seen_along(const float a[3], const float b[3], const float c[3]);

/* Returns 1 when points p, q, r of a plane turn counter-clockwise, -1 when clockwise, and 0 when
 * rounding might decide, or they lie on one line. Coordinates are numbers of single precision: their
 * products cannot under- or overflow. */
static inline int cwi_sure_turn(double px, double py, double qx, double qy, double rx,
                                double ry)
{
    const double unit = DBL_EPSILON / 2, error_factor = (3 + 16 * unit) * unit;
    const double left = (px - rx) * (qy - ry), right = (py - ry) * (qx - rx),
                 value = left - right, error = error_factor * (fabs(left) + fabs(right));
    return (value > error) - (value < -error);
}

/* Returns as cwi_orient2d(), but 0 also when rounding might decide. */
static inline int cwi_sure_orient2d(const float a[3], const float b[3], const float c[3],
                                    int axis)
{
    const int x = (axis + 1) % 3, y = (axis + 2) % 3;
    return cwi_sure_turn((double)a[x], (double)a[y], (double)b[x], (double)b[y], (double)c[x],
                         (double)c[y]);
}

#endif
