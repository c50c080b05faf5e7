/* The drivers of glTF, binary and text, and what they call. */
#ifndef FORMATS_GLTF_GLTF_FORMATS_H
#define FORMATS_GLTF_GLTF_FORMATS_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_glb, cwi_format_gltf;

cwi_mesh_sniffer cwi_glb_sniff, cwi_gltf_sniff;
cwi_mesh_reader cwi_glb_read, cwi_gltf_read;
cwi_mesh_writer cwi_glb_write, cwi_gltf_write;

/* Loads the module that both writers need. Returns CW_ERR_UNSUPPORTED if it is not in this build. */
CW_NODISCARD cw_status cwi_gltf_prepare(cw_error *err);

/* Loads the module of the requested codec, before there is anything to compress.
 * Returns CW_ERR_ARGUMENT for bits that it does not support; CW_ERR_UNSUPPORTED. */
CW_NODISCARD cw_status cwi_gltf_prepare_codec(const cw_write_desc *desc, cw_error *err);

/* Counts the vertices that colours of triangles add to a file, where they become those of vertices. */
cwi_split_counter cwi_gltf_count_split;

#endif
