/* The driver of MGH, and what it calls. */
#ifndef FORMATS_MGH_MGH_FORMAT_H
#define FORMATS_MGH_MGH_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_mgh;

cwi_volume_sniffer cwi_mgh_sniff;
cwi_header_parser cwi_mgh_parse;

#endif
