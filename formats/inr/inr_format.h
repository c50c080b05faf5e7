/* The driver of INR, and what it calls. */
#ifndef FORMATS_INR_INR_FORMAT_H
#define FORMATS_INR_INR_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_inr;

cwi_volume_sniffer cwi_inr_sniff;
cwi_header_parser cwi_inr_parse;

#endif
