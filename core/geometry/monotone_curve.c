/* Evaluates piecewise cubics whose slopes are limited so that nothing overshoots. */
#include "core/geometry/monotone_curve.h"

#include <math.h>

static double find_secant(const double *times, const double *values, size_t n)
{
    return (values[n + 1] - values[n]) / (times[n + 1] - times[n]);
}

/* The slope at a value: that of the parabola through it and its neighbours, no steeper than
 * twice either secant; 0 at a turning point and at the ends. */
static double limited_slope(const double *times, const double *values, size_t count, size_t n)
{
    if (n == 0 || n + 1 >= count)
        return 0;
    const double before = find_secant(times, values, n - 1),
                 after = find_secant(times, values, n);
    const double h0 = times[n] - times[n - 1], h1 = times[n + 1] - times[n];
    const double parabola = (before * h1 + after * h0) / (h0 + h1);
    if (before * after <= 0)
        return 0;
    return copysign(fmin(fabs(parabola), 2 * fmin(fabs(before), fabs(after))), before);
}

double cwi_monotone_curve(const double *times, const double *values, size_t count, double time)
{
    if (time <= times[0])
        return values[0];
    if (time >= times[count - 1])
        return values[count - 1];
    size_t n = 0;
    while (times[n + 1] <= time)
        n++;
    const double h = times[n + 1] - times[n], t = (time - times[n]) / h;
    const double slope0 = limited_slope(times, values, count, n);
    const double slope1 = limited_slope(times, values, count, n + 1);
    const double rise = values[n + 1] - values[n];
    const double step = t * t * (3 - 2 * t);
    return values[n] + rise * step + h * t * (1 - t) * (slope0 * (1 - t) - slope1 * t);
}
