/* Allocation of meshes, and removal of marked triangles. */
#ifndef CORE_MESH_MESH_H
#define CORE_MESH_MESH_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Allocates uninitialised positions, triangles and, if requested, normals. */
CW_NODISCARD cw_status cwi_mesh_alloc(cw_mesh *mesh, size_t vertices, size_t triangles,
                                      bool normals, cw_error *err);

/* Does the same in the memory of the mesh's arrays; the mesh is emptied on failure. */
CW_NODISCARD cw_status cwi_mesh_renew(cw_mesh *mesh, size_t vertices, size_t triangles,
                                      bool normals, cw_error *err);

/* Copies a mesh with all its arrays; the copy is emptied on failure. */
CW_NODISCARD cw_status cwi_mesh_copy(const cw_mesh *mesh, cw_mesh *copy, cw_error *err);

/* Leaves out the triangles with a mark, and then vertices that no triangle names.
 * Returns  CW_ERR_NO_MEMORY, and the mesh is unchanged */
CW_NODISCARD cw_status cwi_mesh_drop_marked(cw_mesh *mesh, const bool *marked, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
