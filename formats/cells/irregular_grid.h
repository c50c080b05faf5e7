/* Irregular grids: the description of their arrays by a header, and the common reader that
 * makes a volume with cells from it. */
#ifndef FORMATS_CELLS_IRREGULAR_GRID_H
#define FORMATS_CELLS_IRREGULAR_GRID_H

#include "formats/cells/grid_arrays.h"

/* The arrays of a piece. Kinds and corners of cells are numbered as in VTK. */
typedef enum cwi_grid_role {
    CWI_GRID_POINTS, /* three numbers each */
    CWI_GRID_TYPES,  /* the kind of each cell */
    CWI_GRID_ENDS,   /* end of each cell's corners among all */
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
    int64_t low[3]; /* of such a grid: number of the first point along each axis of the whole */
    size_t listed;  /* length of a list of corners where each cell's count precedes its
                        corners, and there are no ends; else 0 */
    bool has_point_marks, has_cell_marks;
    bool marks_are_levels; /* cells have vtkGhostLevels, as older files do, not vtkGhostType */
} cwi_grid_piece;

/* The description of a grid by its header. Everything in it is borrowed. */
typedef struct cwi_irregular {
    const cwi_grid_piece *pieces;
    size_t piece_count;
    const char *point_field; /* name of the number of points in the file, for messages */
    const char *array;       /* the name of the array of values */
    cw_type type;
    size_t components;
    bool of_cells; /* the array has one value per cell */

    /* Describes an array of a piece, of `count` tuples, for cwi_tuples_load(). */
    cw_status (*describe)(const void *file, size_t piece, cwi_grid_role role, size_t count,
                          cwi_source *src, bool *wide, cw_error *err);
    const void *file;

    /* Opens the file of a piece, with its name as the path; NULL: all are in one file. */
    cw_status (*open)(const void *file, size_t piece, const cwi_input **in, cw_error *err);
    uint64_t file_bytes; /* of these files together; 0: there is one file */
} cwi_irregular;

/* Computes the numbers of points and cells of a curvilinear grid. field: its name in the file.
 * Returns CW_ERR_FORMAT when it is flat, CW_ERR_LIMIT */
CW_NODISCARD cw_status cwi_grid_along(cwi_grid_piece *piece, const char *field, cw_error *err);

/* Reads the grid, with the kinds of cells that we have; notes left-out cells and merged
 * samples. Samples that are the same in place and value, such as along the seams of pieces,
 * become one. Values of cells are averaged around each sample. A header alone has the samples
 * and shapes that the file counts, but neither points nor corners.
 *
 * Returns  as cw_volume_read() */
CW_NODISCARD cw_status cwi_irregular_read(const cwi_irregular *grid, const cwi_input *in,
                                          const cw_read_desc *desc, cw_volume *volume,
                                          cw_error *err);

#endif
