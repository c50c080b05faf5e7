/* What each triangle says by itself: area, volume, angles, sides. */
#ifndef QUALITY_SHAPES_H
#define QUALITY_SHAPES_H

#include "simplify/quality/welded.h"

/* Six times less than the determinant: the volume from the mesh's origin to the triangle. */
double cwi_signed_volume(const cw_mesh *mesh, size_t triangle);

/* Fills in area, volume, degenerate, needles, caps and shapes. False when memory is out. */
bool cwi_measure_shapes(const cwi_welded *welded, const cw_quality_desc *desc, cw_quality *q);

#endif
