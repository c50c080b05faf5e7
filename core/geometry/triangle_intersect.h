/* Test for two triangles of a mesh that intersect. */
#ifndef CORE_GEOMETRY_TRIANGLE_INTERSECT_H
#define CORE_GEOMETRY_TRIANGLE_INTERSECT_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Returns true if a triangle's corners are not on a line. Exact.
 * points  vertices x 3        v  three indices of vertices */
bool cwi_has_area(const float *points, const uint32_t v[3]);

/* Returns true if two triangles with an area share a point beyond their common vertices and
 * edges. Common vertices are those with the same index. Touching counts; so does lying on each
 * other, even with all three vertices the same. Exact.
 * points  vertices x 3        a, b  three indices of vertices each */
bool cwi_triangles_meet(const float *points, const uint32_t a[3], const uint32_t b[3]);

#ifdef __cplusplus
}
#endif

#endif
