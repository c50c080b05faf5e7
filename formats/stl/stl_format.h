/* The driver of STL, and what it calls. */
#ifndef FORMATS_STL_STL_FORMAT_H
#define FORMATS_STL_STL_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_stl;

cwi_mesh_sniffer cwi_stl_sniff;
cwi_mesh_reader cwi_stl_read;
cwi_mesh_writer cwi_stl_write;

#endif
