/* Decides which points of an even grid are inside a closed, oriented mesh. */
#ifndef EXTRACT_LEVEL_SET_WINDING_ROWS_H
#define EXTRACT_LEVEL_SET_WINDING_ROWS_H

#include <cubewright/mesh.h>

/* The crossings of rows of samples along x with the mesh. Those of row (j, k) are
 * cross[first[k * rows_y + j]] up to that of the next row, from low x to high. */
typedef struct cwi_row_crossing {
    double x;
    int turn; /* 1: the mesh winds once more around the points behind it; -1: once less */
} cwi_row_crossing;

typedef struct cwi_winding {
    size_t rows_y, rows_z;
    size_t *first; /* rows_y * rows_z + 1 */
    cwi_row_crossing *cross;
} cwi_winding;

/* Maximum number of samples along an axis: so that computed numbers fit 64 bits. */
enum { CWI_WINDING_MAX = 65535 };

/* Crosses a mesh, whose vertices in the grid are at (positions - first) / voxel_mm, with rows.
 * Free with cwi_winding_free(), also after an error. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_winding_init(cwi_winding *w, const cw_mesh *mesh,
                                        const double first[3], double voxel_mm,
                                        const size_t dim[3], cw_error *err);
void cwi_winding_free(cwi_winding *w);

/* Finds which samples of a row, `count` of them from sample (i, j, k) on, are inside: the mesh
 * winds around them at least once. */
void cwi_winding_row(const cwi_winding *w, size_t i, size_t j, size_t k, size_t count,
                     bool *inside);

#endif
