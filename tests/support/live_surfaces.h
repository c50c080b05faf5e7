/* Surfaces that OpenGL's compute shaders extract, beside cw_extract()'s. */
#ifndef SUPPORT_LIVE_SURFACES_H
#define SUPPORT_LIVE_SURFACES_H

#include "support/support.h"

#include "viewer/gl/gl.h"

/* Opens the module of OpenGL, once. Skips the test where the build or the machine has none, or one
 * without compute shaders. */
const cwi_gl_functions *live_functions(cwi_gl **gl);
int live_close(void **state);

/* Differences between two meshes of the same triangles. */
typedef struct live_difference {
    size_t positions, normals; /* of vertices that are not the same to the bit */
    double normal;             /* the largest difference of a component of normals */
} live_difference;

/* Compares meshes whose vertices and triangles may be in another order. Fails unless both have
 * the same counts and the same triangles, which begin at any corner. */
live_difference live_compare(const cw_mesh *gpu, const cw_mesh *cpu);

/* Extracts by both, compares, and fails beyond a difference of normals; positions are the same to
 * the bit. Returns the triangles. */
size_t live_check(const cw_volume *volume, double isovalue, bool inside_is_low, double normal,
                  live_difference *sum);

#endif
