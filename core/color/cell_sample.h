/* Values of an irregular grid at points. */
#ifndef CORE_COLOR_CELL_SAMPLE_H
#define CORE_COLOR_CELL_SAMPLE_H

#include "core/geometry/bvh.h"

#include <cubewright/volume.h>

/* Cells sorted by their boxes. Zeroed: none. */
typedef struct cwi_cell_sampler {
    const cw_volume *volume; /* resolved, with cells */
    cwi_boxes tree;          /* of the cells, relative to center */
    uint32_t *begin;         /* first corner of each cell in cw_cells.corners */
    double center[3];
} cwi_cell_sampler;

/* Sorts the cells of a volume.
 * sampler  filled; free it with cwi_cell_sampler_free(), also after failure
 * Returns  CW_ERR_LIMIT: too many cells; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_cell_sampler_build(const cw_volume *volume,
                                              cwi_cell_sampler *sampler, cw_error *err);
void cwi_cell_sampler_free(cwi_cell_sampler *sampler);

/* Returns the value at a world point: linear in the tetrahedra into which its cell is divided, so
 * linear along each edge. Up to a tenth of a cell outside the nearest value of it is taken. NaN:
 * farther outside, or a corner has no value */
double cwi_cell_sample(const cwi_cell_sampler *sampler, const double world[3]);

#endif
