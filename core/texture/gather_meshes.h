/* Several meshes as one, for a texture that they share. */
#ifndef CORE_TEXTURE_GATHER_MESHES_H
#define CORE_TEXTURE_GATHER_MESHES_H

#include <cubewright/mesh.h>

/* Joins meshes one after the other, with nothing but places, triangles, and what is asked for.
 * meshes   count of them, borrowed; all have what is asked for
 * scales   count: of places, about the origin of each mesh; NULL: 1
 * normals  with normals
 * texture  with texture coordinates; with normals, too, vertices are split at seams and creases
 * all      filled on success, emptied on failure; free it with cw_mesh_free()
 * Returns  CW_ERR_NO_MEMORY, CW_ERR_LIMIT */
CW_NODISCARD cw_status cwi_gather_meshes(const cw_mesh *const *meshes, const double *scales,
                                         size_t count, bool normals, bool texture, cw_mesh *all,
                                         cw_error *err);

#endif
