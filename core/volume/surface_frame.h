/* Directions and scale that surfaces of a volume have in the world. */
#ifndef CORE_VOLUME_SURFACE_FRAME_H
#define CORE_VOLUME_SURFACE_FRAME_H

#include <cubewright/volume.h>

/* Computes the map from gradients of the stored numbers, in index space, to outward directions
 * of the world. It is the inverse transpose of the affine, here as its cofactors, the largest
 * of them 1. Its sign includes the determinant's and the side that is inside (invert: that of
 * low numbers). */
void cwi_outward(const cw_volume *volume, bool invert, double cofactor[3][3]);

/* Returns a power of two that makes voxels about 1 large, so that no product of sides leaves
 * the range of floats. */
double cwi_voxel_scale(const cw_volume *volume);

/* The frame of a surface's vertices. */
typedef struct cwi_surface_frame {
    double cofactor[3][3]; /* as cwi_outward() finds it */
    double center[3];      /* index, or coordinate, that stands at the mesh's origin */
    float cap[3][2][3];    /* normals of caps across an axis, low and high side */
    bool is_diagonal;      /* only the affine's diagonal is not 0 */
} cwi_surface_frame;

void cwi_surface_frame_make(const cw_volume *volume, bool invert, cwi_surface_frame *frame);

#endif
