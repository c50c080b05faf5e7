/* Whether a triangle is near a surface everywhere.
 *
 * Distance from one facet is a convex function [Tang2009]: over a convex polygon it is largest
 * in a corner. So a piece of the triangle is cleared when all of its corners are near one and
 * the same facet. Else the piece is cut along the facet's sides, as seen along the triangle's
 * normal; what lies over the facet is asked about again, and what lies beyond goes to another
 * facet. Surfaces that lie over each other then cost a few pieces for each facet. */
#ifndef SIMPLIFY_QUALITY_COVER_H
#define SIMPLIFY_QUALITY_COVER_H

#include "core/vector.h"
#include "simplify/quality/facet.h"

#include <stdbool.h>
#include <string.h>

enum { CWI_PIECE_CORNERS = 12 };

/* A convex polygon. */
typedef struct cwi_piece {
    int count;
    double p[CWI_PIECE_CORNERS][3];
} cwi_piece;

typedef struct cwi_cover {
    /* Corners of a facet near a point, and the square of the distance; all may be asked. */
    void (*nearest)(void *context, const double p[3], const float *corners[3], double *square);
    void *context;
    double square;    /* of the distance that is allowed */
    double normal[3]; /* of the triangle; of any length */
    int left;         /* pieces that may still be looked at */
    int depth;        /* and how often each is cut */
} cwi_cover;

static inline double cwi_height(const double normal[3], const double p[3], const double at[3])
{
    return normal[0] * (p[0] - at[0]) + normal[1] * (p[1] - at[1]) + normal[2] * (p[2] - at[2]);
}

static inline void cwi_piece_add(cwi_piece *piece, const double p[3])
{
    memcpy(piece->p[piece->count++], p, sizeof piece->p[0]);
}

/* A triangle and its normal. */
static inline cwi_piece cwi_piece_of(const double a[3], const double b[3], const double c[3],
                                     double normal[3])
{
    cwi_piece piece = {.count = 0};
    double ab[3], ac[3];
    for (int k = 0; k < 3; k++) {
        ab[k] = b[k] - a[k];
        ac[k] = c[k] - a[k];
    }
    cwi_cross(ab, ac, normal);
    cwi_piece_add(&piece, a);
    cwi_piece_add(&piece, b);
    cwi_piece_add(&piece, c);
    return piece;
}

/* Moves what is above a plane from *piece to *above. False: all of it is on one side, or so
 * nearly that it is not worth a cut. */
static inline bool cwi_piece_cut(cwi_piece *piece, const double normal[3], const double at[3],
                                 cwi_piece *above)
{
    const cwi_piece whole = *piece;
    double height[CWI_PIECE_CORNERS], high = 0, low = 0;
    for (int n = 0; n < whole.count; n++) {
        height[n] = cwi_height(normal, whole.p[n], at);
        high = cwi_greater(high, height[n]);
        low = cwi_greater(low, -height[n]);
    }
    if (!(cwi_lesser(high, low) > 1e-6 * cwi_greater(high, low)))
        return false;
    piece->count = above->count = 0;
    for (int n = 0; n < whole.count; n++) {
        const int m = n + 1 < whole.count ? n + 1 : 0;
        if (height[n] <= 0)
            cwi_piece_add(piece, whole.p[n]);
        if (height[n] >= 0)
            cwi_piece_add(above, whole.p[n]);
        if ((height[n] < 0) != (height[m] < 0) && height[n] != 0 && height[m] != 0) {
            const double t = height[n] / (height[n] - height[m]);
            double cut[3];
            for (int k = 0; k < 3; k++)
                cut[k] = whole.p[n][k] + t * (whole.p[m][k] - whole.p[n][k]);
            cwi_piece_add(piece, cut);
            cwi_piece_add(above, cut);
        }
    }
    return true;
}

static inline void cwi_piece_middle(const cwi_piece *piece, double middle[3])
{
    for (int k = 0; k < 3; k++) {
        middle[k] = 0;
        for (int n = 0; n < piece->count; n++)
            middle[k] += piece->p[n][k];
        middle[k] /= piece->count;
    }
}

/* Across its longest way, in the middle. */
static inline bool cwi_piece_halve(cwi_piece *piece, cwi_piece *other)
{
    double middle[3], longest = 0, along[3] = {0, 0, 0};
    for (int n = 0; n < piece->count; n++)
        for (int m = 0; m < n; m++) {
            const double way[3] = {piece->p[n][0] - piece->p[m][0],
                                   piece->p[n][1] - piece->p[m][1],
                                   piece->p[n][2] - piece->p[m][2]};
            if (cwi_dot(way, way) > longest) {
                longest = cwi_dot(way, way);
                memcpy(along, way, sizeof along);
            }
        }
    cwi_piece_middle(piece, middle);
    return cwi_piece_cut(piece, along, middle, other);
}

static inline bool cwi_piece_near(const cwi_piece *piece, const float *const facet[3],
                                  double square)
{
    for (int n = 0; n < piece->count; n++)
        if (!(cwi_facet_square(facet[0], facet[1], facet[2], piece->p[n]) <= square))
            return false;
    return true;
}

/* Moves what is beyond the facet's side from one corner to the next, as seen along the normal,
 * from *piece to *beyond. */
static inline bool cwi_piece_cut_at(cwi_piece *piece, const float *const facet[3], int side,
                                    const double normal[3], cwi_piece *beyond)
{
    const float *a = facet[side], *b = facet[(side + 1) % 3], *c = facet[(side + 2) % 3];
    const double at[3] = {a[0], a[1], a[2]}, inner[3] = {c[0], c[1], c[2]};
    const double along[3] = {(double)b[0] - at[0], (double)b[1] - at[1], (double)b[2] - at[2]};
    double out[3];
    cwi_cross(along, normal, out);
    if (cwi_height(out, inner, at) > 0)
        for (int k = 0; k < 3; k++)
            out[k] = -out[k];
    return cwi_piece_cut(piece, out, at, beyond);
}

static inline bool cwi_is_covered(cwi_cover *c, const cwi_piece *whole);

static inline bool cwi_is_part_covered(cwi_cover *c, const cwi_piece *part)
{
    c->depth--;
    const bool covered = cwi_is_covered(c, part);
    c->depth++;
    return covered;
}

/* Whether all of a piece certainly is near. */
static inline bool cwi_is_covered(cwi_cover *c, const cwi_piece *whole)
{
    const float *facet[3];
    double middle[3], square;
    cwi_piece piece = *whole, other;
    if (--c->left < 0 || c->depth < 0)
        return false;
    cwi_piece_middle(&piece, middle);
    c->nearest(c->context, middle, facet, &square);
    if (!(square <= c->square))
        return false;
    if (cwi_piece_near(&piece, facet, c->square))
        return true;
    for (int side = 0; side < 3 && piece.count < CWI_PIECE_CORNERS - 1; side++)
        if (cwi_piece_cut_at(&piece, facet, side, c->normal, &other) &&
            !cwi_is_part_covered(c, &other))
            return false;
    if (cwi_piece_near(&piece, facet, c->square))
        return true;
    return cwi_piece_halve(&piece, &other) && cwi_is_part_covered(c, &other) &&
           cwi_is_part_covered(c, &piece);
}

#endif
