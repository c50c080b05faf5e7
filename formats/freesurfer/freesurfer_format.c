/* The driver of FreeSurfer's surfaces: its reader, its writer, and what it keeps. Most of them have no
 * extension: content tells them, and `--format` writes them. */
#include "formats/freesurfer/freesurfer_format.h"

const cwi_format_driver cwi_format_freesurfer = {
    .name = "freesurfer",
    .extensions = ".white .pial .sphere",
    .about = "FreeSurfer surface, as lh.white, RAS millimetres",
    .lost = "normals, colours, scalars, labels, affine; places beyond single precision, unless "
            "local",
    .keeps = CW_KEEPS_SHARING,
    .mesh = {.sniff = cwi_freesurfer_sniff, .read = cwi_freesurfer_read},
    .write = {.write = cwi_freesurfer_write, .ras_mm = true, .spools = true},
};
