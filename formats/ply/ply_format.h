/* The driver of PLY, and what it calls. */
#ifndef FORMATS_PLY_PLY_FORMAT_H
#define FORMATS_PLY_PLY_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_ply;

cwi_mesh_sniffer cwi_ply_sniff;
cwi_mesh_reader cwi_ply_read;
cwi_mesh_writer cwi_ply_write;

#endif
