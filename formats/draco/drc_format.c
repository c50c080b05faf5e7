/* The driver of Draco files: their reader, their writer, and what the format keeps. */
#include "formats/draco/drc_format.h"

const cwi_format_driver cwi_format_drc = {
    .name = "drc",
    .extensions = ".drc",
    .about = "Draco: a compressed mesh, LPS millimetres",
    .feature = "draco",
    .lost = "scalars, labels, affine; places between those of the grid",
    .keeps = CW_KEEPS_SHARING | CW_KEEPS_NORMALS | CW_KEEPS_COLORS | CW_KEEPS_OPACITY,
    .mesh = {.sniff = cwi_drc_sniff, .read = cwi_drc_read},
    .write = {.write = cwi_drc_write, .only = CW_COMPRESS_DRACO},
};
