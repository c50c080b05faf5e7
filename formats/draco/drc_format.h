/* The driver of Draco files, and what it calls. */
#ifndef FORMATS_DRACO_DRC_FORMAT_H
#define FORMATS_DRACO_DRC_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_drc;

cwi_mesh_sniffer cwi_drc_sniff;
cwi_mesh_reader cwi_drc_read;
cwi_mesh_writer cwi_drc_write;

#endif
