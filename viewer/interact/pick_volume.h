/* The point of a volume that is seen along a ray. */
#ifndef VIEWER_INTERACT_PICK_VOLUME_H
#define VIEWER_INTERACT_PICK_VOLUME_H

#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A point of the volume on a ray. */
typedef struct cwi_volume_hit {
    double t;       /* along the ray, in eye space; INFINITY: there is none */
    double opacity; /* of the whole ray's volume: 1 for an intensity projection */
    double value;   /* there; NaN: not known */
} cwi_volume_hit;

/* Find the point that blending modes, and intensity projections, show at a point of the
 * picture, in samples, up to a depth. */
cwi_volume_hit cwi_pick_blended(const cwi_frame *frame, double x, double y, double depth);
cwi_volume_hit cwi_pick_intensity(const cwi_frame *frame, double x, double y, double depth);

/* Finds the same, for any mode that draws rectilinear and irregular grids.
 * Returns CW_ERR_NO_MEMORY, CW_ERR_CANCELLED. */
CW_NODISCARD cw_status cwi_pick_uneven(const cwi_frame *frame, double x, double y, double depth,
                                       cwi_volume_hit *hit, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
