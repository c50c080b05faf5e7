/* Lengths of rays through a mesh, from a point of a triangle to where they leave a solid or enter one. */
#ifndef SIMPLIFY_PRINTING_RAY_LENGTHS_H
#define SIMPLIFY_PRINTING_RAY_LENGTHS_H

#include "core/geometry/bvh.h"

#include <cubewright/mesh.h>

typedef struct cwi_wall_target {
    const cw_mesh *mesh;
    cwi_boxes tree; /* of its triangles */
    float slack;    /* for rounding, mm */
} cwi_wall_target;

/* A point of a triangle, which rays from there do not meet. */
typedef struct cwi_ray_start {
    size_t triangle;
    double at[3];
} cwi_ray_start;

/* Rays either leave the solid where they end, or enter it. */
enum { CWI_RAY_ENTERS = -1, CWI_RAY_LEAVES = 1 };

/* Returns the length of a ray to the surface, up to `max_reach`, or INFINITY: where it meets none, or where
 * the surface does not face it. Looks near by first, as long rays meet many boxes.
 * direction  unit
 * end        CWI_RAY_ENTERS or CWI_RAY_LEAVES
 * first      how far it looks at first, mm
 * relevant   longer results do not matter: INFINITY may stand for them */
double cwi_ray_length(const cwi_wall_target *target, const cwi_ray_start *start,
                      const double direction[3], int end, double first, double max_reach,
                      double relevant);

/* Measures two rays at a time, into the solid and out of it.
 * normal   unit, out of the solid
 * reach    of the ray that leaves the solid at its end, and of the one that enters, mm
 * lengths  as cwi_ray_length(), but -1 where a ray meets nothing within its reach */
void cwi_ray_lengths(const cwi_wall_target *target, const cwi_ray_start *start,
                     const double normal[3], const double reach[2], double lengths[2]);

/* Rays around an axis, at an angle to it in radians. */
typedef struct cwi_ray_cone {
    int rays;
    double angle;
} cwi_ray_cone;

/* Returns the length of the shortest of the rays in a cone, or the length of the axis if that is less.
 * axis  unit    length  of the axis, mm */
double cwi_shortest_around(const cwi_wall_target *target, const cwi_ray_start *start,
                           const double axis[3], int end, const cwi_ray_cone *cone,
                           double length);

#endif
