/* Colours of a mesh, wherever it is drawn: tints, and a measure of a triangle's shape. */
#ifndef VIEWER_SCENE_MESH_TINT_H
#define VIEWER_SCENE_MESH_TINT_H

#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Computes a colour of the ramp from dark to bright, for 0 to 1. Lightness (CIE L*) rises
 * evenly from 18 to 92, while the hue goes from violet over blue and green to yellow. The
 * chroma is within sRGB throughout. */
void cwi_ramp_color(double fraction, double srgb[3]);

/* Returns 4 sqrt(3) area / sum of squared edges: 1 for an equilateral triangle, 0 for a flat
 * one. */
double cwi_triangle_shape(const cw_mesh *mesh, size_t triangle);

/* Finds the values at the ends of the ramp. Returns CW_ERR_ARGUMENT when the scene's tint is
 * unknown, or needs scalars that the mesh does not have, or its range is empty. */
CW_NODISCARD cw_status cwi_tint_range(const cw_scene *scene, double range[2], cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
