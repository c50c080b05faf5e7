/* The driver of OpenVDB, and what it calls. */
#ifndef FORMATS_VDB_VDB_FORMAT_H
#define FORMATS_VDB_VDB_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_vdb;

cwi_volume_sniffer cwi_vdb_sniff;
cwi_volume_reader cwi_vdb_read;

#endif
