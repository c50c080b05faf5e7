/* The driver of INRIMAGE-4: its names and its reader. */
#include "formats/inr/inr_format.h"

const cwi_format_driver cwi_format_inr = {
    .name = "inr",
    .extensions = ".inr .inr.gz",
    .about = "INRIMAGE-4 volume, plain or gzipped",
    .volume = {.gzipped = true, .sniff = cwi_inr_sniff, .parse = cwi_inr_parse},
};
