/* The driver of 3MF, and what it calls. */
#ifndef FORMATS_3MF_3MF_FORMAT_H
#define FORMATS_3MF_3MF_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_3mf;

cwi_mesh_sniffer cwi_3mf_sniff;
cwi_mesh_reader cwi_3mf_read;
cwi_mesh_writer cwi_3mf_write;

#endif
