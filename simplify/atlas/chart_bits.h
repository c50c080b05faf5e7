/* Bitmaps of charts and of the square that they are packed into. */
#ifndef SIMPLIFY_ATLAS_CHART_BITS_H
#define SIMPLIFY_ATLAS_CHART_BITS_H

#include "simplify/atlas/pack_charts.h"

/* Texels from first to last of a row. */
typedef struct cwi_texel_run {
    uint32_t row, first, last;
} cwi_texel_run;

/* The texels of a chart as runs, row by row from the lowest. */
typedef struct cwi_chart_bits {
    uint32_t width, height;
    double least[2]; /* turned and scaled points minus this lie in the bitmap */
    size_t run_count, run_room;
    cwi_texel_run *runs;
    size_t word_room; /* of the bitmaps that runs are made from */
    uint64_t *words, *inner;
} cwi_chart_bits;

/* Finds the texels that a chart touches, at a scale and in a direction. The bitmap may be used again.
 * widen  texels by which it is larger on each side
 * Returns false when memory is out */
bool cwi_chart_bits_make(cwi_chart_bits *bits, const cwi_chart *chart, double density,
                         const double turn[2], uint32_t widen);
void cwi_chart_bits_free(cwi_chart_bits *bits);

#endif
