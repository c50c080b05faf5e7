/* Ray casting cell by cell, in single precision: as exact as a picture of bytes can show, and
 * fast. */
#ifndef VIEWER_CPU_VBUFFER_H
#define VIEWER_CPU_VBUFFER_H

#include "viewer/rays/cell_tree.h"
#include "viewer/scene/block_ranges.h"
#include "viewer/scene/frame_setup.h"
#include "viewer/scene/mean_cells.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Draws a frame as cwi_reference_draw(). ranges: of the frame's volume, if it is evenly
 * spaced; tree: of an irregular grid; cells: means of an evenly spaced volume, if
 * cwi_beams_need_means() */
CW_NODISCARD cw_status cwi_vbuffer_draw(const cwi_frame *frame, const cwi_ranges *ranges,
                                        const cwi_cell_tree *tree, const cwi_mean_cells *cells,
                                        const double *depths, cw_picture *picture,
                                        cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
