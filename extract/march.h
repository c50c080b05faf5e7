/* The two passes over the bit planes: count, then write. */
#ifndef EXTRACT_MARCH_H
#define EXTRACT_MARCH_H

#include "extract/grid.h"

/* Counts each row's vertices and triangles and turns the counts into first numbers, in place.
 * rows has grid->rows elements. */
cw_status cwi_march_count(const cwi_grid *grid, const cw_extract_desc *desc, cwi_row *rows,
                          size_t *vertices, size_t *triangles, cw_error *err);

/* Writes every vertex, normal and triangle to its place. The mesh has the counted size. */
cw_status cwi_march_write(const cwi_grid *grid, const cw_extract_desc *desc,
                          const cwi_row *rows, cw_mesh *mesh, cw_error *err);

#endif
