/* Triangles of a chart in the plane. */
#ifndef SIMPLIFY_ATLAS_CHART_PLANE_H
#define SIMPLIFY_ATLAS_CHART_PLANE_H

#include "simplify/atlas/atlas_state.h"

/* The map from a triangle's own plane to that of the chart, row by row. */
static inline void cwi_chart_jacobian(const cwi_chart *chart, const double (*uv)[2], size_t t,
                                      double j[4])
{
    const uint32_t *c = chart->corners + 3 * t;
    const double *r = chart->rest[t];
    const double ux = uv[c[1]][0] - uv[c[0]][0], vx = uv[c[1]][1] - uv[c[0]][1],
                 uy = uv[c[2]][0] - uv[c[0]][0], vy = uv[c[2]][1] - uv[c[0]][1];
    j[0] = ux * r[0] + uy * r[2];
    j[1] = ux * r[1] + uy * r[3];
    j[2] = vx * r[0] + vy * r[2];
    j[3] = vx * r[1] + vy * r[3];
}

/* Returns the sum of the squares of its numbers. */
static inline double cwi_chart_norm_sq(const double j[4])
{
    return j[0] * j[0] + j[1] * j[1] + j[2] * j[2] + j[3] * j[3];
}

static inline double cwi_chart_det(const double j[4])
{
    return j[0] * j[3] - j[1] * j[2];
}

/* Sets cosine and sine of an angle: a share, below 1, of a quarter of a turn. By its half's tangent, so
 * that any machine computes the same. */
static inline void cwi_chart_turn(double share, double turn[2])
{
    const double t = 0.41421356237309503 * share, square = t * t;
    turn[0] = (1 - square) / (1 + square);
    turn[1] = 2 * t / (1 + square);
}

/* Makes one turn of two, as complex numbers are multiplied. */
static inline void cwi_chart_multiply(const double a[2], const double b[2], double turn[2])
{
    turn[0] = a[0] * b[0] - a[1] * b[1];
    turn[1] = a[1] * b[0] + a[0] * b[1];
}

#endif
