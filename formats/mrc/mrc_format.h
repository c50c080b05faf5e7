/* The driver of MRC, and what it calls. */
#ifndef FORMATS_MRC_MRC_FORMAT_H
#define FORMATS_MRC_MRC_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_mrc;

cwi_volume_sniffer cwi_mrc_sniff;
cwi_header_parser cwi_mrc_parse;

#endif
