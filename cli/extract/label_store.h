/* Keeps the meshes of many labels in few large arrays, which may overflow into files. */
#ifndef CLI_EXTRACT_LABEL_STORE_H
#define CLI_EXTRACT_LABEL_STORE_H

#include <cubewright/mesh.h>

/* Zero it, and set is_used to keep meshes in it. */
typedef struct cli_label_store {
    bool is_used; /* false: meshes stay as they are */
    char **blocks;
    size_t count, capacity; /* of blocks */
    char *next;             /* place behind the last array, in the last block */
    size_t room;            /* bytes that are left there */
} cli_label_store;

/* Moves a mesh to *kept, with its arrays to the store; then from is empty. On failure it is unchanged.
 * Returns CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_label_store_keep(cli_label_store *store, cw_mesh *from,
                                            cw_mesh *kept, cw_error *err);

/* Frees a mesh that was kept, but for its arrays in the store. Harmless on a zeroed mesh. */
void cli_label_store_release(const cli_label_store *store, cw_mesh *kept);

/* Frees the arrays of all meshes. */
void cli_label_store_free(cli_label_store *store);

#endif
