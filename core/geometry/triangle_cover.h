/* Proof that a triangle is near a surface everywhere.
 *
 * The distance from one facet is a convex function: over a convex polygon it is largest in a
 * corner [Tang2009]. So a piece of the triangle is near if one facet is near all of its
 * corners. Otherwise the piece is cut along a side of that facet, as seen along the triangle's
 * normal. The part beyond belongs to another facet. Where surfaces lie over each other, a few
 * pieces are needed for each facet. */
#ifndef CORE_GEOMETRY_TRIANGLE_COVER_H
#define CORE_GEOMETRY_TRIANGLE_COVER_H

#include "core/geometry/point_triangle.h"
#include "core/geometry/triangle.h"

#include <stdbool.h>
#include <string.h>

enum { CWI_PIECE_CORNERS = 16, CWI_PIECE_CUTS = 128 };

/* A convex polygon, and the number of cuts still allowed. */
typedef struct cwi_triangle_piece {
    int count, cuts;
    double p[CWI_PIECE_CORNERS][3];
} cwi_triangle_piece;

typedef struct cwi_cover {
    /* Sets the corners of a facet near a point, and returns a lower bound of the square of its
     * distance. If that is too large, no facet is near enough. */
    double (*nearest)(void *context, const double p[3], const float *facet[3]);
    void *context;
    double distance_sq; /* square of the allowed distance */
    double normal[3];   /* of the triangle; of any length */
} cwi_cover;

static inline double cwi_height(const double normal[3], const double p[3], const double at[3])
{
    return normal[0] * (p[0] - at[0]) + normal[1] * (p[1] - at[1]) + normal[2] * (p[2] - at[2]);
}

static inline void cwi_piece_add(cwi_triangle_piece *piece, const double p[3])
{
    memcpy(piece->p[piece->count++], p, sizeof piece->p[0]);
}

static inline bool cwi_opposite(double a, double b)
{
    return (a < 0 && b > 0) || (a > 0 && b < 0);
}

/* Returns true if the parts on both sides of a plane have room for their corners. A plane
 * crosses two sides of a convex polygon, but rounding may make it more. */
static inline bool cwi_piece_fits(const double *height, int count)
{
    int high = 0, low = 0;
    for (int n = 0; n < count; n++) {
        const int cut = cwi_opposite(height[n], height[n + 1 < count ? n + 1 : 0]);
        high += cut + (height[n] >= 0);
        low += cut + (height[n] <= 0);
    }
    return high <= CWI_PIECE_CORNERS && low <= CWI_PIECE_CORNERS;
}

/* Moves the part above a plane from *piece to *above. Returns false if all of it is on one
 * side, or so nearly that a cut is not worthwhile, or if a part has too many corners. */
static inline bool cwi_piece_cut(cwi_triangle_piece *piece, const double normal[3],
                                 const double at[3], cwi_triangle_piece *above)
{
    double height[CWI_PIECE_CORNERS], high = 0, low = 0;
    for (int n = 0; n < piece->count; n++) {
        height[n] = cwi_height(normal, piece->p[n], at);
        high = cwi_greater(high, height[n]);
        low = cwi_greater(low, -height[n]);
    }
    if (!(cwi_lesser(high, low) > 1e-6 * cwi_greater(high, low)) ||
        !cwi_piece_fits(height, piece->count))
        return false;
    cwi_triangle_piece whole;
    whole.count = piece->count;
    memcpy(whole.p, piece->p, (size_t)piece->count * sizeof piece->p[0]);
    piece->count = above->count = 0;
    above->cuts = --piece->cuts;
    for (int n = 0; n < whole.count; n++) {
        const int m = n + 1 < whole.count ? n + 1 : 0;
        if (height[n] <= 0)
            cwi_piece_add(piece, whole.p[n]);
        if (height[n] >= 0)
            cwi_piece_add(above, whole.p[n]);
        if (cwi_opposite(height[n], height[m])) {
            const double t = height[n] / (height[n] - height[m]);
            double cut[3];
            cwi_lerp(whole.p[n], whole.p[m], t, cut);
            cwi_piece_add(piece, cut);
            cwi_piece_add(above, cut);
        }
    }
    return true;
}

static inline void cwi_piece_middle(const cwi_triangle_piece *piece, double middle[3])
{
    for (int k = 0; k < 3; k++) {
        middle[k] = 0;
        for (int n = 0; n < piece->count; n++)
            middle[k] += piece->p[n][k];
        middle[k] /= piece->count;
    }
}

/* Halves a piece in the middle of its longest extent; the mean of its corners would be a poor
 * place. */
