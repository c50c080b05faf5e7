/* Cells that several pieces of a curvilinear grid have. */
#ifndef FORMATS_CELLS_GRID_OVERLAP_H
#define FORMATS_CELLS_GRID_OVERLAP_H

#include "formats/cells/irregular_grid.h"

/* Sets the types of cells that an earlier piece has to CWI_VTK_EMPTY. Cells are the same where their place
 * in the whole is. Pieces that are scattered over a whole far larger than all of them are not compared.
 * types    of the cells of all pieces
 * left_out increased by their number
 * Returns  CW_ERR_NO_MEMORY; takes a bit for each cell of the whole */
CW_NODISCARD cw_status cwi_grid_leave_out_repeated(const cwi_grid_piece *pieces, size_t count,
                                                   uint8_t *types, size_t *left_out,
                                                   cw_error *err);

#endif
