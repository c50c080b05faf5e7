/* Triangles of a node of the tree, side by side: one triangle is compared with several of them at a
 * time, and what is surely apart needs no exact test. */
#ifndef SIMPLIFY_INTERSECTIONS_TRIANGLE_PACKS_H
#define SIMPLIFY_INTERSECTIONS_TRIANGLE_PACKS_H

#include "core/geometry/bvh.h"

/* Corners of the triangles of a node, and their vertices. Missing triangles are at the origin. */
typedef struct cwi_triangle_pack {
    float at[3][3][CWI_WIDTH]; /* corner, axis */
    uint32_t vertex[3][CWI_WIDTH];
} cwi_triangle_pack;

/* The planes of a pack's triangles, with bounds of rounding. The value of a plane at a point is the
 * product of the normal and the vector from corner 0. At points of a triangle whose box meets that
 * of the plane's own triangle it is off by less than own_error + error * size, summed over the axes,
 * where size is that of the other triangle's box. */
typedef struct cwi_plane_pack {
    float normal[3][CWI_WIDTH], error[3][CWI_WIDTH], own_error[CWI_WIDTH];
    float size[3][CWI_WIDTH]; /* of the triangles' boxes */
} cwi_plane_pack;

/* Fills a pack with `count` triangles, at most CWI_WIDTH.
 * points   vertices x 3
 * corners  triangles x 3
 * order    the triangles */
void cwi_pack_triangles(const float *points, const uint32_t *corners, const uint32_t *order,
                        size_t count, cwi_triangle_pack *pack);

/* Computes the planes of a pack.
 * underflow  what products may lose as numbers near 0 are rounded: cwi_plane_underflow() */
void cwi_pack_planes(const cwi_triangle_pack *pack, float underflow, cwi_plane_pack *planes);

/* Returns a bound of what a plane's value loses as products near 0 are rounded.
 * max  the largest absolute coordinate */
static inline float cwi_plane_underflow(float max)
{
    return (2 * max + 1) * 0x1p-120f;
}

/* Returns those of the triangles `near` of pack b, by bits, which may have a point in common with
 * triangle i of pack a, besides common vertices and edges. Exact for those which it leaves out: they
 * have none.
 * near  triangles whose boxes meet that of triangle i; all triangles have an area */
unsigned cwi_find_unproved(const cwi_triangle_pack *a, const cwi_plane_pack *planes_a, size_t i,
                           const cwi_triangle_pack *b, const cwi_plane_pack *planes_b,
                           unsigned near);

#endif
