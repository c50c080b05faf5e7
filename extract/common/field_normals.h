/* Normals of vertices, from gradients of the field and from triangles. */
#ifndef EXTRACT_COMMON_FIELD_NORMALS_H
#define EXTRACT_COMMON_FIELD_NORMALS_H

#include <cubewright/mesh.h>
#include <cubewright/volume.h>

/* Computes the map from gradients of the stored numbers, in index space, to outward directions
 * of the world. It is the inverse transpose of the affine, here as its cofactors, the largest
 * of them 1. Its sign includes the determinant's and the side that is inside (invert: that of
 * low numbers). */
void cwi_outward(const cw_volume *volume, bool invert, double cofactor[3][3]);

/* Returns a power of two that makes voxels about 1 large, so that no product of sides leaves
 * the range of floats. */
double cwi_voxel_scale(const cw_volume *volume);

/* Adds the normal of a triangle, as long as twice its area in units of 1 / scale. */
void cwi_add_facet_normal(const float *const corner[3], double scale, float normal[3]);

/* Gives a sum of normals length 1; a sum of zero becomes +z. */
void cwi_finish_normal(float normal[3]);

/* Replaces normals that are zero by those of the triangles around their vertex, weighted by
 * area. */
CW_NODISCARD cw_status cwi_mend_normals(cw_mesh *mesh, double scale, cw_error *err);

#endif
