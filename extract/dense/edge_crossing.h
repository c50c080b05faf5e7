/* Computes where a grid edge is crossed. */
#ifndef EXTRACT_DENSE_EDGE_CROSSING_H
#define EXTRACT_DENSE_EDGE_CROSSING_H

#include <math.h>
#include <stdbool.h>

/* The fraction of an edge that vertices keep from its ends. Three vertices around one sample
 * then never coincide, even after rounding to single precision. */
#define CWI_NUDGE (1.0 / 1024)

static inline double cwi_off_ends(double t)
{
    t = t > CWI_NUDGE ? t : CWI_NUDGE; /* NaN, too: halves of the smallest doubles are 0 */
    return t > 1 - CWI_NUDGE ? 1 - CWI_NUDGE : t;
}

/* Returns the fraction of the edge from number a to number b at which the level is crossed,
 * kept off both ends. NaN is an end without a value: the crossing is then a cap, just beyond
 * the other end. */
static inline double cwi_edge_crossing(double a, double b, double level)
{
    if (isnan(a) || isnan(b))
        return isnan(a) ? 1 - CWI_NUDGE : CWI_NUDGE;
    /* halves, so that the difference of two huge doubles is finite */
    double t = (level * 0.5 - a * 0.5) / (b * 0.5 - a * 0.5);
    if (isinf(a) || isinf(b))
        t = isinf(a) && isinf(b) ? 0.5 : isinf(b) ? 0 : 1;
    return cwi_off_ends(t);
}

#endif
