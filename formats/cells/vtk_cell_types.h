/* The kinds of cells that VTK numbers, and their use here. */
#ifndef FORMATS_CELLS_VTK_CELL_TYPES_H
#define FORMATS_CELLS_VTK_CELL_TYPES_H

#include <cubewright/volume.h>

typedef enum cwi_cell_use {
    CWI_CELL_UNKNOWN,
    CWI_CELL_FLAT,    /* fewer than three dimensions: left out */
    CWI_CELL_REFUSED, /* has faces that none of our shapes has */
    CWI_CELL_LINEAR,
    CWI_CELL_VOXEL, /* a hexahedron with the corners of each square in rows */
    CWI_CELL_CURVED /* has points between its corners, too; the corners come first */
} cwi_cell_use;

typedef struct cwi_cell_kind {
    const char *name;
    cwi_cell_use use;
    cw_shape shape; /* of the last three */
} cwi_cell_kind;

/* VTK's number for cells that have no number in the file. */
enum { CWI_VTK_EMPTY = 0, CWI_VTK_HEXAHEDRON = 12 };

/* Finds the kind of a number; NULL when there is none. */
const cwi_cell_kind *cwi_cell_kind_find(int64_t type);

/* Returns the number of corners of a shape. */
size_t cwi_shape_corners(cw_shape shape);

#endif
