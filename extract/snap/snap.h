/* Merges crossings that stand close to the same sample, so that the needles between them
 * vanish. */
#ifndef EXTRACT_SNAP_SNAP_H
#define EXTRACT_SNAP_SNAP_H

#include "extract/dense/bit_planes.h"

#include <cubewright/mesh.h>

/* Returns the bytes that snapping a mesh with these counts takes, beside the mesh. */
size_t cwi_snap_bytes(const cwi_bit_grid *grid, size_t vertices, size_t triangles);

/* Snaps a mesh that was just written from a grid and its rows. desc->snap is above 0. */
CW_NODISCARD cw_status cwi_snap(const cwi_bit_grid *grid, const cwi_row *rows,
                                const cw_extract_desc *desc, cw_mesh *mesh,
                                cw_snap_counts *counts, cw_error *err);

#endif
