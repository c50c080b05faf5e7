/* Do two triangles of a mesh meet where they should not? */
#ifndef CORE_GEOMETRY_TRIANGLE_INTERSECT_H
#define CORE_GEOMETRY_TRIANGLE_INTERSECT_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Whether a triangle's corners are not on a line. Exact.
 * points  vertices x 3        v  three numbers of vertices */
bool cwi_has_area(const float *points, const uint32_t v[3]);

/* Whether two triangles with an area have a point in common other than what they share as
 * neighbours: a vertex or an edge with the same numbers. Touching counts; so does lying on each
 * other, with all three vertices the same too. Exact.
 * points  vertices x 3        a, b  three numbers of vertices each */
bool cwi_triangles_meet(const float *points, const uint32_t a[3], const uint32_t b[3]);

#ifdef __cplusplus
}
#endif

#endif
