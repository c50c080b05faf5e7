/* The driver of MetaImage: its names, its reader and its writer. */
#include "formats/metaimage/metaimage_format.h"

const cwi_format_driver cwi_format_metaimage = {
    .name = "metaimage",
    .extensions = ".mha .mhd",
    .about = "MetaImage volume",
    .lost = "slope and intercept",
    .volume = {.sniff = cwi_metaimage_sniff, .parse = cwi_metaimage_parse},
    .save = {.extensions = ".mha", .save = cwi_metaimage_save},
};
