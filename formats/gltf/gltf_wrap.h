/* The interface of the module "gltf": plain C functions around tinygltf. */
#ifndef FORMATS_GLTF_GLTF_WRAP_H
#define FORMATS_GLTF_GLTF_WRAP_H

#include "formats/gltf/gltf_document.h"
#include "formats/gltf/gltf_scene.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_gltf_functions {
    /* Makes the JSON of a file, without its buffers; it is freed with cwi_free(). */
    cw_status (*document)(const cwi_gltf_document *document, char **json, size_t *size,
                          cw_error *err);

    /* Fills a zeroed scene from JSON that cwi_gltf_blind() has sanitized; reads no buffer. The
     * caller frees the scene in any case.
     * Returns CW_ERR_FORMAT for JSON that is broken or not glTF, CW_ERR_UNSUPPORTED, with its
     * name, for an extension that the file requires. */
    cw_status (*parse)(const char *json, size_t size, cwi_gltf_scene *scene, cw_error *err);
} cwi_gltf_functions;

/* Makes the JSON by the module's document(), in a process of its own, since tinygltf ends it
 * when memory runs out. Returns CW_ERR_UNSUPPORTED without the module; CW_ERR_NO_MEMORY when
 * that process died. */
CW_NODISCARD cw_status cwi_gltf_make_json(const cwi_gltf_document *document, char **json,
                                          size_t *size, cw_error *err);

/* Parses by the module's parse(), in a sandboxed process unless desc->no_sandbox.
 * Returns CW_ERR_UNSUPPORTED without the module; CW_ERR_BACKEND when that process died. */
CW_NODISCARD cw_status cwi_gltf_parse(const char *json, size_t size,
                                      const cw_mesh_read_desc *desc, cwi_gltf_scene *scene,
                                      cw_error *err);

/* Loads the module. Returns CW_ERR_UNSUPPORTED if it is not in this build. */
CW_NODISCARD cw_status cwi_gltf_functions_load(const cwi_gltf_functions **functions,
                                               cw_error *err);

extern CW_API const cwi_gltf_functions cwi_module_gltf;

#ifdef __cplusplus
}
#endif

#endif
