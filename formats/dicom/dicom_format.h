/* The driver of DICOM, and what it calls. */
#ifndef FORMATS_DICOM_DICOM_FORMAT_H
#define FORMATS_DICOM_DICOM_FORMAT_H

#include "formats/driver/format_driver.h"

extern const cwi_format_driver cwi_format_dicom;

cwi_volume_sniffer cwi_dicom_sniff;
cwi_slices_reader cwi_dicom_read;
cwi_series_lister cwi_dicom_list;

#endif
