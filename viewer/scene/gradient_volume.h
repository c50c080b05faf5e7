/* The volume whose gradients light a scene, where that is not the volume itself: the indices of
 * its values [Drebin1988], or the field smoothed by a Gaussian. */
#ifndef VIEWER_SCENE_GRADIENT_VOLUME_H
#define VIEWER_SCENE_GRADIENT_VOLUME_H

#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The volume made last. Zeroed: there is none. */
typedef struct cwi_gradient_volume {
    cw_volume key;        /* it was made from this one, by these settings: */
    cw_transfer transfer; /* indices alone */
    double sigma;
    float *values;  /* x fastest */
    size_t version; /* of values */
} cwi_gradient_volume;

/* Makes the volume of a frame's gradients, unless it is there already, and puts it in the frame.
 * Does nothing for frames that need no gradients, or those of the volume itself.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED; CW_ERR_UNSUPPORTED: smoothing on a grid that is
 *          not evenly spaced
 * Cost     4 bytes a voxel; one pass over the voxels, and three with smoothing */
CW_NODISCARD cw_status cwi_gradient_volume_take(cwi_gradient_volume *made, cwi_frame *frame,
                                                cw_error *err);
void cwi_gradient_volume_free(cwi_gradient_volume *made);

#ifdef __cplusplus
}
#endif

#endif
