/* Box and mean cell of a grid: the measures from which a frame takes its unit. */
#ifndef VIEWER_SCENE_CELLS_SIZE_H
#define VIEWER_SCENE_CELLS_SIZE_H

#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Measures of an irregular grid, in the frame of its points. Cells with a point that is not
 * finite are left out. */
typedef struct cwi_cells_size {
    double low[3], high[3]; /* box around the corners of cells; both 0 without cells */
    double volume;          /* of all cells */
    double boxes; /* the number of cells, in boxes: a hexahedron counts 1, a wedge 1/2,
                               a pyramid 1/3, a tetrahedron 1/6 */
} cwi_cells_size;

/* Measures a resolved irregular grid. The result is the same for any number of threads.
 * Returns CW_ERR_ARGUMENT for a shape or a corner that does not exist; CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_cells_measure(const cw_volume *volume, int threads,
                                         cwi_cells_size *size, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
