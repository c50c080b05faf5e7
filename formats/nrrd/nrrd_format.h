/* The driver of NRRD, and what it calls. */
#ifndef FORMATS_NRRD_NRRD_FORMAT_H
#define FORMATS_NRRD_NRRD_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_nrrd;

cwi_volume_sniffer cwi_nrrd_sniff;
cwi_header_parser cwi_nrrd_parse;
cwi_volume_saver cwi_nrrd_save;

#endif
