/* Finds the outline of points in a plane: what a print stands on. */
#include "simplify/printing/outline.h"

#include "core/geometry/vec3.h"

#include <stdlib.h>

static int compare_points(const void *a, const void *b)
{
    const cwi_plan_point *p = a, *q = b;
    return p->x != q->x ? (p->x < q->x ? -1 : 1) : p->y < q->y ? -1 : p->y > q->y;
}

/* Returns twice the area to the left of a path over three points. */
static double turn_left(const cwi_plan_point *a, const cwi_plan_point *b,
                        const cwi_plan_point *c)
{
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

/* Finds the corners of the lower side, and then those of the upper one [Andrew1979]. */
size_t cwi_find_outline(cwi_plan_point *points, size_t count, cwi_plan_point *hull)
{
    size_t corners = 0;
    qsort(points, count, sizeof *points, compare_points);
    for (int side = 0; side < 2; side++) {
        const size_t min_corners = corners + 1;
        for (size_t n = 0; n < count; n++) {
            const cwi_plan_point *p = points + (side ? count - 1 - n : n);
            while (corners > min_corners &&
                   turn_left(hull + corners - 2, hull + corners - 1, p) <= 0)
                corners--;
            hull[corners++] = *p;
        }
        corners--; /* the last one begins the other side */
    }
    return corners;
}

double cwi_outline_margin(const cwi_plan_point *hull, size_t corners,
                          const cwi_plan_point *point)
{
    double margin = INFINITY;
    for (size_t n = 0; n < corners; n++) {
        const cwi_plan_point *a = hull + n, *b = hull + (n + 1) % corners;
        const double length = hypot(b->x - a->x, b->y - a->y);
        if (length > 0)
            margin = cwi_lesser(margin, turn_left(a, b, point) / length);
    }
    return isfinite(margin) ? margin : 0;
}

double cwi_outline_area(const cwi_plan_point *hull, size_t corners)
{
    double twice = 0;
    for (size_t n = 2; n < corners; n++)
        twice += turn_left(hull, hull + n - 1, hull + n);
    return twice / 2;
}
