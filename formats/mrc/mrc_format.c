/* The driver of MRC and CCP4: its names and its reader. */
#include "formats/mrc/mrc_format.h"

const cwi_format_driver cwi_format_mrc = {
    .name = "mrc",
    .extensions = ".mrc .map .ccp4 .rec",
    .about = "MRC2014 or CCP4 map, plain or gzipped",
    .volume = {.extensions = ".mrc .map .ccp4 .rec .mrc.gz .map.gz",
               .gzipped = true,
               .sniff = cwi_mrc_sniff,
               .parse = cwi_mrc_parse},
};
