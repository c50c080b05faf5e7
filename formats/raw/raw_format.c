/* The driver of voxels without a header, which are read by a given layout. */
#include "formats/raw/raw_format.h"

const cwi_format_driver cwi_format_raw = {
    .name = "raw",
    .extensions = ".raw",
    .about = "bytes without a header, laid out as the caller says",
};
