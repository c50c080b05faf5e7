/* Intensity projections: one value a ray, exact for the trilinear field. */
#ifndef VIEWER_CPU_INTENSITY_PROJECTION_H
#define VIEWER_CPU_INTENSITY_PROJECTION_H

#include "viewer/scene/block_ranges.h"
#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Draws CW_MODE_MIP, CW_MODE_MINIP, CW_MODE_AVERAGE and CW_MODE_LOCAL_MIP, as
 * cwi_reference_draw(). ranges: of the frame's volume, to skip blocks; NULL: every cell is
 * visited */
CW_NODISCARD cw_status cwi_intensity_draw(const cwi_frame *frame, const cwi_ranges *ranges,
                                          const double *depths, cw_picture *picture,
                                          cw_error *err);

/* Returns the value of the frame's mode along the ray through a point of the picture; NaN where
 * the ray meets no value. */
double cwi_intensity_ray(const cwi_frame *frame, const cwi_ranges *ranges, double x, double y,
                         double depth);

#ifdef __cplusplus
}
#endif

#endif
