/* Finds the edges of a row that have vertices, 64 at a time. */
#ifndef EXTRACT_DENSE_CROSSED_EDGES_H
#define EXTRACT_DENSE_CROSSED_EDGES_H

#include "extract/dense/bit_planes.h"

/* Returns the live cells of layer k: rows_y x words. Of a box, only two layers are stored. */
static inline const uint64_t *cwi_live_layer(const cwi_bit_grid *g, size_t k)
{
    const size_t inner = k >= 1 && k < g->volume.dim[2];
    return g->live + (g->live_is_box ? inner : k) * g->rows_y * g->words;
}

/* Returns true if all cells of row (j, k), but the padding at its ends, are live. Then edges
 * around them have vertices wherever they are crossed, except along x toward padding. */
static inline bool cwi_is_whole(const cwi_bit_grid *g, size_t j, size_t k)
{
    return g->live_is_box && j >= 1 && j < g->volume.dim[1] && k >= 1 && k < g->volume.dim[2];
}

/* Returns the live cells of word w in row (j, k) of cells; none outside the grid. */
static inline uint64_t cwi_live_cells(const cwi_bit_grid *g, size_t j, size_t k, size_t w)
{
    if (j >= g->rows_y - 1 || k >= g->rows_z - 1) /* true for the row before the first, too */
        return 0;
    return cwi_live_layer(g, k)[j * g->words + w];
}

/* Returns the edges around live cells. With open borders an edge has a vertex only if one of
 * the four cells around it is live. */
static inline uint64_t cwi_live_edges(const cwi_bit_grid *g, int axis, size_t j, size_t k,
                                      size_t w)
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

/* Returns, for a block, the edges of live cells along axis from row (j, k). */
static inline const uint64_t *cwi_edge_window(const cwi_bit_grid *g, int axis, size_t j,
                                              size_t k)
{
    return g->window + ((size_t)axis + 1) * g->rows + k * g->rows_y + j;
}

/* Returns the edges along axis from row (j, k) that may have vertices. */
static inline uint64_t cwi_edge_mask(const cwi_bit_grid *g, int axis, size_t j, size_t k,
                                     size_t w)
{
    if (g->window)
        return *cwi_edge_window(g, axis, j, k);
    if (!g->live || (axis != 0 && cwi_is_whole(g, j, k)))
        return ~UINT64_C(0);
    return cwi_is_whole(g, j, k) ? cwi_live_cells(g, j, k, w)
                                 : cwi_live_edges(g, axis, j, k, w);
}

/* Returns the edges with vertices; bit i: the edge along axis from sample i of row (j, k). */
static inline uint64_t cwi_edge_vertices(const cwi_bit_grid *g, int axis, size_t j, size_t k,
                                         size_t w)
{
    return cwi_grid_crossed(g, axis, j, k, w) & cwi_edge_mask(g, axis, j, k, w);
}

/* Returns true if padded index n along an axis is that of a voxel with two voxels after it and
 * one before it (two for cubics). */
static inline bool cwi_is_inner(const cwi_bit_grid *g, int axis, size_t n)
{
    return n >= (g->cubic ? 3 : 2) && n + 2 <= g->volume.dim[axis];
}

/* Returns bits `from` to `to` - 1 of a row, within the word whose lowest bit is `begin`. */
static inline uint64_t cwi_bits_between(size_t begin, size_t from, size_t to)
{
    uint64_t bits = ~UINT64_C(0);
    if (begin + 64 > to)
        bits = to > begin ? bits >> (begin + 64 - to) : 0;
    if (begin < from)
        bits = from - begin < 64 ? bits & ~UINT64_C(0) << (from - begin) : 0;
    return bits;
}

/* Returns the edges of the word at at[], along any axis, all of whose samples and their
 * neighbours are voxels. */
static inline uint64_t cwi_inner_edges(const cwi_bit_grid *g, const size_t at[3])
{
    if (!cwi_is_inner(g, 1, at[1]) || !cwi_is_inner(g, 2, at[2]))
        return 0;
    return cwi_bits_between(at[0], g->cubic ? 3 : 2, g->volume.dim[0] - 1);
}

