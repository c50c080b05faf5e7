/* Light that reaches voxels: past the volume between them and a light, or through their
 * surroundings. */
#ifndef VIEWER_SCENE_SHADOW_VOLUME_H
#define VIEWER_SCENE_SHADOW_VOLUME_H

#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_SHADOW_RAYS = 14 };

/* The facts that shadows depend on, without padding: keys are compared by their bytes. */
typedef struct cwi_shadow_key {
    cw_volume volume;
    cw_transfer transfer;
    double opacity_units, surface;
    size_t gradient_version;
    size_t count, clip_count, cut_away;
    double steps[CWI_SHADOW_RAYS][3]; /* of rays, in index space: a unit of eye space */
    double clips[CW_MAX_CLIPS][4];    /* in index space: n . p >= w is kept */
} cwi_shadow_key;

/* The shadows made last. Zeroed: there are none. */
typedef struct cwi_shadow_volume {
    cwi_shadow_key key;
    float *values; /* 0 to 1, x fastest */
    size_t version;
} cwi_shadow_volume;

/* Makes the shadows of a frame, unless they are there already, and puts them in the frame. Does
 * nothing for frames without. Call it after cwi_gradient_volume_take().
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED; CW_ERR_UNSUPPORTED: the mode has no shadows, or
 *          the grid is not evenly spaced
 * Cost     8 bytes a voxel; a ray, or 14 short ones, for each visible voxel */
CW_NODISCARD cw_status cwi_shadow_volume_take(cwi_shadow_volume *made, cwi_frame *frame,
                                              cw_error *err);
void cwi_shadow_volume_free(cwi_shadow_volume *made);

#ifdef __cplusplus
}
#endif

#endif
