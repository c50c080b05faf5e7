/* Area, volume, angles and sides of each triangle by itself. */
#ifndef SIMPLIFY_QUALITY_TRIANGLE_SHAPES_H
#define SIMPLIFY_QUALITY_TRIANGLE_SHAPES_H

#include "simplify/quality/welded_mesh.h"

/* Adds a triangle's area, and the signed volume between it and a vertex. */
void cwi_add_triangle(const cw_mesh *mesh, size_t triangle, uint32_t vertex, double *volume,
                      double *area);

/* Fills in area, volume, degenerate, needles, caps and shapes. False when memory is out. */
bool cwi_measure_shapes(const cwi_welded *welded, const cw_quality_desc *desc, cw_quality *q);

#endif
