/* The lowest and highest value in each block of cells, so that what is empty is passed over. */
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

/* Of a resolved, evenly spaced volume. CW_ERR_NO_MEMORY, CW_ERR_CANCELLED. */
CW_NODISCARD cw_status cwi_ranges_make(const cw_volume *volume, int threads,
                                       const cw_progress *progress, cwi_ranges *ranges,
                                       cw_error *err);
/* Blocks of twice the edge. CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_ranges_halve(const cwi_ranges *fine, cwi_ranges *coarse,
                                        cw_error *err);
void cwi_ranges_free(cwi_ranges *ranges);

/* For each block: how many blocks away, along the longest axis, the next visible one is, up to
 * 255; 0: it is visible itself, as told by is_visible(context, low, high).
 * distances  free it with cwi_free()
 * Returns    CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_ranges_distances(
    const cwi_ranges *ranges, bool (*is_visible)(const void *context, double low, double high),
    const void *context, uint8_t **distances, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
