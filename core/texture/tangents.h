/* Tangents of textured surfaces, for normal maps. */
#ifndef CORE_TEXTURE_TANGENTS_H
#define CORE_TEXTURE_TANGENTS_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Computes a tangent for each vertex: where the first texture coordinate grows, at a right angle to the
 * normal, of length 1; the fourth number is 1 or -1, and cross(normal, tangent) times it is where the image
 * goes up. Tangents of triangles count by their angles at the vertex. Vertices without any have a
 * tangent at a right angle to the normal.
 * mesh      has normals, and texture coordinates of vertices
 * tangents  vertices x 4, set
 * Returns   CW_ERR_NO_MEMORY
 * Source    the definition of [Mikkelsen2008], for vertices that are split at seams */
CW_NODISCARD cw_status cwi_tangents(const cw_mesh *mesh, float (*tangents)[4], cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
