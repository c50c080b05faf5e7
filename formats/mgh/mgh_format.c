/* The driver of MGH, FreeSurfer's volumes: its names and its reader. */
#include "formats/mgh/mgh_format.h"

const cwi_format_driver cwi_format_mgh = {
    .name = "mgh",
    .extensions = ".mgh .mgz",
    .about = "FreeSurfer volume, plain or gzipped",
    .volume = {.extensions = ".mgh .mgz .mgh.gz",
               .gzipped = true,
               .sniff = cwi_mgh_sniff,
               .parse = cwi_mgh_parse},
};
