/* Cubics c[0] + c[1] x + c[2] x^2 + c[3] x^3: values, turning points, places of a given
 * value. */
#ifndef CORE_GEOMETRY_CUBIC_H
#define CORE_GEOMETRY_CUBIC_H

static inline double cwi_cubic_at(const double c[4], double x)
{
    return ((c[3] * x + c[2]) * x + c[1]) * x + c[0];
}

/* Finds the turning points in 0 < x < 1 of a cubic, rising; returns their number. */
int cwi_cubic_turns(const double c[4], double x[2]);

/* Finds the place where a cubic has a value, between two places. The cubic must not turn
 * between them, and must have lower and higher values there. */
double cwi_cubic_meets(const double c[4], double from, double to, double value);

#endif
