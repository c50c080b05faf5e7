/* Where a grid edge is crossed. */
#ifndef EXTRACT_CROSSING_H
#define EXTRACT_CROSSING_H

#include <math.h>
#include <stdbool.h>

/* Vertices keep this share of an edge between them and its ends: three vertices around one
 * sample then never coincide, also after rounding to single precision. */
#define CWI_NUDGE (1.0 / 1024)

static inline double cwi_off_ends(double t)
{
    t = t > CWI_NUDGE ? t : CWI_NUDGE; /* NaN, too: halves of the smallest doubles are 0 */
    return t > 1 - CWI_NUDGE ? 1 - CWI_NUDGE : t;
}

/* The share of the edge from number a to number b at which the level is crossed, kept off both
 * ends. NaN is an end without a value: the crossing is then a cap, just beyond the other end.
 */
static inline double cwi_crossing(double a, double b, double level)
{
    if (isnan(a) || isnan(b))
        return isnan(a) ? 1 - CWI_NUDGE : CWI_NUDGE;
    /* halves, so that the difference of two huge doubles is finite */
    double t = (level * 0.5 - a * 0.5) / (b * 0.5 - a * 0.5);
    if (isinf(a) || isinf(b))
        t = isinf(a) && isinf(b) ? 0.5 : isinf(b) ? 0 : 1;
    return cwi_off_ends(t);
}

/* The weights of four samples at -1, 0, 1 and 2 in the value, or the slope, at t of the cubic
 * through them. */
static inline void cwi_cubic_weights(double t, double w[4])
{
    w[0] = -t * (t - 1) * (t - 2) / 6;
    w[1] = (t + 1) * (t - 1) * (t - 2) / 2;
    w[2] = -(t + 1) * t * (t - 2) / 2;
    w[3] = (t + 1) * t * (t - 1) / 6;
}

static inline void cwi_cubic_slopes(double t, double w[4])
{
    w[0] = -(3 * t * t - 6 * t + 2) / 6;
    w[1] = (3 * t * t - 4 * t - 1) / 2;
    w[2] = -(3 * t * t - 2 * t - 2) / 2;
    w[3] = (3 * t * t - 1) / 6;
}

/* Where the cubic through numbers at -1, 0, 1 and 2 crosses the level between 0 and 1. False
 * where one is not finite, or it may cross more than once: as its Bezier points then change
 * sides more than once. Newton's steps, within a bracket that halves where they leave it. */
static inline bool cwi_cubic_crossing(const double x[4], double level, double *crossing)
{
    double f[4]; /* eighths, so that no sum of finite numbers overflows */
    for (int n = 0; n < 4; n++)
        f[n] = x[n] * 0.125 - level * 0.125;
    const double slope0 = (6 * f[2] - f[3] - 2 * f[0] - 3 * f[1]) / 6;
    const double slope1 = (f[0] + 3 * f[2] + 2 * f[3] - 6 * f[1]) / 6;
    const double toward = f[2] > f[1] ? 1 : -1;
    const double b1 = toward * (f[1] + slope0 / 3), b2 = toward * (f[2] - slope1 / 3);
    if (!isfinite(f[0] + f[1] + f[2] + f[3]) || f[1] == f[2] || (b1 > 0 && b2 < 0))
        return false;
    const double square = (f[0] + f[2]) / 2 - f[1], cube = f[2] - f[1] - slope0 - square;
    double low = 0, high = 1, t = f[1] / (f[1] - f[2]);
    for (int n = 0; n < 12; n++) {
        const double value = f[1] + t * (slope0 + t * (square + t * cube));
        const double slope = slope0 + t * (2 * square + t * 3 * cube);
        if (toward * value <= 0)
            low = t;
        else
            high = t;
        double next = t - value / slope;
        if (!(next >= low && next <= high))
            next = (low + high) / 2;
        const double step = next - t;
        t = next;
        if (fabs(step) < 1e-12)
            break;
    }
    *crossing = cwi_off_ends(t);
    return true;
}

#endif
