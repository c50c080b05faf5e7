/* Decoding of the compressed parts of a glTF file, Draco's and meshopt's, in a sandboxed
 * process. */
#ifndef FORMATS_GLTF_GLTF_DECOMPRESS_H
#define FORMATS_GLTF_GLTF_DECOMPRESS_H

#include "core/base/sandbox.h"
#include "formats/codec/draco_wrap.h"
#include "formats/codec/meshopt_wrap.h"
#include "formats/gltf/gltf_scene.h"

/* The process and its inputs; zeroed, it has not been started. */
typedef struct cwi_gltf_unpacker {
    const cw_mesh_read_desc *desc;
    cwi_sandbox box;
    const cwi_draco_functions *draco;     /* loaded when they are first needed, */
    const cwi_meshopt_functions *meshopt; /* before the process starts */
} cwi_gltf_unpacker;

void cwi_gltf_unpacker_close(cwi_gltf_unpacker *u);

/* Decodes a view of EXT_meshopt_compression: view->packed_count x packed_stride bytes, to be
 * freed with cwi_free(). Returns CW_ERR_FORMAT, CW_ERR_UNSUPPORTED, CW_ERR_BACKEND,
 * CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_gltf_unpack_view(cwi_gltf_unpacker *u, const cwi_gltf_view *view,
                                            const unsigned char *packed, unsigned char **bytes,
                                            cw_error *err);

/* Decodes a primitive of KHR_draco_mesh_compression, and checks its numbers of vertices and
 * corners. Returns the same errors. */
CW_NODISCARD cw_status cwi_gltf_unpack_draco(cwi_gltf_unpacker *u, const cwi_draco_ids *ids,
                                             const unsigned char *packed, size_t size,
                                             uint64_t vertices, uint64_t corners,
                                             cwi_arrays *arrays, cw_error *err);

#endif
