/* The lines where slices have an isovalue. */
#ifndef VIEWER_IMAGE_ISOLINES_H
#define VIEWER_IMAGE_ISOLINES_H

#include "viewer/image/strokes.h"
#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Finds the isolines of a frame of slices by marching squares between the corners of pixels,
 * whose values are those of the trilinear field. A line's ends lie on it to 1/64 pixel.
 * frame    of a scene of slices without a mesh
 * image    whose pixels are meant, of any size with the frame's aspect ratio
 * strokes  at most a pixel long each, row by row; free with cwi_free()
 * Returns  CW_ERR_NO_MEMORY, CW_ERR_CANCELLED; as cwi_slices_of() */
CW_NODISCARD cw_status cwi_isolines_find(const cwi_frame *frame, const cw_image *image,
                                         double isovalue, cwi_stroke **strokes, size_t *count,
                                         cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
