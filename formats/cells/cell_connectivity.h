/* The corners of cells as VTK lists them, read cell by cell. */
#ifndef FORMATS_CELLS_CELL_CONNECTIVITY_H
#define FORMATS_CELLS_CELL_CONNECTIVITY_H

#include "formats/cells/grid_arrays.h"

typedef struct cwi_corner_list {
    cwi_tuples numbers;
    cwi_tuples ends; /* end of each cell's numbers */
    bool counted;    /* there are no ends; each cell's count stands before its numbers */
    size_t points;   /* number of points */
    const char *point_field; /* name of the field with the number of points, for messages */
    size_t cell, at;         /* the next cell, and the start of its numbers */
} cwi_corner_list;

/* Reads the corners of the next cell in the order of our shapes, and adds base to each number.
 * A cell of type CWI_VTK_EMPTY gives none.
 * type   a type that cwi_cell_kind_find() knows, and that is not left out
 * to     room for 8
 * count  set to the number of corners
 * Returns CW_ERR_FORMAT */
CW_NODISCARD cw_status cwi_corner_list_next(cwi_corner_list *list, uint8_t type, size_t base,
                                            uint32_t *to, size_t *count, cw_error *err);

#endif
