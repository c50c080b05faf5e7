/* Proof that two triangles do not cross, and the point of a triangle nearest to the origin. */
#ifndef CORE_GEOMETRY_TRIANGLE_SEPARATION_H
#define CORE_GEOMETRY_TRIANGLE_SEPARATION_H

#include <stdbool.h>

/* Distance in voxels beyond which triangles without a common corner are apart. Closer triangles
 * may collide when positions are rounded. */
#define CWI_APART (1.0 / 4096)

typedef struct cwi_triangle {
    double p[3][3]; /* in voxels */
} cwi_triangle;

/* Returns true when two triangles have nothing in common but their shared corners; false also
 * when it is too close to call. Shared corners come first in both: 0, 1 or 2 of them, in the
 * same order. */
bool cwi_triangles_apart(const cwi_triangle *s, const cwi_triangle *t, int shared);

/* Finds the point of a triangle that is nearest to the origin, if it is nearer than the given
 * one. */
void cwi_nearest_of_triangle(const cwi_triangle *t, double nearest[3]);

#endif
