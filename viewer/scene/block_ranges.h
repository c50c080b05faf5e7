/* The lowest and highest value in each block of cells, so that empty blocks are skipped. */
#ifndef VIEWER_SCENE_BLOCK_RANGES_H
#define VIEWER_SCENE_BLOCK_RANGES_H

#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_RANGE_EDGE = 4 }; /* cells along a side of a block */

/* Block (i, j, k) has the cells from 4 (i, j, k) on, and the samples around these. */
typedef struct cwi_ranges {
    size_t dim[3];
    float (*blocks)[2]; /* x fastest: scaled values, rounded outward; low > high: no values */
    bool has_gaps;      /* some sample has no value */
} cwi_ranges;

/* Finds the ranges of a resolved, evenly spaced volume. CW_ERR_NO_MEMORY, CW_ERR_CANCELLED. */
CW_NODISCARD cw_status cwi_ranges_make(const cw_volume *volume, int threads,
                                       const cw_progress *progress, cwi_ranges *ranges,
                                       cw_error *err);
/* Joins blocks into blocks of twice the edge. CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_ranges_halve(const cwi_ranges *fine, cwi_ranges *coarse,
                                        cw_error *err);
void cwi_ranges_free(cwi_ranges *ranges);

/* Finds for each block the distance in blocks, along the longest axis, to the next visible one,
 * up to 255. It is 0 if the block is visible itself, as is_visible(context, low, high) reports.
 * distances  free it with cwi_free()
 * Returns    CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_ranges_distances(
    const cwi_ranges *ranges, bool (*is_visible)(const void *context, double low, double high),
    const void *context, uint8_t **distances, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
