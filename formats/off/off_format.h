/* The driver of OFF, and what it calls. */
#ifndef FORMATS_OFF_OFF_FORMAT_H
#define FORMATS_OFF_OFF_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_off;

cwi_mesh_sniffer cwi_off_sniff;
cwi_mesh_reader cwi_off_read;
cwi_mesh_writer cwi_off_write;

#endif
