/* Steps that whole meshes and slabs share: the target, the scale, and the mesh that is made. */
#ifndef SIMPLIFY_SIMPLIFY_FRAME_H
#define SIMPLIFY_SIMPLIFY_FRAME_H

#include "simplify/blocks/block_passes.h"

/* Returns the number of triangles to keep, of a mesh with `triangles` of them; 0: none is
 * set. */
size_t cwi_simplify_target(const cw_simplify_desc *desc, size_t triangles);

/* Lengths to the fourth power, and more, are worked with in single precision: those of a mesh
 * whose box is about 1 wide. A power of two, so that nothing is rounded. */
double cwi_simplify_scale(const cw_mesh *mesh);
void cwi_scale_points(const float *from, size_t vertices, double scale, float *to);

/* A block's triangles as a mesh in the frame of another one. */
CW_NODISCARD cw_status cwi_finish_mesh(const cw_mesh *frame, const cwi_mesh_block *block,
                                       cw_mesh *out, cw_error *err);

#endif
