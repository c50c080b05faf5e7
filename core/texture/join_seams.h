/* Vertices that were split at the seams of a texture. */
#ifndef CORE_TEXTURE_JOIN_SEAMS_H
#define CORE_TEXTURE_JOIN_SEAMS_H

#include <cubewright/mesh.h>

/* Joins vertices that differ in nothing but their texture coordinates, which become those of corners. Vertices
 * that no triangle names are dropped if others are joined.
 * mesh     has texture coordinates of vertices
 * groups   vertices: only those of one group are joined
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_join_seams(cw_mesh *mesh, const uint32_t *groups, cw_error *err);

/* Gives each corner the texture coordinate of its vertex, where these are of vertices. Returns CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_texture_to_corners(cw_mesh *mesh, cw_error *err);

#endif
