/* Points of an arrangement of triangles: vertices, and intersections kept as what defines them. All signs are
 * exact: doubles decide where their error allows it, long integers elsewhere. */
#ifndef SIMPLIFY_BOOLEAN_EXACT_POINTS_H
#define SIMPLIFY_BOOLEAN_EXACT_POINTS_H

#include "core/geometry/big_integer.h"

#include <cubewright/core.h>

/* Coordinates of vertices are integers below 2^CWI_GRID_BITS. So the determinant for the turn of three
 * points where planes meet has at most 961 bits. */
enum { CWI_GRID_BITS = 46 };

/* Triangles without a common order. All have an area above 0. */
typedef struct cwi_soup {
    size_t vertex_count;
    double (*vertices)[3]; /* integers; no two vertices are at one place */
    size_t triangle_count;
    uint32_t (*triangles)[3];
} cwi_soup;

/* Ways to define a point. */
typedef enum cwi_point_kind {
    CWI_VERTEX,     /* vertex ref[0] */
    CWI_LINE_PLANE, /* the line through vertices ref[0], ref[1], and the plane of triangle ref[2] */
    CWI_PLANES,     /* the planes of triangles ref[0], ref[1], ref[2] */
    CWI_LINE_LINE /* of one plane: the line through vertices ref[0], ref[1], and that through ref[2], ref[3];
                       the plane is seen along axis kind - CWI_LINE_LINE */
} cwi_point_kind;

typedef struct cwi_exact_point {
    double x[3]; /* exact for a vertex; for others within 1/16 unit */
    uint32_t kind;
    uint32_t ref[4];
} cwi_exact_point;

/* Coordinates as fractions: x / w, with w above 0. */
typedef struct cwi_homogeneous {
    cwi_big x[3], w;
} cwi_homogeneous;

/* Hashes a cell of the grid, or of a coarser one, for tables of places. */
static inline size_t cwi_hash_cell(const int64_t cell[3])
{
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) {
        hash = (hash ^ (uint64_t)cell[k]) * UINT64_C(0x9E3779B97F4A7C15);
        hash ^= hash >> 31;
    }
    return (size_t)hash;
}

/* Make points. Lines and planes must meet in one point. */
cwi_exact_point cwi_point_vertex(const cwi_soup *s, uint32_t v);
cwi_exact_point cwi_point_line_plane(const cwi_soup *s, uint32_t v0, uint32_t v1,
                                     uint32_t triangle);
cwi_exact_point cwi_point_line_line(const cwi_soup *s, const uint32_t v[4], int axis);
cwi_exact_point cwi_point_planes(const cwi_soup *s, const uint32_t triangles[3]);

/* Computes the exact coordinates of a point. */
void cwi_point_exact(const cwi_soup *s, const cwi_exact_point *p, cwi_homogeneous *out);

/* Computes the normal of a triangle: (b - a) x (c - a), below 2^95. */
void cwi_soup_normal(const cwi_soup *s, uint32_t t, cwi_wide normal[3]);

/* Returns the axis along which a triangle's normal is longest: it is seen with an area from there. */
int cwi_soup_axis(const cwi_soup *s, uint32_t t);

/* Returns cwi_point_turn() of three vertices. */
int cwi_soup_turn(const cwi_soup *s, uint32_t a, uint32_t b, uint32_t c, int axis);

/* Returns the side of a triangle's plane on which a vertex is: 1 where the normal points to. */
int cwi_soup_side(const cwi_soup *s, uint32_t t, uint32_t v);

/* Compare p with q along an axis; along x, then y, then z. The latter is the order along any line. */
int cwi_point_compare(const cwi_soup *s, const cwi_exact_point *p, const cwi_exact_point *q,
                      int axis);
int cwi_point_order(const cwi_soup *s, const cwi_exact_point *p, const cwi_exact_point *q);

/* Returns 1 when p, q, r turn counter-clockwise, seen along an axis from its positive end; -1 when
 * clockwise; 0 when they are on a line. */
int cwi_point_turn(const cwi_soup *s, const cwi_exact_point *p, const cwi_exact_point *q,
                   const cwi_exact_point *r, int axis);

/* Returns the sign of a dot product. */
int cwi_wide_dot_sign(const cwi_wide a[3], const cwi_wide b[3]);

#endif
