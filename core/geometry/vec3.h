/* Vectors of three, and the lesser and greater of two numbers. */
#ifndef CORE_GEOMETRY_VEC3_H
#define CORE_GEOMETRY_VEC3_H

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

/* Without the care for NaN that makes fmin and fmax calls. */
static inline double cwi_lesser(double a, double b)
{
    return a < b ? a : b;
}

static inline double cwi_greater(double a, double b)
{
    return a > b ? a : b;
}

#endif
