/* Check of a DICOM file's nesting depth and number of elements, without following sequences on
 * the stack. */
#ifndef FORMATS_DICOM_DICOM_NESTING_H
#define FORMATS_DICOM_DICOM_NESTING_H

#include <cubewright/core.h>

enum { CWI_DICOM_DEEPEST = 64 };

/* Walks over the elements of a file, since DCMTK follows sequences by recursion and keeps every
 * element. Deflated data are inflated on the way. Damage is left for DCMTK to report.
 * Returns CW_ERR_FORMAT for sequences nested deeper than CWI_DICOM_DEEPEST, and for more than
 * eight million elements; CW_ERR_LIMIT for deflated ones of more than 8 GiB; CW_ERR_IO */
CW_NODISCARD cw_status cwi_dicom_check_depth(int fd, uint64_t size, cw_error *err);

#endif
