/* Where a picture is taken from. World frame: LPS millimetres. */
#ifndef CUBEWRIGHT_CAMERA_H
#define CUBEWRIGHT_CAMERA_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cw_camera {
    double eye[3], target[3];
    double up[3];     /* any length, not along the line of sight */
    double fov_deg;   /* vertical opening angle; 0: orthographic */
    double height_mm; /* orthographic only: what the picture's height covers */
} cw_camera;

/* What a fitted camera has to see. */
typedef struct cw_fit_desc {
    const char *view; /* a cw_view_name(); default "front" */
    double min[3], max[3];
    double aspect;  /* width / height of the picture; 0 means 1 */
    double fov_deg; /* 0: orthographic */
    double margin;  /* share of the picture left free on each side, below 0.5 */
} cw_fit_desc;

/* The name of the n-th view; NULL after the last. They are front (seen from the patient's
 * front), back, left, right, top, bottom and iso. Heads are up, and a patient seen from the
 * front has the left hand on the picture's right; from above and below the front is up. */
CW_API const char *cw_view_name(size_t n);

/* The camera of a named view that sees a whole box, as large as the margin allows.
 * Returns CW_ERR_ARGUMENT for an unknown view, an unusable angle or margin. */
CW_API cw_status cw_camera_fit(const cw_fit_desc *desc, cw_camera *camera, cw_error *err);

/* The picture's axes in the world, unit length. Returns CW_ERR_ARGUMENT when eye and target
 * coincide, up is along the line of sight, or angle and height make no picture. */
CW_API cw_status cw_camera_axes(const cw_camera *camera, double right[3], double up[3],
                                 double forward[3], cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
