/* Pictures of surfaces whose look is compared. */
#ifndef VIEWER_APPEARANCE_LOOK_DRAW_H
#define VIEWER_APPEARANCE_LOOK_DRAW_H

#include "viewer/appearance/look_model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Settings of a picture. */
typedef struct cwi_look_picture {
    const cw_camera *camera;
    uint32_t size;
    bool without_maps;
    int threads;
    cw_progress progress;
} cwi_look_picture;

/* Draws a model with 4 samples a pixel, front sides alone. Each surface of a pixel is shaded once, at the
 * pixel's middle; its colour counts by its samples.
 * rgba     size x size x 4, set: colours times opacity, top row first
 * Returns  CW_ERR_ARGUMENT as cw_camera_axes(); CW_ERR_CANCELLED, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_look_draw(const cwi_look_model *model,
                                     const cwi_look_picture *picture, uint8_t *rgba,
                                     cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
