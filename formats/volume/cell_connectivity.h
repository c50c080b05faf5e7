/* The corners of cells as VTK lists them, taken one cell after another. */
#ifndef FORMATS_VOLUME_CELL_CONNECTIVITY_H
#define FORMATS_VOLUME_CELL_CONNECTIVITY_H

#include "formats/volume/grid_arrays.h"

typedef struct cwi_corner_list {
    cwi_tuples numbers;
    cwi_tuples ends; /* where each cell's end among the numbers */
    bool counted;    /* there are no ends; the count of each cell's stands in front of them */
    size_t points;   /* that there are to be corners */
    const char *point_field; /* where the file counts those, for messages */
    size_t cell, at;         /* the next, and where its numbers start */
} cwi_corner_list;

/* Takes the corners of the next cell as one of our shapes has them, each with base added to its
 * number; of a cell of type CWI_VTK_EMPTY none.
 * type   one that cwi_cell_kind_find() knows, and that is not left out
 * to     room for 8
 * count  set to how many were taken
 * Returns CW_ERR_FORMAT */
CW_NODISCARD cw_status cwi_corner_list_next(cwi_corner_list *list, uint8_t type, size_t base,
                                            uint32_t *to, size_t *count, cw_error *err);

#endif
