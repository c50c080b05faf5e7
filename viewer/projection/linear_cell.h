/* Opacity that is linear over the triangles of a projected cell, as graphics hardware
 * interpolated it in 1991 [Wilhelms1991]. */
#ifndef VIEWER_PROJECTION_LINEAR_CELL_H
#define VIEWER_PROJECTION_LINEAR_CELL_H

#include "viewer/projection/cell_color.h"
#include "viewer/proxy/projected_cells.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_LINEAR_TRIANGLES = CWI_PIECE_INDICES / 3 };

/* A triangle: the weights of its second and third corner are linear over the picture. */
typedef struct cwi_linear_triangle {
    float at[2], second[2], third[2];
    cwi_lanes color, to_second, to_third; /* of the first corner, and differences from it */
} cwi_linear_triangle;

/* A cell's triangles. In orthographic views the pieces of all cells of a size are the same but
 * for a shift. */
typedef struct cwi_linear_cell {
    const cwi_frame *frame;
    const cwi_cell_tables *tables;
    size_t tile[2]; /* the sample of the picture where positions begin */
    bool is_made;
    cwi_lanes size; /* of the cell that pieces belong to, when they are the same for all */
    cwi_pieces pieces;
    cwi_lanes front[CWI_PIECE_VERTICES], back[CWI_PIECE_VERTICES]; /* positions in the cell */
    size_t count;
    cwi_linear_triangle triangles[CWI_LINEAR_TRIANGLES];
} cwi_linear_cell;

/* Makes the triangles of a cell. */
void cwi_linear_make(cwi_linear_cell *linear, const cwi_projected_cell *cell);

/* Returns the premultiplied colour of the whole way through the cell, at a position of the tile. */
cwi_lanes cwi_linear_at(const cwi_linear_cell *linear, float x, float y);

#ifdef __cplusplus
}
#endif

#endif
