/* Draws a volume by coherent projection [Wilhelms1991] on the CPU. */
#ifndef VIEWER_PROJECTION_CELL_PROJECTION_H
#define VIEWER_PROJECTION_CELL_PROJECTION_H

#include "viewer/projection/cell_color.h"
#include "viewer/scene/block_ranges.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Draws a frame into a picture of its size.
 *
 * ranges  of the frame's volume
 * tables  kept from the last picture, or zeroed
 * depths  width x height depths in units of eye space at which rays end; NULL: nowhere
 * Returns CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost    in proportion to the visible cells, and to the samples in which they are before
 *         stop_opacity is reached
 * Threads the same picture to the bit for any number of threads */
CW_NODISCARD cw_status cwi_projection_draw(const cwi_frame *frame, const cwi_ranges *ranges,
                                           cwi_cell_tables *tables, const double *depths,
                                           cw_picture *picture, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
