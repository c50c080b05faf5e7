/* The driver of TIFF: its names and its reader. */
#include "formats/tiff/tiff_format.h"

const cwi_format_driver cwi_format_tiff = {
    .name = "tiff",
    .extensions = ".tif .tiff",
    .about = "TIFF stack: pages of one file, or numbered slices",
    .feature = "tiff",
    .volume = {.sniff = cwi_tiff_sniff, .read_slices = cwi_tiff_read, .holds_pages = true},
};
