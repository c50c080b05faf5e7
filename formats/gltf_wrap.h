/* tinygltf behind plain C: the functions of the module "gltf". */
#ifndef FORMATS_GLTF_WRAP_H
#define FORMATS_GLTF_WRAP_H

#include "formats/mesh_writers.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_gltf_functions {
    /* Writes the mesh as one node of one scene: GLB, or JSON with its buffer embedded.
     * Returns CW_ERR_LIMIT when the buffer cannot be addressed with 32 bits. */
    cw_status (*write)(const cw_mesh *mesh, cwi_mesh_output *out, bool binary, cw_error *err);
} cwi_gltf_functions;

extern CW_API const cwi_gltf_functions cwi_module_gltf;

#ifdef __cplusplus
}
#endif

#endif
