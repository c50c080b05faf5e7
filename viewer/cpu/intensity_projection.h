/* Intensity projections: one value a ray, exact for the trilinear field. */
#ifndef VIEWER_CPU_INTENSITY_PROJECTION_H
#define VIEWER_CPU_INTENSITY_PROJECTION_H

#include "viewer/rays/ray_spans.h"
#include "viewer/scene/block_ranges.h"
#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Draws CW_MODE_MIP, CW_MODE_MINIP, CW_MODE_AVERAGE and CW_MODE_LOCAL_MIP, as
 * cwi_reference_draw(). ranges: of the frame's volume, if it is evenly spaced, to skip blocks;
 * NULL: every cell is visited. tree: of an irregular grid */
CW_NODISCARD cw_status cwi_intensity_draw(const cwi_frame *frame, const cwi_ranges *ranges,
                                          const cwi_cell_tree *tree, const double *depths,
                                          cw_picture *picture, cw_error *err);

/* Returns the value of the frame's mode along the ray through a point of the picture; NaN where
 * the ray meets no value. The second is for grids that are not evenly spaced. */
double cwi_intensity_ray(const cwi_frame *frame, const cwi_ranges *ranges, double x, double y,
                         double depth);
double cwi_intensity_spans(const cwi_field *field, cwi_spans *spans, double x, double y,
                           double depth);

#ifdef __cplusplus
}
#endif

#endif
