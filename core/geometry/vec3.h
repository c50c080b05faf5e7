/* Vectors of three doubles, and minimum and maximum without NaN handling. */
#ifndef CORE_GEOMETRY_VEC3_H
#define CORE_GEOMETRY_VEC3_H

#include <math.h>
#include <stdbool.h>

#define CWI_PI 3.14159265358979323846

static inline double cwi_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void cwi_cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Normalises a vector. Returns false, and changes nothing, where it is 0 or not finite. Scales
 * by the largest component first, since squares of tiny or huge ones under- or overflow. */
static inline bool cwi_normalise(double d[3])
{
    const double largest = fmax(fmax(fabs(d[0]), fabs(d[1])), fabs(d[2]));
    if (!(largest > 0) || !isfinite(largest))
        return false;
    for (int a = 0; a < 3; a++)
        d[a] /= largest;
    const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    for (int a = 0; a < 3; a++)
        d[a] /= length;
    return true;
}

/* Divides a vector of ordinary size by its length. Leaves it, and returns false, where the length
 * is 0, denormal or not finite. Faster than cwi_normalise(), which takes any size. */
static inline bool cwi_to_unit(double v[3])
{
    const double length = sqrt(cwi_dot(v, v));
    if (!isnormal(length))
        return false;
    for (int a = 0; a < 3; a++)
        v[a] /= length;
    return true;
}

/* Returns the minimum, without the handling of NaN that makes fmin and fmax calls. */
static inline double cwi_lesser(double a, double b)
{
    return a < b ? a : b;
}

static inline double cwi_greater(double a, double b)
{
    return a > b ? a : b;
}

#endif
