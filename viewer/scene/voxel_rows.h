/* Reads rows of voxels as floats. */
#ifndef VIEWER_SCENE_VOXEL_ROWS_H
#define VIEWER_SCENE_VOXEL_ROWS_H

#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reads count numbers of a row, before slope and intercept; NaN: no value. */
void cwi_row_load(const cw_volume *volume, const void *from, size_t count, float *to);
/* Returns the same numbers, in the volume if it stores floats without gaps, or else in the
 * buffer. */
const float *cwi_row_of(const cw_volume *volume, const void *from, size_t count, float *buffer);

#ifdef __cplusplus
}
#endif

#endif
