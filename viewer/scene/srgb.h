/* Converts between sRGB and linear light, both from 0 to 1: IEC 61966-2-1. */
#ifndef VIEWER_SCENE_SRGB_H
#define VIEWER_SCENE_SRGB_H

#include <math.h>

static inline double cwi_srgb_to_linear(double srgb)
{
    return srgb <= 0.04045 ? srgb / 12.92 : pow((srgb + 0.055) / 1.055, 2.4);
}

/* Converts, and clamps to the displayable range. */
static inline double cwi_linear_to_srgb(double linear)
{
    const double c = fmin(fmax(linear, 0), 1);
    return c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1 / 2.4) - 0.055;
}

#endif
