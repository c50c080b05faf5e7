/* Points and vectors of three doubles, and minimum and maximum without NaN handling. */
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

static inline double cwi_length(const double v[3])
{
    return sqrt(cwi_dot(v, v));
}

/* Computes a - b. The output of this and the next three may be one of the inputs. */
/* Returns the axis along which a vector is longest; of equal ones the first. */
static inline int cwi_longest_axis(const double v[3])
{
    const int first = fabs(v[0]) >= fabs(v[1]) ? 0 : 1;
    return fabs(v[first]) >= fabs(v[2]) ? first : 2;
}

static inline void cwi_sub(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

/* Computes the vector from b to a for positions of a mesh, which are floats. */
static inline void cwi_sub_points(const float a[3], const float b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (double)a[k] - (double)b[k];
}

/* Computes p + t d: the point of a ray. */
static inline void cwi_add_scaled(const double p[3], double t, const double d[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = p[k] + t * d[k];
}

/* Computes the point at fraction t of the way from a to b. */
static inline void cwi_lerp(const double a[3], const double b[3], double t, double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k] + t * (b[k] - a[k]);
}

static inline void cwi_midpoint(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = 0.5 * (a[k] + b[k]);
}

static inline double cwi_distance_sq(const double a[3], const double b[3])
{
    double d[3];
    cwi_sub(a, b, d);
    return cwi_dot(d, d);
}

static inline double cwi_distance(const double a[3], const double b[3])
{
    return sqrt(cwi_distance_sq(a, b));
}

static inline double cwi_point_distance_sq(const float a[3], const float b[3])
{
    double d[3];
    cwi_sub_points(a, b, d);
    return cwi_dot(d, d);
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
    const double length = cwi_length(d);
    for (int a = 0; a < 3; a++)
        d[a] /= length;
    return true;
}

/* Divides a vector of ordinary size by its length. Leaves it, and returns false, where the length
 * is 0, denormal or not finite. Faster than cwi_normalise(), which takes any size. */
static inline bool cwi_to_unit(double v[3])
{
    const double length = cwi_length(v);
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
