/* The driver of Zarr, and what it calls. */
#ifndef FORMATS_ZARR_ZARR_FORMAT_H
#define FORMATS_ZARR_ZARR_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_zarr;

/* Recognise, read and list the levels of a store: its folder, or a metadata file in it. */
bool cwi_zarr_is_store(const cwi_input *folder);
cwi_volume_reader cwi_zarr_read;
cwi_level_lister cwi_zarr_levels;

#endif
