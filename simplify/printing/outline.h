/* The outline of points in a plane, and how far another one is inside of it. */
#ifndef SIMPLIFY_PRINTING_OUTLINE_H
#define SIMPLIFY_PRINTING_OUTLINE_H

#include <stddef.h>

typedef struct cwi_plan_point {
    double x, y;
} cwi_plan_point;

/* Finds the corners of the convex hull, counter-clockwise. Returns their number.
 * points  count of them; they are sorted
 * hull    2 count + 2 */
size_t cwi_find_outline(cwi_plan_point *points, size_t count, cwi_plan_point *hull);

/* Returns how far a point is inside of an outline; negative: outside, or 0: there is no area. */
double cwi_outline_margin(const cwi_plan_point *hull, size_t corners,
                          const cwi_plan_point *point);

double cwi_outline_area(const cwi_plan_point *hull, size_t corners);

#endif
