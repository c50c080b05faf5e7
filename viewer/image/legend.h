/* A column of colours with their names. */
#ifndef VIEWER_IMAGE_LEGEND_H
#define VIEWER_IMAGE_LEGEND_H

#include <cubewright/overlay.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Lengths are pixels. */
typedef struct cwi_legend {
    const cw_legend_item *items;
    size_t count;
    double text;        /* height of capitals */
    double right;       /* end of the longest name */
    double max_width;   /* of the column */
    double top, bottom; /* of it */
    double ink[4], halo[4];
} cwi_legend;

/* Draws the items that there is room for, and counts the others in a line. Returns the left end
 * of the column, or `right` if there is no room at all. */
double cwi_legend_draw(const cwi_legend *legend, cw_image *image);

#ifdef __cplusplus
}
#endif

#endif
