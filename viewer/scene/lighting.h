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
    double surface;                    /* as the frame's */
    size_t face_count;                 /* of clip planes that cut the volume */
    const double *faces[CW_MAX_CLIPS]; /* normals in eye space, */
    double face_start[CW_MAX_CLIPS], face_slope[CW_MAX_CLIPS]; /* and distances along the ray */
    cw_shadow shadow;
    double side; /* of the planes that is drawn: 1 or -1 */
    double direction[CW_MAX_LIGHTS][3], halfway[CW_MAX_LIGHTS][3]; /* of unit length, or 0 */
    double color[CW_MAX_LIGHTS][3];
} cwi_lighting;

/* origin, direction: the ray's, in eye space; direction of unit length */
void cwi_lighting_make(const cwi_frame *frame, const double origin[3],
                       const double direction[3], cwi_lighting *lighting);

/* Lights a colour at a distance t along the ray, by a gradient in eye space. shadow: the fraction
 * of light that comes there, 1 without shadows. Within a unit of a
 * clip plane it is lit by the plane's normal in place of the gradient's, which is 0 where a solid
 * is cut, and has no highlight; beyond two units the gradient alone counts. */
void cwi_lighting_shade(const cwi_lighting *lighting, double t, const double gradient[3],
                        double shadow, double color[3]);

/* Returns the share of the light that a clip plane has at a distance from it, 0 to 1. */
double cwi_lighting_face_fraction(double distance);

#ifdef __cplusplus
}
#endif

#endif
