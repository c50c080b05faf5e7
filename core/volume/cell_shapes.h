/* Corners, edges and faces of the cells of irregular grids, numbered as cw_cells lists corners
 * (VTK's order). */
#ifndef CORE_VOLUME_CELL_SHAPES_H
#define CORE_VOLUME_CELL_SHAPES_H

#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_SHAPE_CORNERS = 8, CWI_SHAPE_EDGES = 12, CWI_SHAPE_FACES = 6 };

typedef struct cwi_cell_shape {
    uint8_t corner_count, edge_count, face_count;
    uint8_t edges[CWI_SHAPE_EDGES][2];
    uint8_t face_size[CWI_SHAPE_FACES];
    uint8_t faces[CWI_SHAPE_FACES][4]; /* around each; a triangle's last is its first */
} cwi_cell_shape;

extern const cwi_cell_shape cwi_cell_shapes[CW_SHAPE_COUNT];

/* Finds where the corners of each chunk of `chunk` cells begin in cw_cells.corners, so that
 * chunks can be read independently.
 * starts   as many as there are chunks; free it with cwi_free()
 * Returns  CW_ERR_ARGUMENT for a shape that does not exist; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_cell_chunks(const cw_cells *cells, size_t chunk, size_t **starts,
                                       cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
