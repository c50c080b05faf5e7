/* The drivers of PNG and BMP, and what they call. */
#ifndef FORMATS_PICTURE_PICTURE_FORMAT_H
#define FORMATS_PICTURE_PICTURE_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_png;
extern const cwi_format_driver cwi_format_bmp;

cwi_volume_sniffer cwi_png_sniff;
cwi_volume_sniffer cwi_bmp_sniff;
cwi_slices_reader cwi_png_read;
cwi_slices_reader cwi_bmp_read;

#endif
