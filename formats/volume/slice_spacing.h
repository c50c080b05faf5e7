/* Slices along an axis: whether they stand at equal distances, and what to do where not. */
#ifndef FORMATS_VOLUME_SLICE_SPACING_H
#define FORMATS_VOLUME_SLICE_SPACING_H

#include <cubewright/formats.h>

/* Where one slice of the result comes from: (1 - t) low + t high. */
typedef struct cwi_slice {
    size_t low, high;
    double t; /* 0: low as it is */
} cwi_slice;

/* Slices at equal distances. A zeroed one is empty. */
typedef struct cwi_slices {
    size_t count;
    double step; /* in the unit of the places */
    cwi_slice *items;
    size_t made;       /* of the items, between two slices */
    char finding[192]; /* what is uneven, for people; empty where nothing is */
} cwi_slices;

/* Lays out slices that stand at ascending places.
 *
 * They count as even when none is off by more than a twentieth of the step. Where some are
 * missing from an even row, CW_GAPS_INTERPOLATE makes those; where distances vary, it lays out
 * as many slices as the smallest distance asks for, the first and the last where they were, but
 * no more than eight for a usual distance.
 *
 * unit     of places, for messages
 * Returns  CW_ERR_UNSAFE where they are uneven and gaps says to stop; CW_ERR_LIMIT for more
 *          than 65,536 slices; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_slices_lay(const double *places, size_t count, const char *unit,
                                      cw_gaps gaps, cwi_slices *slices, cw_error *err);
void cwi_slices_free(cwi_slices *slices);

#endif
