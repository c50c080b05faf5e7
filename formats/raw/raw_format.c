/* The driver of voxels without a header, which are read by a given layout. */
#include "formats/driver/format_driver.h"

const cwi_format_driver cwi_format_raw = {
    .name = "raw",
    .extensions = ".raw",
    .about = "bytes without a header, laid out as the caller says",
};
