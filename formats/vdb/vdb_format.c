/* The driver of OpenVDB: its names and its reader. */
#include "formats/vdb/vdb_format.h"

const cwi_format_driver cwi_format_vdb = {
    .name = "vdb",
    .extensions = ".vdb",
    .about = "OpenVDB level set or fog volume, sparse",
    .feature = "vdb",
    .volume = {.sniff = cwi_vdb_sniff, .read_file = cwi_vdb_read, .tells_arrays = true},
};
