/* Distances and closest points between a point and a segment or triangle. */
#ifndef CORE_GEOMETRY_POINT_TRIANGLE_H
#define CORE_GEOMETRY_POINT_TRIANGLE_H

#include "core/geometry/vec3.h"

#include <math.h>

/* Returns the parameter, 0 to 1, of the segment's point closest to a given point; `from` is
 * that point relative to the segment's start. */
static inline double cwi_segment_nearest(const double from[3], const double along[3])
{
    const double along_sq = cwi_dot(along, along);
    const double t = along_sq > 0 ? cwi_dot(from, along) / along_sq : 0;
    return cwi_lesser(cwi_greater(t, 0), 1);
}

static inline double cwi_segment_square(const double from[3], const double along[3])
{
    const double t = cwi_segment_nearest(from, along);
    double offset[3];
    cwi_add_scaled(from, -t, along, offset);
    return cwi_dot(offset, offset);
}

/* A point seen from a triangle: the signed areas of the three triangles that it makes with the
 * sides, times the triangle's own area. */
typedef struct cwi_facet_view {
    double ab[3], ac[3], bc[3], ap[3], bp[3], normal[3];
    double normal_sq, in_a, in_b, in_c;
} cwi_facet_view;

/* Changes the point of a view. a: corner of the triangle */
static inline void cwi_facet_turn(cwi_facet_view *f, const float a[3], const double p[3])
{
    double x[3], y[3];
    for (int k = 0; k < 3; k++) {
        f->ap[k] = p[k] - (double)a[k];
        f->bp[k] = f->ap[k] - f->ab[k];
    }
    cwi_cross(f->ab, f->ap, x);
    cwi_cross(f->ap, f->ac, y);
    f->in_c = cwi_dot(x, f->normal);
    f->in_b = cwi_dot(y, f->normal);
    f->in_a = f->normal_sq - f->in_b - f->in_c;
}

static inline cwi_facet_view cwi_facet_look(const float a[3], const float b[3],
                                            const float c[3], const double p[3])
{
    cwi_facet_view f;
    for (int k = 0; k < 3; k++) {
        f.ab[k] = (double)b[k] - (double)a[k];
        f.ac[k] = (double)c[k] - (double)a[k];
        f.bc[k] = f.ac[k] - f.ab[k];
    }
    cwi_cross(f.ab, f.ac, f.normal);
    f.normal_sq = cwi_dot(f.normal, f.normal);
    cwi_facet_turn(&f, a, p);
    return f;
}

/* Returns the square of the point's distance from the triangle. The nearest point is in the
 * triangle's plane, or on a side that the point is beyond. The signs of the three areas decide.
 * Without an area all sides are tried. */
static inline double cwi_facet_view_distance_sq(const cwi_facet_view *f)
{
    double best = INFINITY;
    if (f->normal_sq > 0 && f->in_a >= 0 && f->in_b >= 0 && f->in_c >= 0) {
        const double height = cwi_dot(f->ap, f->normal);
        return height * height / f->normal_sq;
    }
    if (!(f->in_c >= 0) || !(f->normal_sq > 0))
        best = cwi_segment_square(f->ap, f->ab);
    if (!(f->in_b >= 0) || !(f->normal_sq > 0))
        best = cwi_lesser(best, cwi_segment_square(f->ap, f->ac));
    if (!(f->in_a >= 0) || !(f->normal_sq > 0))
        best = cwi_lesser(best, cwi_segment_square(f->bp, f->bc));
    return best;
}

static inline double cwi_facet_distance_sq(const float a[3], const float b[3], const float c[3],
                                           const double p[3])
{
    const cwi_facet_view f = cwi_facet_look(a, b, c, p);
    return cwi_facet_view_distance_sq(&f);
}

/* Computes the weights of the corners for the triangle's point that is closest to p. */
static inline void cwi_facet_nearest(const float a[3], const float b[3], const float c[3],
                                     const double p[3], double weights[3])
{
    const cwi_facet_view f = cwi_facet_look(a, b, c, p);
    if (f.normal_sq > 0 && f.in_a >= 0 && f.in_b >= 0 && f.in_c >= 0) {
        weights[0] = f.in_a / f.normal_sq;
        weights[1] = f.in_b / f.normal_sq;
        weights[2] = f.in_c / f.normal_sq;
        return;
    }
    const double on_ab = cwi_segment_square(f.ap, f.ab), on_ac = cwi_segment_square(f.ap, f.ac),
                 on_bc = cwi_segment_square(f.bp, f.bc);
    const int from = on_bc < on_ab && on_bc < on_ac ? 1 : 0,
              to = from == 1 || on_ac < on_ab ? 2 : 1;
    const double t = from == 1 ? cwi_segment_nearest(f.bp, f.bc)
                     : to == 2 ? cwi_segment_nearest(f.ap, f.ac)
                               : cwi_segment_nearest(f.ap, f.ab);
    weights[0] = weights[1] = weights[2] = 0;
    weights[from] = 1 - t;
    weights[to] = t;
}

#endif
