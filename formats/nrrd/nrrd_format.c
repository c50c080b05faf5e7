/* The driver of NRRD: its names, its reader and its writer. */
#include "formats/nrrd/nrrd_format.h"

const cwi_format_driver cwi_format_nrrd = {
    .name = "nrrd",
    .extensions = ".nrrd .nhdr",
    .about = "NRRD volume, in one file or with its data beside it",
    .keeps = CW_KEEPS_LABELS,
    .volume = {.sniff = cwi_nrrd_sniff, .parse = cwi_nrrd_parse},
    .save = {.extensions = ".nrrd", .save = cwi_nrrd_save},
};
