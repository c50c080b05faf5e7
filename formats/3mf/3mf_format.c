/* The driver of 3MF: its reader, its writer, and what the format keeps. */
#include "formats/3mf/3mf_format.h"

const cwi_format_driver cwi_format_3mf = {
    .name = "3mf",
    .extensions = ".3mf",
    .about = "3MF for printing: objects with colours, LPS millimetres",
    .lost = "normals, scalars, labels, affine",
    .keeps = CW_KEEPS_SHARING | CW_KEEPS_PLACES | CW_KEEPS_COLORS | CW_KEEPS_OPACITY |
             CW_KEEPS_PARTS | CW_KEEPS_FACE_COLORS,
    .mesh = {.sniff = cwi_3mf_sniff, .read = cwi_3mf_read},
    .write = {.write = cwi_3mf_write, .one_coloring = true, .spools = true},
};
