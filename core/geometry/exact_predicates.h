/* Exact predicates: the side of a plane or line on which a point lies. Points are in single
 * precision, so their products are exact in doubles. */
#ifndef CORE_GEOMETRY_EXACT_PREDICATES_H
#define CORE_GEOMETRY_EXACT_PREDICATES_H

#include <cubewright/core.h>

/* Returns 1 when the determinant of b - a, c - a, d - a is positive, -1 when negative, 0 when
 * the four points lie in one plane. */
int cwi_orient3d(const float a[3], const float b[3], const float c[3], const float d[3]);

/* Returns 1 when a, b, c turn counter-clockwise, -1 when clockwise, 0 when they lie on one
 * line. The axis is left out, and the other two are taken in cyclic order. */
int cwi_orient2d(const float a[3], const float b[3], const float c[3], int axis);

/* Returns an axis along which the triangle is seen with an area; -1 when its corners lie on a
 * line. */
int cwi_seen_along(const float a[3], const float b[3], const float c[3]);

#endif
