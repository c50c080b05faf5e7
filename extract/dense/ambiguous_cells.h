/* Ambiguous cells of a grid: their values, their plans, and their inner vertices. */
#ifndef EXTRACT_DENSE_AMBIGUOUS_CELLS_H
#define EXTRACT_DENSE_AMBIGUOUS_CELLS_H

#include "core/cases/cell_topology.h"
#include "extract/dense/isa_dispatch.h"

/* Returns a padded sample as the decisions see it: its number minus the isovalue, positive
 * inside; NaN where there is none. */
double cwi_value_at(const cwi_bit_grid *grid, size_t i, size_t j, size_t k);

/* Finds these values at the eight corners of a cell. */
void cwi_corner_values(const cwi_bit_grid *grid, const size_t at[3], double values[8]);

/* Returns true if a sample on the isovalue is inside. */
static inline bool cwi_zero_is_inside(const cwi_bit_grid *grid)
{
    return grid->invert == grid->strict;
}

/* Finds the plan of the cell at padded sample at[], whose case the signs alone do not settle,
 * and notes it at the end of its layer's list. */
void cwi_ambiguous_plan(const cwi_bit_grid *grid, const size_t at[3], unsigned cube,
                        cwi_cell_plan *plan);

/* Builds the cell's surface and writes its inner vertices, numbered from first on. The plan is
 * the n-th that was noted in its layer. */
void cwi_ambiguous_build(const cwi_bit_grid *grid, const size_t at[3], unsigned cube, size_t n,
                         cwi_vertex_sink *sink, size_t first, cwi_cell_plan *plan,
                         cwi_cell *out);

#endif
