/* Whether two triangles are known not to cross, and how far one is from a point. */
#ifndef CORE_GEOMETRY_TRIANGLE_SEPARATION_H
#define CORE_GEOMETRY_TRIANGLE_SEPARATION_H

#include <stdbool.h>

/* Triangles without a common corner are apart when this far from each other, in voxels; what
 * is less far may fall together when positions are rounded. */
#define CWI_APART (1.0 / 4096)

typedef struct cwi_triangle {
    double p[3][3]; /* in voxels */
} cwi_triangle;

/* True when two triangles have nothing in common but the corners that they share; false also
 * when it is too close to call. Shared corners come first in both: 0, 1 or 2 of them, in the
 * same order. */
bool cwi_triangles_apart(const cwi_triangle *s, const cwi_triangle *t, int shared);

/* The point of a triangle that is nearest to the origin, if it is nearer than this one. */
void cwi_nearest_of_triangle(const cwi_triangle *t, double nearest[3]);

#endif
