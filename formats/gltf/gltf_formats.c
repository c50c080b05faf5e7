/* The drivers of glTF, binary and as text: their readers, their writers, and what they keep. */
#include "formats/gltf/gltf_formats.h"

const cwi_format_driver cwi_format_glb = {
    .name = "glb",
    .extensions = ".glb",
    .about = "binary glTF 2.0 scene, metres, +Y up, facing +Z",
    .feature = "gltf",
    .lost = "scalars, labels",
    .keeps = CW_KEEPS_SHARING | CW_KEEPS_PLACES | CW_KEEPS_NORMALS | CW_KEEPS_COLORS |
             CW_KEEPS_OPACITY | CW_KEEPS_PARTS | CW_KEEPS_AFFINE | CW_KEEPS_FACE_COLORS |
             CW_KEEPS_TEXTURE | CW_KEEPS_PICTURES | CW_KEEPS_MATERIALS | CW_KEEPS_CREASES,
    .mesh = {.sniff = cwi_glb_sniff, .read = cwi_glb_read},
    .write = {.write = cwi_glb_write,
              .spools = true,
              .shares = true,
              .prepare = cwi_gltf_prepare,
              .own_axes = true,
              .compresses = true,
              .one_coloring = true,
              .count_split = cwi_gltf_count_split,
              .levels = true,
              .animates = true},
};

const cwi_format_driver cwi_format_gltf = {
    .name = "gltf",
    .extensions = ".gltf",
    .about = "glTF 2.0 scene as text, metres, +Y up, facing +Z",
    .feature = "gltf",
    .lost = "scalars, labels",
    .keeps = CW_KEEPS_SHARING | CW_KEEPS_PLACES | CW_KEEPS_NORMALS | CW_KEEPS_COLORS |
             CW_KEEPS_OPACITY | CW_KEEPS_PARTS | CW_KEEPS_AFFINE | CW_KEEPS_FACE_COLORS |
             CW_KEEPS_TEXTURE | CW_KEEPS_PICTURES | CW_KEEPS_MATERIALS | CW_KEEPS_CREASES,
    .mesh = {.sniff = cwi_gltf_sniff, .read = cwi_gltf_read},
    .write = {.write = cwi_gltf_write,
              .spools = true,
              .prepare = cwi_gltf_prepare,
              .own_axes = true,
              .compresses = true,
              .one_coloring = true,
              .count_split = cwi_gltf_count_split,
              .levels = true,
              .animates = true,
              .text = true},
};
