/* Names and colours of the segments of a DICOM segmentation. */
#ifndef FORMATS_DICOM_DICOM_SEGMENTS_H
#define FORMATS_DICOM_DICOM_SEGMENTS_H

#include "formats/dicom/dicom_series.h"

#include <cubewright/label_table.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Adds the segments of a series' files to a table. layer_of: of each number, CWI_DICOM_SEGMENTS.
 * Returns CW_ERR_BACKEND for texts without an end; CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_dicom_add_segments(const cwi_dicom_scan *scan, size_t series,
                                              const uint8_t *layer_of, cw_label_table *table,
                                              cw_error *err);

/* Converts a colour of CIELab with the white D50, in 16 bits as DICOM stores it, to sRGB: L is v /
 * 65535 x 100, a and b are v / 65535 x 255 - 128. */
void cwi_dicom_lab_to_srgb(const uint16_t lab[3], uint8_t srgb[3]);

#ifdef __cplusplus
}
#endif

#endif
