/* Sizes of pegs, dowels and their holes. */
#ifndef SIMPLIFY_PIECES_PEG_SIZES_H
#define SIMPLIFY_PIECES_PEG_SIZES_H

#include <cubewright/pieces.h>

/* The wall around holes by default, in diameters. */
#define CWI_PEG_WALL 0.25

typedef struct cwi_peg_sizes {
    double radius, hole_radius, wall;
    double below, above; /* how far the peg or its hole goes from the section */
    double hole[2];      /* depth of the hole below and above; 0: none */
    double deep[2];      /* material that it needs there */
    double root;         /* how far a peg begins inside of its own piece */
} cwi_peg_sizes;

/* Computes the sizes of a peg, or dowel, by the settings with their defaults. */
static inline cwi_peg_sizes cwi_find_peg_sizes(const cw_pieces_desc *d, double diameter,
                                               double length)
{
    cwi_peg_sizes s = {.radius = diameter / 2,
                       .hole_radius = diameter / 2 + d->clearance_mm,
                       .wall = d->wall_mm};
    s.root = diameter / 16;
    s.hole[0] = d->dowels ? length / 2 + d->clearance_mm : 0;
    s.hole[1] = (d->dowels ? length / 2 : length) + d->clearance_mm;
    s.below = d->dowels ? s.hole[0] : s.root;
    s.above = s.hole[1];
    s.deep[0] = d->dowels ? s.hole[0] + s.wall : 2 * s.root;
    s.deep[1] = s.hole[1] + s.wall;
    return s;
}

/* Returns the distance from the border that a circle needs: it is measured as a polygon of 32 sides around it. */
static inline double cwi_peg_room(double radius)
{
    return radius * 1.00484; /* 1 / cos(pi / 32) */
}

/* Returns the diameter of the widest peg whose hole has room at a point so far from the border; negative or
 * 0: none has. */
static inline double cwi_widest_peg(const cw_pieces_desc *d, double reach)
{
    const double left = reach / cwi_peg_room(1) - d->clearance_mm;
    return d->wall_mm > 0 ? 2 * (left - d->wall_mm) : left / (0.5 + CWI_PEG_WALL);
}

#endif
