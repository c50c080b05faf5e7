/* Places of planes that state a number instead of a position. */
#ifndef FORMATS_DICOM_DICOM_PLACES_H
#define FORMATS_DICOM_DICOM_PLACES_H

#include "formats/dicom/dicom_order.h"

/* Computes the positions of planes that are numbered, by SpacingBetweenSlices or by the spacing that the caller
 * states. With that spacing, planes without a position, or all with the same one, follow each other in the order
 * of their numbers. A position and directions that are stated stay.
 * Returns CW_ERR_UNSAFE where the order of planes is not known; what else is missing is left for the checks of
 * the geometry */
CW_NODISCARD cw_status cwi_dicom_place(cwi_dicom_sorting *s, cw_error *err);

#endif
