/* Restores edges and corners that samples of a distance cannot represent. */
#ifndef EXTRACT_LEVEL_SET_SHARP_EDGES_H
#define EXTRACT_LEVEL_SET_SHARP_EDGES_H

#include <cubewright/level_set.h>

/* Restores the edges and corners of a surface at a distance from a mesh, which a level set's
 * voxels have cut off. Sides of triangles across an edge get a vertex on it, and triangles
 * across a corner get one at it. Vertices beside these, which are off the surface, are moved
 * onto it. Triangles that would fold, flatten or cross stay unchanged.
 *
 * mesh      at desc->offset_mm from `from`, with its origin, closed, oriented, free of
 *           crossings; it has positions, triangles and normals alone. Vertices and triangles
 *           are added
 * voxel_mm  of the level set
 * Returns   CW_ERR_NO_MEMORY, CW_ERR_CANCELLED, as cw_self_intersections(): the mesh is then
 *           as it was
 * Threads   the same to the bit for any number
 * Source    after [Kobbelt2001] and [Attene2005]; planes are the offset mesh's, not
 * of samples */
CW_NODISCARD cw_status cwi_sharpen(const cw_mesh *from, const cw_offset_desc *desc,
                                   double voxel_mm, cw_mesh *mesh, cw_error *err);

#endif
