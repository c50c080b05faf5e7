/* Means over ever larger cells of a volume, for pixels that cover more than one of its cells. */
#ifndef VIEWER_SCENE_MEAN_CELLS_H
#define VIEWER_SCENE_MEAN_CELLS_H

#include "viewer/scene/block_ranges.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_MEAN_LEVELS = 32 };

/* A lattice of mean cells: each is 2^shift cells of the volume along an axis, at the far border
 * as many as there are. */
typedef struct cwi_mean_level {
    size_t dim[3];
    int shift[3];
    float (*moments)[4];   /* x fastest: the fraction that has values, and that fraction times
                            the mean, and times the mean square; 0 */
    float (*gradients)[4]; /* the same fraction times the mean gradient in stored values per
                              voxel; 0. NULL: none are kept */
} cwi_mean_level;

/* The means of a volume. A cell of level n is about 2^n smallest spacings wide along each axis:
 * axes of wide spacing are joined later. Level 0 are the volume's own cells, and it holds
 * nothing; the last level has one cell. Zeroed: there are none. */
typedef struct cwi_mean_cells {
    double origin, scale; /* a value is origin + scale times the stored one */
    size_t level_count;
    bool has_gradients;
    cwi_mean_level levels[CWI_MEAN_LEVELS];
} cwi_mean_cells;

/* Makes the means of a resolved, evenly spaced volume, of the trilinear field in each cell;
 * about 2.3 bytes a voxel, 4.6 with gradients. Mixed terms are left out of mean squares.
 * CW_ERR_NO_MEMORY, CW_ERR_CANCELLED. */
CW_NODISCARD cw_status cwi_mean_cells_make(const cw_volume *volume, const cwi_ranges *ranges,
                                           bool has_gradients, int threads,
                                           const cw_progress *progress, cwi_mean_cells *cells,
                                           cw_error *err);
void cwi_mean_cells_free(cwi_mean_cells *cells);

#ifdef __cplusplus
}
#endif

#endif
