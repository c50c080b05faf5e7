/* Draws the mode mesh without GL. */
#ifndef VIEWER_CPU_CPU_MESH_H
#define VIEWER_CPU_CPU_MESH_H

#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Draws a frame's mesh by reference_mesh.c into a picture of the frame's size: opaque, whole,
 * in its colours or tints.
 * Colours are rounded to bytes.
 *
 * depth_mm  see cw_render_mesh_desc; may be NULL
 * Returns   CW_ERR_UNSUPPORTED for settings that only GL draws: translucent meshes, clip
 *           planes, edges, a depth cue, lights and materials; CW_ERR_ARGUMENT as
 *           cwi_tint_range(); CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_cpu_draw_mesh(const cwi_frame *frame, double *depth_mm,
                                         cw_picture *picture, cw_error *err);

/* Returns words for a setting of the frame's mesh that the CPU does not draw, such as
 * "translucent"; NULL: it draws all of them. */
const char *cwi_cpu_mesh_refusal(const cwi_frame *frame);

#ifdef __cplusplus
}
#endif

#endif
