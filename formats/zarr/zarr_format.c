/* The driver of Zarr: its names and its reader. */
#include "formats/zarr/zarr_format.h"

const cwi_format_driver cwi_format_zarr = {
    .name = "zarr",
    .extensions = ".zarr",
    .about = "Zarr 2 and 3 and OME-Zarr: chunks in a folder, in several sizes",
    .volume = {.extensions = ".zarr .zarray .zgroup .zattrs .zmetadata zarr.json",
               .is_store = cwi_zarr_is_store,
               .read_file = cwi_zarr_read,
               .list_levels = cwi_zarr_levels},
};
