/* Allocation of meshes, and removal of marked triangles. */
#ifndef CORE_MESH_MESH_H
#define CORE_MESH_MESH_H

#include <cubewright/labels.h>
#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Maximum of triangles, and of vertices, that algorithms number. 32 bits then number all corners of
 * triangles, and UINT32_MAX is left to mean none. */
#define CWI_MAX_TRIANGLES ((size_t)UINT32_MAX / 3)

/* Checks a mesh, and that it is not beyond that maximum. done: what is done to it, for the message
 * Returns CW_ERR_ARGUMENT as cw_mesh_check(); CW_ERR_LIMIT */
CW_NODISCARD cw_status cwi_mesh_check_size(const cw_mesh *mesh, const char *done,
                                           cw_error *err);

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

/* Adds the normal of triangle t to sums[at[0]], sums[at[1]] and sums[at[2]], with the weights of its corners. */
void cwi_add_corner_normals(const cw_mesh *mesh, size_t t, const uint32_t at[3],
                            double (*sums)[3]);

#ifdef __cplusplus
}
#endif

#endif
