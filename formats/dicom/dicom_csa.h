/* The CSA header that Siemens scanners put into a DICOM file: tags with names, whose items are
 * texts. Two versions of it are in use, of which the newer begins with "SV10". */
#ifndef FORMATS_DICOM_DICOM_CSA_H
#define FORMATS_DICOM_DICOM_CSA_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The first `count` items of a tag as numbers; false where there are fewer, or where the header
 * is damaged in front of them. */
bool cwi_csa_numbers(const unsigned char *header, size_t size, const char *tag, int count,
                     double *numbers);

#ifdef __cplusplus
}
#endif

#endif
