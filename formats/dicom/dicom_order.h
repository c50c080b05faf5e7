/* Order of the planes of a DICOM series: positions along the normal, and steps at each of them. */
#ifndef FORMATS_DICOM_DICOM_ORDER_H
#define FORMATS_DICOM_DICOM_ORDER_H

#include "formats/dicom/dicom_stack.h"

/* The planes of the series while they are sorted. */
typedef struct cwi_dicom_sorting {
    cwi_dicom_plane *planes;
    size_t count;
    size_t position_count; /* number of different positions */
    size_t steps;          /* planes at each position */
    double normal[3];
    bool is_turned; /* directions are stated, not made up */
    const cw_read_desc *desc;
    cwi_dicom_findings *findings;
} cwi_dicom_sorting;

/* Finds the positions along the normal, and sorts the planes by them; those that differ by less than a
 * thousandth of a pixel are one. */
void cwi_dicom_find_positions(cwi_dicom_sorting *s);

/* Returns true where planes at one position are moments, echoes or similar of one slice, as an attribute other than
 * AcquisitionNumber tells, and where planes have several positions. Sorts as cwi_dicom_find_positions(). */
bool cwi_dicom_are_moments(cwi_dicom_sorting *s);

/* Finds the steps, and sorts the planes by position and step: the same number of planes at every position is a
 * series in time, of echoes, or similar.
 * Returns CW_ERR_UNSAFE where only some positions hold several planes */
CW_NODISCARD cw_status cwi_dicom_find_steps(cwi_dicom_sorting *s, cw_error *err);

#endif
