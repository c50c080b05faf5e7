/* The driver of MetaImage, and what it calls. */
#ifndef FORMATS_METAIMAGE_METAIMAGE_FORMAT_H
#define FORMATS_METAIMAGE_METAIMAGE_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_metaimage;

cwi_volume_sniffer cwi_metaimage_sniff;
cwi_header_parser cwi_metaimage_parse;
cwi_volume_saver cwi_metaimage_save;

#endif
