/* Blocks of VTK's lists of data sets (.vtm, .vtmb, .vtpc, .vtpd): their names and files. */
#ifndef FORMATS_VTK_VTK_BLOCKS_H
#define FORMATS_VTK_VTK_BLOCKS_H

#include "formats/vtk/vtk_sides.h"

typedef enum cwi_vtk_block_kind {
    CWI_VTK_BLOCK_SURFACE, /* PolyData */
    CWI_VTK_BLOCK_IMAGE,   /* ImageData, RectilinearGrid */
    CWI_VTK_BLOCK_CELLS,   /* UnstructuredGrid, StructuredGrid */
    CWI_VTK_BLOCK_OTHER
} cwi_vtk_block_kind;

/* A block: a file, or several that hold its pieces. */
typedef struct cwi_vtk_block {
    size_t first, count; /* its files */
    cwi_vtk_block_kind kind;
} cwi_vtk_block;

/* The blocks with files; those without any are empty, and left out. A zeroed list has none. */
typedef struct cwi_vtk_blocks {
    cwi_vtk_block *items;
    size_t count, capacity;
    cwi_names paths; /* of blocks: their names, from the outermost on, with '/' between them */
    cwi_names files; /* of all blocks, one after another */
    cwi_vtk_sides sides; /* those files */
    uint64_t bytes;      /* of all of them */
} cwi_vtk_blocks;

/* Returns true for such a list. */
bool cwi_vtk_blocks_sniff(const unsigned char *head, size_t size);

/* Reads the list, and looks at its files. Free it, also after failure.
 * list  stays open and where it is, until the blocks are freed
 * Returns  CW_ERR_FORMAT; as cwi_vtk_sides_check() */
CW_NODISCARD cw_status cwi_vtk_blocks_read(const cwi_input *list, cwi_vtk_blocks *blocks,
                                           cw_error *err);
void cwi_vtk_blocks_free(cwi_vtk_blocks *blocks);

/* Counts blocks that are surfaces, or that are not. */
size_t cwi_vtk_blocks_count(const cwi_vtk_blocks *blocks, bool surfaces);

#endif
