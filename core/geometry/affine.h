/* Linear algebra of affine maps. An affine is the 12 numbers of a 3x4 map, row by row: y = A x
 * + t. Pass affine[0]: C17 cannot pass a double[3][4] to a const parameter. */
#ifndef CORE_GEOMETRY_AFFINE_H
#define CORE_GEOMETRY_AFFINE_H

#include <cubewright/core.h>

static inline double cwi_affine_determinant(const double *a)
{
    return a[0] * (a[5] * a[10] - a[6] * a[9]) - a[1] * (a[4] * a[10] - a[6] * a[8]) +
           a[2] * (a[4] * a[9] - a[5] * a[8]);
}

static inline void cwi_affine_apply(const double *a, const double x[3], double y[3])
{
    for (int r = 0; r < 3; r++)
        y[r] = a[4 * r] * x[0] + a[4 * r + 1] * x[1] + a[4 * r + 2] * x[2] + a[4 * r + 3];
}

/* Computes the cofactor matrix: determinant times inverse transpose. It takes gradients (and
 * plane normals) of index space to world directions, up to the determinant. */
static inline void cwi_affine_cofactor(const double *a, double c[3][3])
{
    for (int r = 0; r < 3; r++)
        for (int s = 0; s < 3; s++) {
            const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, s1 = (s + 1) % 3, s2 = (s + 2) % 3;
            c[r][s] = a[4 * r1 + s1] * a[4 * r2 + s2] - a[4 * r1 + s2] * a[4 * r2 + s1];
        }
}

/* Computes the inverse of the linear part. Its determinant is not 0. */
static inline void cwi_affine_invert(const double *a, double inverse[3][3])
{
    double cofactor[3][3];
    cwi_affine_cofactor(a, cofactor);
    for (int i = 0; i < 9; i++)
        inverse[i % 3][i / 3] = cofactor[i / 3][i % 3] / cwi_affine_determinant(a);
}

#endif
