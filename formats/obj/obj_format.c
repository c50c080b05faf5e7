/* The driver of Wavefront OBJ: its reader, its writer, and what the format keeps. */
#include "formats/obj/obj_format.h"

const cwi_format_driver cwi_format_obj = {
    .name = "obj",
    .extensions = ".obj",
    .about = "Wavefront OBJ, LPS millimetres",
    .lost = "colours, scalars, labels, affine",
    .keeps = CW_KEEPS_SHARING | CW_KEEPS_NORMALS | CW_KEEPS_PARTS,
    .mesh = {.read = cwi_obj_read},
    .write = {.write = cwi_obj_write, .spools = true, .text = true},
};
