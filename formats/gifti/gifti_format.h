/* The driver of GIfTI, and what it calls. */
#ifndef FORMATS_GIFTI_GIFTI_FORMAT_H
#define FORMATS_GIFTI_GIFTI_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_gifti;

cwi_mesh_sniffer cwi_gifti_sniff;
cwi_mesh_reader cwi_gifti_read;
cwi_mesh_writer cwi_gifti_write;

#endif
