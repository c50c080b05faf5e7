/* The grid of a volume that is sampled at other distances: of values, or of labels. */
#ifndef CORE_FILTER_RESAMPLE_GRID_H
#define CORE_FILTER_RESAMPLE_GRID_H

#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Places along an axis, in units of the affine's column. */
typedef struct cwi_sample_axis {
    double first, step; /* of the output */
    double wider;       /* output distance in input voxels, at least 1 */
    size_t count;
} cwi_sample_axis;

/* Plans the axes of a dense volume that is sampled at other distances; 0: as it is.
 * Returns CW_ERR_ARGUMENT, naming spacing_mm; CW_ERR_LIMIT: too many samples */
CW_NODISCARD cw_status cwi_sample_axes_plan(const cw_volume *in, const double spacing_mm[3],
                                            cwi_sample_axis axes[3], cw_error *err);

/* Returns the place of output sample n along axis a, in input voxels. */
double cwi_sample_position(const cw_volume *in, int a, const cwi_sample_axis *axis, size_t n);

/* Sets the affine of an output whose first voxel stays in its place. */
void cwi_sample_affine(const cw_volume *in, const cwi_sample_axis axes[3], cw_volume *out);

#ifdef __cplusplus
}
#endif

#endif
