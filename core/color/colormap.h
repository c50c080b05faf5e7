/* The colours of maps, evenly spaced. */
#ifndef CORE_COLOR_COLORMAP_H
#define CORE_COLOR_COLORMAP_H

#include <cubewright/color.h>

/* Colours as 0xrrggbb, from low to high values. */
typedef struct cwi_colormap {
    const char *name;
    const unsigned *colors;
    size_t count;
} cwi_colormap;

/* Returns the row of a known map. */
const cwi_colormap *cwi_colormap_of(cw_colormap map);

#endif
