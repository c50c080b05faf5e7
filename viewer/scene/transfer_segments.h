/* An exact transfer function: linear pieces between breakpoints. */
#ifndef VIEWER_SCENE_TRANSFER_SEGMENTS_H
#define VIEWER_SCENE_TRANSFER_SEGMENTS_H

#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    /* points of colours and opacities, and where the opacity reaches its most between two */
    CWI_KNOTS = 3 * CW_TRANSFER_POINTS,
    CWI_PIECES = 3 * (CWI_KNOTS + 1) /* a cubic meets a value three times at most */
};

/* A piece between two breakpoints: color = color[] + (value - origin) color_slope[]; the same
 * holds for opacity. */
typedef struct cwi_linear {
    double low, high; /* the breakpoints; infinite beyond the ends */
    double origin, color[3], color_slope[3], opacity, opacity_slope;
    bool is_visible; /* somewhere in it */
} cwi_linear;

typedef struct cwi_knots {
    size_t count;
    double at[CWI_KNOTS];             /* rising */
    cwi_linear linear[CWI_KNOTS + 1]; /* linear[n] is below at[n] */
} cwi_knots;

void cwi_knots_make(const cw_transfer *transfer, cwi_knots *knots);

/* Returns the number of breakpoints at a value or below. */
size_t cwi_knots_below(const cwi_knots *knots, double value);

/* Returns true if any value of a range is not fully transparent. */
bool cwi_knots_is_visible(const cwi_knots *knots, double low, double high);

/* A part of a cubic, x from 0 to 1, whose values are all between the same breakpoints. */
typedef struct cwi_transfer_segment {
    double from, to;
    const cwi_linear *linear;
} cwi_transfer_segment;

/* Cuts a cubic where it meets breakpoints and where it turns. Returns the number of pieces, at
 * most CWI_PIECES. */
size_t cwi_knots_cut(const cwi_knots *knots, const double c[4], cwi_transfer_segment *pieces);

#ifdef __cplusplus
}
#endif

#endif
