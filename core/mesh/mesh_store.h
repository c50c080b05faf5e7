/* Keeps the meshes of many parts in few large arrays, which may overflow into files. */
#ifndef CORE_MESH_MESH_STORE_H
#define CORE_MESH_MESH_STORE_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Zero it, and set is_used to keep meshes in it. */
typedef struct cwi_mesh_store {
    bool is_used; /* false: meshes stay as they are */
    char **blocks;
    size_t count, capacity; /* of blocks */
    char *next;             /* place behind the last array, in the last block */
    size_t room;            /* bytes that are left there */
} cwi_mesh_store;

/* Moves a mesh to *kept, with its arrays to the store; then from is empty. On failure it is unchanged.
 * Returns CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_mesh_store_keep(cwi_mesh_store *store, cw_mesh *from, cw_mesh *kept,
                                           cw_error *err);

/* Frees a mesh that was kept, but for its arrays in the store. Harmless on a zeroed mesh. */
void cwi_mesh_store_release(const cwi_mesh_store *store, cw_mesh *kept);

/* Frees the arrays of all meshes. */
void cwi_mesh_store_free(cwi_mesh_store *store);

#ifdef __cplusplus
}
#endif

#endif
