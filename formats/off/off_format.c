/* The driver of OFF: its reader, its writer, and what the format keeps. */
#include "formats/off/off_format.h"

const cwi_format_driver cwi_format_off = {
    .name = "off",
    .extensions = ".off",
    .about = "Object File Format as text, LPS millimetres",
    .lost = "scalars, labels, affine",
    .keeps = CW_KEEPS_SHARING | CW_KEEPS_NORMALS | CW_KEEPS_COLORS | CW_KEEPS_OPACITY |
             CW_KEEPS_FACE_COLORS,
    .mesh = {.sniff = cwi_off_sniff, .read = cwi_off_read},
    .write = {.write = cwi_off_write, .spools = true, .text = true},
};
