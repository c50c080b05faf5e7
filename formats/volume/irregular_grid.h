/* Irregular grids: what a header says of their arrays, and the one way from there to a volume
 * with cells. */
#ifndef FORMATS_VOLUME_IRREGULAR_GRID_H
#define FORMATS_VOLUME_IRREGULAR_GRID_H

#include "formats/volume/grid_arrays.h"

/* Arrays of a piece. Cells are as VTK numbers their kinds and corners. */
typedef enum cwi_grid_role {
    CWI_GRID_POINTS, /* three numbers each */
    CWI_GRID_TYPES,  /* the kind of each cell */
    CWI_GRID_ENDS,   /* where its corners end among all */
    CWI_GRID_CORNERS,
    CWI_GRID_VALUES,
    CWI_GRID_POINT_MARKS, /* vtkGhostType */
    CWI_GRID_CELL_MARKS,
    CWI_GRID_ROLE_COUNT
} cwi_grid_role;

typedef struct cwi_grid_piece {
    size_t points, cells;
    size_t along[3]; /* points along x, y, z of a curvilinear grid, which has neither types nor
                        corners; else 0 */
    size_t listed;   /* numbers in a list of corners that has their count in front of each cell,
                        and no ends; else 0 */
    bool has_point_marks, has_cell_marks;
} cwi_grid_piece;

/* What a header says. Everything in it is borrowed. */
typedef struct cwi_irregular {
    const cwi_grid_piece *pieces;
    size_t piece_count;
    const char *point_field; /* where the file counts points, for messages */
    const char *array;       /* the name of that with the values */
    cw_type type;
    size_t components;
    bool of_cells; /* it has a value for each cell */

    /* Describes an array of a piece, of so many tuples, for cwi_tuples_load(). */
    cw_status (*describe)(const void *file, size_t piece, cwi_grid_role role, size_t count,
                          cwi_source *src, bool *wide, cw_error *err);
    const void *file;
} cwi_irregular;

/* How many points and cells a curvilinear grid has. field: where the file says so.
 * Returns CW_ERR_FORMAT when it is flat, CW_ERR_LIMIT */
CW_NODISCARD cw_status cwi_grid_along(cwi_grid_piece *piece, const char *field, cw_error *err);

/* Reads the grid, with the kinds of cells that we have; notes what is left out or merged.
 * Samples that are the same in place and value, as pieces have along their seams, become one.
 * Values of cells are averaged around each sample. A header alone has the samples that the file
 * counts and shapes, but neither points nor corners.
 *
 * Returns  as cw_volume_read() */
CW_NODISCARD cw_status cwi_irregular_read(const cwi_irregular *grid, const cwi_input *in,
                                          const cw_read_desc *desc, cw_volume *volume,
                                          cw_error *err);

#endif