/* Return word w of a row of samples moved up, or down, by a number of samples. */
static inline uint64_t cwi_moved_up(const uint64_t *row, size_t w, unsigned by)
{
    return row[w] << by | (w ? row[w - 1] >> (64 - by) : 0);
}

static inline uint64_t cwi_moved_down(const uint64_t *row, size_t w, unsigned by)
{
    return row[w] >> by | row[w + 1] << (64 - by);
}

/* Returns the samples of word w of an inner row (j, k) that have values, and whose six
 * neighbours have values. */
static inline uint64_t cwi_valued_samples(const cwi_bit_grid *g, size_t j, size_t k, size_t w)
{
    const size_t layer = g->rows_y * g->words;
    const uint64_t *row = g->has + k * layer + j * g->words;
    return row[w] & cwi_moved_up(row, w, 1) & cwi_next_samples(row, w) & *(row + w - g->words) &
           row[w + g->words] & *(row + w - layer) & row[w + layer];
}

/* Returns the samples of word w of an inner row (j, k) that have values, as have those one and
 * two away along both other axes. */
static inline uint64_t cwi_valued_crosses(const cwi_bit_grid *g, int axis, size_t j, size_t k,
                                          size_t w)
{
    const ptrdiff_t beside = (ptrdiff_t)g->words, above = beside * (ptrdiff_t)g->rows_y;
    const uint64_t *row = g->has + (k * g->rows_y + j) * g->words, *at = row + w;
    uint64_t valued = *at;
    for (int n = 1; n <= 2; n++) {
        if (axis != 0)
            valued &= cwi_moved_up(row, w, (unsigned)n) & cwi_moved_down(row, w, (unsigned)n);
        if (axis != 1)
            valued &= at[-n * beside] & at[n * beside];
        if (axis != 2)
            valued &= at[-n * above] & at[n * above];
    }
    return valued;
}

/* Returns the inner edges along an axis all of whose samples on cubics have values. */
static inline uint64_t cwi_valued_cubics(const cwi_bit_grid *g, int axis, const size_t at[3],
                                         uint64_t inner)
{
    const size_t w = at[0] / 64;
    if (axis == 0) {
        uint64_t row[3] = {0, cwi_valued_crosses(g, 0, at[1], at[2], w), 0};
        if (w)
            row[0] = cwi_valued_crosses(g, 0, at[1], at[2], w - 1);
        if (w + 1 < g->words)
            row[2] = cwi_valued_crosses(g, 0, at[1], at[2], w + 1);
        return inner & row[1] & cwi_moved_up(row, 1, 1) & cwi_next_samples(row, 1) &
               cwi_moved_down(row, 1, 2);
    }
    for (size_t n = 0; n < 4 && inner; n++)
        inner &= cwi_valued_crosses(g, axis, at[1] + (axis == 1 ? n - 1 : 0),
                                    at[2] + (axis == 2 ? n - 1 : 0), w);
    return inner;
}

/* Returns the inner edges along an axis, of the word at at[], whose samples, and the neighbours
 * of these, all have values. */
static inline uint64_t cwi_valued_edges(const cwi_bit_grid *g, int axis, const size_t at[3])
{
    const size_t w = at[0] / 64, j = at[1] + (axis == 1), k = at[2] + (axis == 2);
    const uint64_t inner = cwi_inner_edges(g, at);
    if (!inner)
        return 0;
    if (g->cubic)
        return cwi_valued_cubics(g, axis, at, inner);
    const uint64_t here = cwi_valued_samples(g, at[1], at[2], w);
    uint64_t after = cwi_valued_samples(g, j, k, w);
    if (axis == 0)
        after = after >> 1 | (w + 1 < g->words ? cwi_valued_samples(g, j, k, w + 1) << 63 : 0);
    return inner & here & after;
}

/* Returns the edges along an axis both of whose ends are voxels. */
static inline uint64_t cwi_volume_edges(const cwi_bit_grid *g, int axis, const size_t at[3])
{
    const size_t *dim = g->volume.dim;
    for (int a = 1; a < 3; a++)
        if (at[a] < 1 || at[a] + (a == axis) > dim[a])
            return 0;
    return cwi_bits_between(at[0], 1, dim[0] + (axis != 0));
}

#endif
