/* The driver of NIfTI, and what it calls. */
#ifndef FORMATS_NIFTI_NIFTI_FORMAT_H
#define FORMATS_NIFTI_NIFTI_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_nifti;

cwi_volume_sniffer cwi_nifti_sniff;
cwi_header_parser cwi_nifti_parse;
cwi_volume_saver cwi_nifti_save;

#endif