static inline bool cwi_piece_halve(cwi_triangle_piece *piece, cwi_triangle_piece *other)
{
    double longest = 0, along[3] = {0, 0, 0}, middle[3] = {0, 0, 0};
    for (int n = 0; n < piece->count; n++)
        for (int m = 0; m < n; m++) {
            const double *p = piece->p[n], *q = piece->p[m];
            const double side[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
            if (!(cwi_dot(side, side) > longest))
                continue;
            longest = cwi_dot(side, side);
            for (int k = 0; k < 3; k++) {
                along[k] = side[k];
                middle[k] = (p[k] + q[k]) / 2;
            }
        }
    return cwi_piece_cut(piece, along, middle, other);
}

/* Returns bit n if corner n is too far from a facet. */
static inline unsigned cwi_piece_far(const cwi_triangle_piece *piece,
                                     const float *const facet[3], double distance_sq)
{
    unsigned far = 0;
    cwi_facet_view view = cwi_facet_look(facet[0], facet[1], facet[2], piece->p[0]);
    for (int n = 0; n < piece->count; n++) {
        if (n)
            cwi_facet_turn(&view, facet[0], piece->p[n]);
        if (!(cwi_facet_view_distance_sq(&view) <= distance_sq))
            far |= 1u << n;
    }
    return far;
}

/* Computes the plane through a facet's side, along the normal, facing away from the facet. */
static inline void cwi_facet_side(const float *const facet[3], int side, const double normal[3],
                                  double at[3], double out[3])
{
    const float *a = facet[side], *b = facet[(side + 1) % 3], *c = facet[(side + 2) % 3];
    const double inner[3] = {(double)c[0], (double)c[1], (double)c[2]};
    double along[3];
    for (int k = 0; k < 3; k++) {
        at[k] = (double)a[k];
        along[k] = (double)b[k] - at[k];
    }
    cwi_cross(along, normal, out);
    if (cwi_height(out, inner, at) > 0)
        for (int k = 0; k < 3; k++)
            out[k] = -out[k];
}

/* Moves the part beyond one of the facet's sides, if some of the far corners are there, from
 * *piece to *beyond. A piece with many corners is left to be halved. */
static inline bool cwi_piece_cut_off(cwi_triangle_piece *piece, const float *const facet[3],
                                     unsigned far, const double normal[3],
                                     cwi_triangle_piece *beyond)
{
    for (int side = 0; side < 3 && piece->count < CWI_PIECE_CORNERS / 2; side++) {
        double at[3], out[3];
        bool helps = false;
        cwi_facet_side(facet, side, normal, at, out);
        for (int n = 0; n < piece->count; n++)
            helps |= (far >> n & 1) && cwi_height(out, piece->p[n], at) > 0;
        if (helps && cwi_piece_cut(piece, out, at, beyond))
            return true;
    }
    return false;
}

static inline bool cwi_piece_covered(const cwi_cover *c, cwi_triangle_piece *piece);

/* Returns true if all of a piece certainly is near, some of it to a facet. Cuts it up. */
static inline bool cwi_piece_covered_by(const cwi_cover *c, cwi_triangle_piece *piece,
                                        const float *const facet[3])
{
    for (unsigned far; (far = cwi_piece_far(piece, facet, c->distance_sq)) != 0;) {
        cwi_triangle_piece other;
        const bool cut = cwi_piece_cut_off(piece, facet, far, c->normal, &other);
        if (piece->cuts < 0 || (!cut && !cwi_piece_halve(piece, &other)) ||
            !cwi_piece_covered(c, &other))
            return false;
        if (!cut)
            return cwi_piece_covered(c, piece);
    }
    return true;
}

/* Returns true if all of a piece certainly is near. Cuts it up. */
static inline bool cwi_piece_covered(const cwi_cover *c, cwi_triangle_piece *piece)
{
    const float *facet[3];
    double middle[3];
    cwi_piece_middle(piece, middle);
    return c->nearest(c->context, middle, facet) <= c->distance_sq &&
           cwi_piece_covered_by(c, piece, facet);
}

/* Returns true if all of a triangle certainly is near. Sets the normal.
 * first  facet that some of it may be near; NULL where none is known */
static inline bool cwi_is_covered_from(cwi_cover *c, const double corners[3][3],
                                       const float *const first[3])
{
    cwi_triangle_piece whole;
    whole.count = 3;
    whole.cuts = CWI_PIECE_CUTS;
    memcpy(whole.p, corners, 3 * sizeof *whole.p);
    const unsigned far = first ? cwi_piece_far(&whole, first, c->distance_sq) : 7;
    if (far == 0)
        return true;
    cwi_triangle_normal(corners[0], corners[1], corners[2], c->normal);
    return far == 7 ? cwi_piece_covered(c, &whole) : cwi_piece_covered_by(c, &whole, first);
}

static inline bool cwi_is_covered(cwi_cover *c, const double corners[3][3])
{
    return cwi_is_covered_from(c, corners, NULL);
}

#endif
