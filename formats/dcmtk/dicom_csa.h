/* Reading of the CSA header that Siemens scanners put into a DICOM file. It has named tags,
 * whose items are texts. Two versions are in use; the newer one begins with "SV10". */
#ifndef FORMATS_DCMTK_DICOM_CSA_H
#define FORMATS_DCMTK_DICOM_CSA_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reads the first `count` items of a tag as numbers. Returns false where there are fewer, or
 * where the header is damaged before them. */
bool cwi_csa_numbers(const unsigned char *header, size_t size, const char *tag, int count,
                     double *numbers);

#ifdef __cplusplus
}
#endif

#endif
