/* The flow between voxels in diffusion that goes along edges and not across [Weickert1998]. */
#ifndef CORE_FILTER_EDGE_FLOW_H
#define CORE_FILTER_EDGE_FLOW_H

#include <stddef.h>

/* Three slices in a row, and the same smoothed. Slices and rows have one more value at each end,
 * and NaN where there is no value. Values are in units of the contrast. */
typedef struct cwi_flow_slices {
    const float *raw[3], *smooth[3];
    size_t pitch;       /* floats of a row */
    float per_voxel[3]; /* the shortest distance between voxels / that along each axis */
} cwi_flow_slices;

/* Floats of work for rows of a number of voxels. */
static inline size_t cwi_flow_work(size_t count)
{
    return 6 * count;
}

/* Sets what flows through the faces between a row of the slice in the middle and the next row or
 * slice along an axis. It is 0 beside voxels without a value. Along z the first slice is not used.
 * row   counted from 1
 * work  cwi_flow_work(count) floats */
void cwi_edge_flow(const cwi_flow_slices *s, size_t row, int axis, size_t count, float *work,
                   float *flow);

/* Smooths a slice with the weights 1/4, 1/2, 1/4 along each axis.
 * raw   the slice before, the slice, and the one behind
 * work  a slice and a row
 * to    without the values at its ends */
void cwi_smooth_slice(const float *const raw[3], size_t pitch, size_t rows, float *work,
                      float *to);

#endif
