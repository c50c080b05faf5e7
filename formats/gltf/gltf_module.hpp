// The interface between the two halves of the module "gltf", the only files that use tinygltf.
#ifndef FORMATS_GLTF_GLTF_MODULE_HPP
#define FORMATS_GLTF_GLTF_MODULE_HPP

#include "formats/gltf/gltf_wrap.h"

#include <tiny_gltf.h>

constexpr const char *GLTF_MESHOPT = "EXT_meshopt_compression";
constexpr const char *GLTF_LOD = "MSFT_lod";
constexpr const char *GLTF_DRACO = "KHR_draco_mesh_compression";

// Makes the JSON of a document; stored as cwi_gltf_functions.document.
CW_NODISCARD cw_status cwi_gltf_document_make(const cwi_gltf_document *document, char **json,
                                              size_t *size, cw_error *err);

#endif
