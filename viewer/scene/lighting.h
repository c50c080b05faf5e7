/* A scene's lights as a ray sees them, as in shaders/common.glsl. */
#ifndef VIEWER_SCENE_LIGHTING_H
#define VIEWER_SCENE_LIGHTING_H

#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A ray's lights. They are far away, so a ray has one direction to each, and one halfway to the
 * eye. */
typedef struct cwi_lighting {
    cw_material material;
    bool is_one_sided;
    size_t count;
    double direction[CW_MAX_LIGHTS][3], halfway[CW_MAX_LIGHTS][3]; /* of unit length, or 0 */
    double color[CW_MAX_LIGHTS][3];
} cwi_lighting;

/* direction: the ray's, in eye space, of unit length */
void cwi_lighting_make(const cwi_frame *frame, const double direction[3],
                       cwi_lighting *lighting);

/* Lights a colour by a gradient in eye space. */
void cwi_lighting_shade(const cwi_lighting *lighting, const double gradient[3],
                        double color[3]);

#ifdef __cplusplus
}
#endif

#endif
