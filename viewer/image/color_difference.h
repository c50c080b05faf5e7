/* Differences of colours. */
#ifndef VIEWER_IMAGE_COLOR_DIFFERENCE_H
#define VIEWER_IMAGE_COLOR_DIFFERENCE_H

#include <cubewright/picture.h>

#ifdef __cplusplus
extern "C" {
#endif

/* CIELAB of an sRGB colour (0 to 1), relative to its own white, D65. */
void cwi_lab_of(const double srgb[3], double lab[3]);

/* CIEDE2000 with all factors 1 [Sharma2005]. */
double cwi_delta_e(const double a[3], const double b[3]);

#ifdef __cplusplus
}
#endif

#endif
