/* The driver of STL: its reader, its writer, and what the format keeps. */
#include "formats/stl/stl_format.h"

const cwi_format_driver cwi_format_stl = {
    .name = "stl",
    .extensions = ".stl",
    .about = "STL, binary or text, LPS millimetres",
    .lost =
        "shared vertices, normals, colours but 5 bits of those of faces, scalars, labels, affine; "
        "places beyond single precision, unless local; as text all colours",
    .keeps = CW_KEEPS_FACE_COLORS,
    .mesh = {.sniff = cwi_stl_sniff, .sniffs_last = true, .read = cwi_stl_read},
    .write = {.write = cwi_stl_write,
              .spools = true,
              .shares = true,
              .text = true,
              .text_lacks = CW_KEEPS_FACE_COLORS,
              .color_bits = 5},
};
