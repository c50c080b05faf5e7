/* Shades four points at once, in single precision; as cwi_lighting_shade(). */
#ifndef VIEWER_CPU_LIGHTING_LANES_H
#define VIEWER_CPU_LIGHTING_LANES_H

#include "viewer/rays/lanes.h"
#include "viewer/scene/lighting.h"

#ifdef __cplusplus
extern "C" {
#endif

/* t: distances along the ray; gradient: in eye space, of a length in units of `unit`. */
void cwi_lighting_shade_lanes(const cwi_lighting *lighting, cwi_lanes t,
                              const cwi_lanes gradient[3], cwi_lanes length, float unit,
                              cwi_lanes shadow, cwi_lanes color[3]);

#ifdef __cplusplus
}
#endif

#endif
