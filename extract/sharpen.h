/* Edges and corners that samples of a distance cannot tell. */
#ifndef EXTRACT_SHARPEN_H
#define EXTRACT_SHARPEN_H

#include <cubewright/level_set.h>

/* Gives a surface at a distance from a mesh the edges and corners back that a level set's
 * voxels have cut off: sides of triangles across an edge get a vertex on it, triangles across a
 * corner one in it. What it has keeps its place, what would fold, flatten or cross is left as
 * it is.
 *
 * mesh     at desc->offset_mm from `from`, closed, oriented and free of crossings, with nothing
 * but positions, triangles and normals; vertices and triangles are added voxel_mm of the level
 * set Returns  CW_ERR_NO_MEMORY, CW_ERR_CANCELLED, as cw_self_intersections(); the mesh is
 * whole then Threads  the same to the bit for any number Source   after the extended marching
 * cubes [Kobbelt2001] and [Attene2005]; tangent planes are those of the mesh that is offset,
 * not of samples */
cw_status cwi_sharpen(const cw_mesh *from, const cw_offset_desc *desc, double voxel_mm,
                      cw_mesh *mesh, cw_error *err);

#endif
