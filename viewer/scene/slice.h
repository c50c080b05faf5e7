/* Planes through a volume. */
#ifndef VIEWER_SCENE_SLICE_H
#define VIEWER_SCENE_SLICE_H

#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Finds the scene's slices, or the default: axial, coronal, sagittal through the volume's
 * middle. The normals are of unit length. CW_ERR_ARGUMENT for a slice without direction or
 * place. */
CW_NODISCARD cw_status cwi_slices_of(const cw_scene *scene, const cw_volume *volume,
                                     cw_slice slices[CW_MAX_SLICES], size_t *count,
                                     cw_error *err);

/* Finds the colour of the frame of slices in a direction: axial red, coronal green, sagittal
 * yellow, oblique violet; sRGB. */
void cwi_slice_color(const cw_slice *slice, double srgb[3]);

/* Finds the nearest of the slices (normals of unit length) that has a value on a ray in eye
 * space, and its number. INFINITY: there is none. */
double cwi_slice_hit(const cwi_frame *frame, const cw_slice *slices, size_t count,
                     const double origin[3], const double direction[3], size_t *number);

#ifdef __cplusplus
}
#endif

#endif
