/* The type that holds the pixels of all files of a series. */
#ifndef FORMATS_DICOM_DICOM_PIXEL_TYPES_H
#define FORMATS_DICOM_DICOM_PIXEL_TYPES_H

#include "formats/dicom/dicom_order.h"

/* Types and padding of the files of a series. */
typedef struct cwi_dicom_pixels {
    cw_type type;                  /* holds the pixels of every file, unscaled */
    bool mixed;                    /* files differ in type or padding */
    bool same_padding;             /* no file has another padding, or none */
    bool is_long;                  /* some pixels have more than 16 bits */
    const cwi_dicom_facts *padded; /* the first file with padding, else the first */
} cwi_dicom_pixels;

/* Compares the files of all planes. Whole numbers are joined in the smallest type that holds the bits of each. */
cwi_dicom_pixels cwi_dicom_join_pixels(const cwi_dicom_sorting *s);

#endif
