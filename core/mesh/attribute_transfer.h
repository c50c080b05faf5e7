/* Attributes carried from one mesh to another, by what is known of its elements or by closest points. */
#ifndef CORE_MESH_ATTRIBUTE_TRANSFER_H
#define CORE_MESH_ATTRIBUTE_TRANSFER_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Where elements come from; UINT32_MAX: not known. NULL: none are known. */
typedef struct cwi_sources {
    const uint32_t *vertices;  /* of each vertex: one of the first mesh */
    const uint32_t *triangles; /* of each triangle */
} cwi_sources;

/* Gives a mesh without attributes all that another has. A vertex of unknown source takes those of the
 * closest point, mixed from the corners there; a triangle those of the triangle closest to its middle, and
 * its corners those of the triangles closest to points beside them.
 * Both meshes have the same origin.
 * Returns  CW_ERR_NO_MEMORY, and `to` is emptied; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_carry(const cw_mesh *from, const cwi_sources *sources, int threads,
                                 const cw_progress *progress, cw_mesh *to, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
