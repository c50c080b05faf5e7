/* The driver of Zarr. */
#ifndef FORMATS_ZARR_ZARR_FORMAT_H
#define FORMATS_ZARR_ZARR_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_zarr;

#endif
