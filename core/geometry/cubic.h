/* Cubics c[0] + c[1] x + c[2] x^2 + c[3] x^3: values, where they turn, where they have a value. */
#ifndef CORE_GEOMETRY_CUBIC_H
#define CORE_GEOMETRY_CUBIC_H

static inline double cwi_cubic_at(const double c[4], double x)
{
    return ((c[3] * x + c[2]) * x + c[1]) * x + c[0];
}

/* Where in 0 < x < 1 a cubic turns, rising; how many. */
int cwi_cubic_turns(const double c[4], double x[2]);

/* Where a cubic has a value between two places between which it does not turn, and has lower
 * and higher values. */
double cwi_cubic_meets(const double c[4], double from, double to, double value);

#endif
