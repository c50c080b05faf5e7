/* Coherent projection of rectilinear and irregular cells, on the CPU. */
#ifndef VIEWER_PROJECTION_UNEVEN_PROJECTION_H
#define VIEWER_PROJECTION_UNEVEN_PROJECTION_H

#include "viewer/rays/cell_tree.h"
#include "viewer/scene/frame_setup.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Draws a frame as cwi_reference_draw(). tree: of an irregular grid, with gradients if the
 * frame needs them; unused on a rectilinear grid.
 * Returns CW_ERR_LIMIT for 2^32 cells or more; CW_ERR_UNSUPPORTED for linear_opacity;
 * CW_ERR_NO_MEMORY; CW_ERR_CANCELLED. */
CW_NODISCARD cw_status cwi_uneven_projection_draw(const cwi_frame *frame,
                                                  const cwi_cell_tree *tree,
                                                  const double *depths, cw_picture *picture,
                                                  cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
