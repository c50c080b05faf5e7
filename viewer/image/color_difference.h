/* Computes differences of colours. */
#ifndef VIEWER_IMAGE_COLOR_DIFFERENCE_H
#define VIEWER_IMAGE_COLOR_DIFFERENCE_H

#include <cubewright/picture.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Converts an sRGB colour (0 to 1) to CIELAB, relative to its own white, D65. */
void cwi_lab_of(const double srgb[3], double lab[3]);

/* Returns the difference by CIEDE2000, with all factors 1 [Sharma2005]. */
double cwi_delta_e(const double a[3], const double b[3]);

#ifdef __cplusplus
}
#endif

#endif
