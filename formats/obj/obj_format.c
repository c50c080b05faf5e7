/* The driver of Wavefront OBJ: its reader, its writer, and what the format keeps. */
#include "formats/obj/obj_format.h"

const cwi_format_driver cwi_format_obj = {
    .name = "obj",
    .extensions = ".obj",
    .about = "Wavefront OBJ, LPS millimetres",
    .lost = "scalars, labels, affine; the opacity of vertices",
    .keeps = CW_KEEPS_SHARING | CW_KEEPS_NORMALS | CW_KEEPS_COLORS | CW_KEEPS_PARTS |
             CW_KEEPS_FACE_COLORS | CW_KEEPS_TEXTURE | CW_KEEPS_PICTURES | CW_KEEPS_CREASES,
    .mesh = {.read = cwi_obj_read},
    .write = {.write = cwi_obj_write, .spools = true, .text = true},
};
