/* Copies the closed meshes of many labels out of the interfaces, one after the other. */
#ifndef EXTRACT_PIPELINE_LABEL_COPIER_H
#define EXTRACT_PIPELINE_LABEL_COPIER_H

#include <cubewright/labels.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_label_copier {
    const cw_label_surfaces *surfaces; /* borrowed */
    size_t *firsts;    /* label_count + 1: where a label's part of `patches` begins */
    uint32_t *patches; /* of labels, rising */
    uint32_t *numbers; /* of vertices in the mesh that is made, plus 1; 0: none */
    uint32_t *met;     /* the vertices that have one */
    size_t capacity;   /* of those */
} cwi_label_copier;

/* Returns false when memory is out; free it either way. */
CW_NODISCARD bool cwi_label_copier_init(cwi_label_copier *copier,
                                        const cw_label_surfaces *surfaces);
void cwi_label_copier_free(cwi_label_copier *copier);

/* Copies the mesh of a label as cw_label_mesh() does, to the bit.
 * n        number of the label among those of the surfaces
 * mesh     filled on success, emptied on failure; free it with cw_mesh_free()
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_label_copier_copy(cwi_label_copier *copier, size_t n, cw_mesh *mesh,
                                             cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
