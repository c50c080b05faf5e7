/* Area, volume, angles and sides of each triangle by itself. */
#ifndef SIMPLIFY_QUALITY_TRIANGLE_SHAPES_H
#define SIMPLIFY_QUALITY_TRIANGLE_SHAPES_H

#include "simplify/quality/welded_mesh.h"

/* Adds a triangle's area, and the signed volume between it and a vertex. */
void cwi_add_triangle(const cw_mesh *mesh, size_t triangle, uint32_t vertex, double *volume,
                      double *area);

/* Triangles whose sums are made one by one; these sums are then joined in order. So they do not
 * depend on threads. */
enum { CWI_SHAPE_CHUNK = 4096 };

/* Sums over some triangles. */
typedef struct cwi_shape_sum {
    double area, volume;
    size_t degenerate, needles, caps;
    cw_shapes shapes; /* without lengths */
} cwi_shape_sum;

void cwi_shape_sum_init(cwi_shape_sum *sum);

/* Triangles that are measured together, so that the compiler can use vector instructions. */
enum { CWI_SHAPE_BLOCK = 64 };

typedef struct cwi_shape_block {
    size_t count;
    double corner[3][3][CWI_SHAPE_BLOCK]; /* of each corner, each axis */
    bool collapsed[CWI_SHAPE_BLOCK];      /* the triangle names a vertex twice */
    uint8_t defects[CWI_SHAPE_BLOCK];     /* set: degenerate or sliver, bits of cw_defect */
} cwi_shape_block;

/* Adds the triangles of a block, in order: the sum does not depend on how they are put into
 * blocks. Empties the block. */
void cwi_shape_sum_add(cwi_shape_sum *sum, cwi_shape_block *block);

/* Adds a sum to those of a mesh, whose shapes begin as those of an empty sum. */
void cwi_shape_sum_join(const cwi_shape_sum *sum, cw_quality *q);

/* Fills in area, volume, degenerate, needles, caps and shapes. False when memory is out. */
bool cwi_measure_shapes(const cwi_welded *welded, const cw_quality_desc *desc, cw_quality *q);

#endif
