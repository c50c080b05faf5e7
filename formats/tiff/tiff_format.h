/* The driver of TIFF, and what it calls. */
#ifndef FORMATS_TIFF_TIFF_FORMAT_H
#define FORMATS_TIFF_TIFF_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_tiff;

cwi_volume_sniffer cwi_tiff_sniff;
cwi_slices_reader cwi_tiff_read;

#endif
