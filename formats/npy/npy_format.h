/* The driver of NumPy's files, and what it calls. */
#ifndef FORMATS_NPY_NPY_FORMAT_H
#define FORMATS_NPY_NPY_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_npy;

cwi_volume_sniffer cwi_npy_sniff;
cwi_header_parser cwi_npy_parse;

#endif
