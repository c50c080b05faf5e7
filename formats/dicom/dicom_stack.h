/* Stacking of the planes of a DICOM series into a volume: their order, distances and tilt. */
#ifndef FORMATS_DICOM_DICOM_STACK_H
#define FORMATS_DICOM_DICOM_STACK_H

#include "formats/dicom/dicom_series.h"
#include "formats/volume/slice_stack.h"

/* Findings about the series. */
typedef struct cwi_dicom_findings {
    double tilt_degrees; /* of the slices' row against their normal */
    char gaps[192];      /* uneven distances; empty: none */
    size_t made;         /* number of interpolated slices */
} cwi_dicom_findings;

/* Fills a zeroed stack; slices ascend along the cross product of row and column directions.
 * stack->files stays empty: its planes count in scan->files.
 * Returns CW_ERR_UNSAFE where the geometry is missing, contradicts itself or is uneven and desc
 * does not decide; CW_ERR_LIMIT, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_dicom_stack(cwi_dicom_scan *scan, size_t series,
                                       const cw_read_desc *desc, cwi_stack *stack,
                                       cwi_dicom_findings *findings, cw_error *err);

#endif
