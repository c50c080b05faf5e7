/* The driver of PLY: its reader, its writer, and what the format keeps. */
#include "formats/ply/ply_format.h"

const cwi_format_driver cwi_format_ply = {
    .name = "ply",
    .extensions = ".ply",
    .about = "PLY, binary or text, LPS millimetres",
    .lost = "affine; places beyond single precision, unless local",
    .keeps = CW_KEEPS_SHARING | CW_KEEPS_NORMALS | CW_KEEPS_COLORS | CW_KEEPS_OPACITY |
             CW_KEEPS_SCALARS | CW_KEEPS_LABELS | CW_KEEPS_FACE_COLORS,
    .mesh = {.sniff = cwi_ply_sniff, .read = cwi_ply_read},
    .write =
        {.write = cwi_ply_write, .spools = true, .shares = true, .text = true, .sides = true},
};
