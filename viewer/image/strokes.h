/* Draws lines and letters on images, antialiased. A pixel's coverage by a stroke is how far its
 * middle is inside the stroke's outline, from 0 half a pixel outside to 1 half a pixel inside.
 * Coordinates are pixels from the upper left corner; the first pixel's middle is (0.5, 0.5). */
#ifndef VIEWER_IMAGE_STROKES_H
#define VIEWER_IMAGE_STROKES_H

#include "core/font/stroke_font.h"

#include <cubewright/picture.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_pen {
    cw_image *image;
    double width;    /* of strokes */
    double color[4]; /* sRGB and opacity */
} cwi_pen;

/* Draws strokes as one figure: where several meet, the pixel is covered once. */
void cwi_pen_draw(const cwi_pen *pen, const cwi_stroke *strokes, size_t count);

/* The same for many short strokes: its time is in proportion to their number and to the pixels, not
 * to the product of both. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_pen_draw_many(const cwi_pen *pen, const cwi_stroke *strokes,
                                         size_t count, cw_error *err);

/* Fills a rectangle; partly covered pixels are blended. */
void cwi_pen_fill(const cwi_pen *pen, double left, double top, double right, double bottom);

/* Draws UTF-8 text, with capitals of a height, from a point of the baseline on; and returns its
 * width. Characters that the font does not have become a box. */
void cwi_pen_text(const cwi_pen *pen, double x, double y, double height, const char *text);
/* Writes a text in a colour, on a halo that separates it from any picture. anchor: 0: x is its
 * left end; 0.5: its middle; 1: its right end */
void cwi_text_write(cw_image *image, const double at[2], double height, double anchor,
                    const double color[4], const double halo[4], const char *text);
double cwi_text_width(double height, const char *text);

#ifdef __cplusplus
}
#endif

#endif
