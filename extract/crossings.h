/* Which edges of a row carry vertices, 64 at a time. */
#ifndef EXTRACT_CROSSINGS_H
#define EXTRACT_CROSSINGS_H

#include "extract/grid.h"

/* Live cells of word w in row (j, k) of cells; none outside the grid. */
static inline uint64_t cwi_live_cells(const cwi_grid *g, size_t j, size_t k, size_t w)
{
    if (j >= g->rows_y - 1 || k >= g->rows_z - 1) /* true for the row before the first, too */
        return 0;
    return g->live[(k * g->rows_y + j) * g->words + w];
}

/* With open borders an edge has a vertex only if one of the four cells around it is live. */
static inline uint64_t cwi_live_edges(const cwi_grid *g, int axis, size_t j, size_t k, size_t w)
{
    if (axis == 0)
        return cwi_live_cells(g, j, k, w) | cwi_live_cells(g, j - 1, k, w) |
               cwi_live_cells(g, j, k - 1, w) | cwi_live_cells(g, j - 1, k - 1, w);
    const size_t dj = axis == 2, dk = axis == 1;
    const uint64_t here = cwi_live_cells(g, j, k, w) | cwi_live_cells(g, j - dj, k - dk, w);
    const uint64_t before =
        w ? cwi_live_cells(g, j, k, w - 1) | cwi_live_cells(g, j - dj, k - dk, w - 1) : 0;
    return here | here << 1 | before >> 63;
}

/* Of a block: the edges of live cells along axis from row (j, k). */
static inline const uint64_t *cwi_window(const cwi_grid *g, int axis, size_t j, size_t k)
{
    return g->window + ((size_t)axis + 1) * g->rows + k * g->rows_y + j;
}

/* Bit i: there is a vertex on the edge along axis from sample i of row (j, k). */
static inline uint64_t cwi_edge_vertices(const cwi_grid *g, int axis, size_t j, size_t k,
                                         size_t w)
{
    const uint64_t crossed = cwi_grid_crossed(g, axis, j, k, w);
    if (g->window)
        return crossed & *cwi_window(g, axis, j, k);
    return g->live ? crossed & cwi_live_edges(g, axis, j, k, w) : crossed;
}

/* Padded index n along an axis is that of a voxel with two after it and one before it, or two
 * for cubics. */
static inline bool cwi_is_inner(const cwi_grid *g, int axis, size_t n)
{
    return n >= (g->cubic ? 3 : 2) && n + 2 <= g->volume.dim[axis];
}

/* Bits of word w of a row at which cwi_is_inner() holds along x. */
static inline uint64_t cwi_inner_word(const cwi_grid *g, size_t w)
{
    const size_t begin = 64 * w, end = g->volume.dim[0] - 1; /* inner: up to end - 1 */
    if (begin >= end)
        return 0;
    const uint64_t low = w ? ~UINT64_C(0) : g->cubic ? ~UINT64_C(7) : ~UINT64_C(3);
    return end - begin < 64 ? low & ((UINT64_C(1) << (end - begin)) - 1) : low;
}

/* Both ends of the edge along axis from a padded index are voxels. */
static inline bool cwi_is_edge(const cw_volume *v, int axis, const size_t index[3])
{
    bool within = true;
    for (int a = 0; a < 3; a++)
        within = within && index[a] >= 1 && index[a] + (a == axis) <= v->dim[a];
    return within;
}

#endif
