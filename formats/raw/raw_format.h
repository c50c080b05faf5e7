/* The driver of voxels without a header, and what it calls. */
#ifndef FORMATS_RAW_RAW_FORMAT_H
#define FORMATS_RAW_RAW_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_raw;

/* Makes a source from a layout that the caller of the library states. */
CW_NODISCARD cw_status cwi_raw_describe(const cw_raw_layout *layout, cwi_source *src,
                                        cw_error *err);

#endif
