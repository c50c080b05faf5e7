/* Finds where grid edges are crossed by the cubics through four samples along them. */
#ifndef EXTRACT_DENSE_CUBIC_CROSSING_H
#define EXTRACT_DENSE_CUBIC_CROSSING_H

#include "extract/dense/edge_crossing.h"

#include <stdint.h>

/* The maximum number of cubics solved at a time. */
enum { CWI_CUBICS = 16 };

/* Compute the weights of four samples at -1, 0, 1 and 2 in the value, or the slope, at t of the
 * cubic through them. */
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

/* Cubics as coefficients of the powers of t, with the sign that makes them rise from 0 to 1,
 * and the bracket in which each is known to be crossed. */
typedef struct cwi_cubic_search {
    double power[4][CWI_CUBICS], low[CWI_CUBICS], high[CWI_CUBICS];
    int64_t going[CWI_CUBICS]; /* 1 or 0 */
} cwi_cubic_search;

/* Takes a step of Newton's method for each cubic that is not done, or halves its bracket where
 * the step leaves it. Returns the number of cubics still not done. */
static inline int64_t cwi_step_cubics(cwi_cubic_search *restrict s, size_t count,
                                      double *restrict t)
{
    int64_t going = 0;
    for (size_t n = 0; n < count; n++) {
        const double a = s->power[0][n], b = s->power[1][n], c = s->power[2][n],
                     d = s->power[3][n];
        const double here = t[n], value = a + here * (b + here * (c + here * d));
        const double newton = here - value / (b + here * (2 * c + here * 3 * d));
        const double low = value <= 0 ? here : s->low[n], high = value <= 0 ? s->high[n] : here;
        const bool within = (newton >= low) & (newton <= high);
        const double next = within ? newton : (low + high) / 2;
        s->low[n] = low;
        s->high[n] = high;
        t[n] = s->going[n] ? next : here;
        s->going[n] &= !(fabs(next - here) < 1e-12);
        going += s->going[n];
    }
    return going;
}

/* Finds where cubics through numbers at -1, 0, 1 and 2, x[0] to x[3], cross the level between 0
 * and 1. found: 0 where a number is not finite, or where the cubic may cross more than once, as
 * its Bezier points change sides more than once; else 1. */
static inline void cwi_cross_cubics(const double x[4][CWI_CUBICS], size_t count, double level,
                                    double *restrict t, int64_t *restrict found)
{
    cwi_cubic_search s;
    for (size_t n = 0; n < count; n++) {
        /* eighths, so that no sum of finite numbers overflows */
        const double turn = x[2][n] > x[1][n] ? 0.125 : -0.125, at = level * turn;
        const double before = x[0][n] * turn - at, a = x[1][n] * turn - at,
                     b = x[2][n] * turn - at, after = x[3][n] * turn - at;
        const double slope0 = (6 * b - after - 2 * before - 3 * a) / 6,
                     slope1 = (before + 3 * b + 2 * after - 6 * a) / 6;
        const double sum = before + a + b + after, quadratic = (before + b) / 2 - a;
        s.power[0][n] = a;
        s.power[1][n] = slope0;
        s.power[2][n] = quadratic;
        s.power[3][n] = b - a - slope0 - quadratic;
        s.low[n] = 0;
        s.high[n] = 1;
        t[n] = a / (a - b);
        found[n] = (sum - sum == 0) & (a != b) & !((a + slope0 / 3 > 0) & (b - slope1 / 3 < 0));
        s.going[n] = found[n];
    }
    for (int steps = 0; steps < 12; steps++)
        if (!cwi_step_cubics(&s, count, t))
            break;
    for (size_t n = 0; n < count; n++)
        t[n] = cwi_off_ends(t[n]);
}

/* Finds the crossing of one cubic. Returns false where none is found. */
static inline bool cwi_cubic_crossing(const double x[4], double level, double *t)
{
    double one[4][CWI_CUBICS];
    int64_t found;
    for (int n = 0; n < 4; n++)
        one[n][0] = x[n];
    cwi_cross_cubics((const double(*)[CWI_CUBICS])one, 1, level, t, &found);
    return found;
}

#endif
