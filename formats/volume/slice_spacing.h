/* Slices along an axis: check of equal distances, and interpolation of missing slices. */
#ifndef FORMATS_VOLUME_SLICE_SPACING_H
#define FORMATS_VOLUME_SLICE_SPACING_H

#include <cubewright/formats.h>

/* The sources of one slice of the result: (1 - t) low + t high. */
typedef struct cwi_slice {
    size_t low, high;
    double t; /* 0: low unchanged */
} cwi_slice;

/* Slices at equal distances. A zeroed one is empty. */
typedef struct cwi_slices {
    size_t count;
    double step; /* in the unit of the positions */
    cwi_slice *items;
    size_t made;       /* number of items that are interpolated */
    char finding[192]; /* uneven distances, for people; empty: none */
} cwi_slices;

/* Lays out slices that stand at ascending positions.
 *
 * They count as even when none is off by more than a twentieth of the step. Where some are
 * missing from an even row, CW_GAPS_INTERPOLATE interpolates those. Where distances vary, the
 * smallest distance decides the number of slices. The first and the last slice stay, and there
 * are no more than eight slices for a usual distance.
 *
 * unit     of positions, for messages
 * Returns  CW_ERR_UNSAFE where they are uneven and gaps says to stop; CW_ERR_LIMIT for more
 *          than 65,536 slices; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_slices_lay(const double *positions, size_t count, const char *unit,
                                      cw_gaps gaps, cwi_slices *slices, cw_error *err);
void cwi_slices_free(cwi_slices *slices);

#endif
