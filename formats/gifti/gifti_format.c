/* The driver of GIfTI, the surfaces of neuroimaging: its reader, its writer, and what it keeps. */
#include "formats/gifti/gifti_format.h"

const cwi_format_driver cwi_format_gifti = {
    .name = "gifti",
    .extensions = ".surf.gii .gii",
    .about = "GIfTI surface, RAS millimetres",
    .lost = "normals, colours, scalars, labels, affine; places beyond single precision, unless "
            "local",
    .keeps = CW_KEEPS_SHARING,
    .mesh = {.sniff = cwi_gifti_sniff, .read = cwi_gifti_read},
    .write = {.write = cwi_gifti_write, .ras_mm = true, .spools = true},
};
