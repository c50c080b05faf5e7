/* Filters of tiles: boxes of voxels that are loaded as floats, with those around. The work on a tile
 * stays in the caches, and memory does not depend on the size of the volume. */
#ifndef CORE_FILTER_TILES_H
#define CORE_FILTER_TILES_H

#include "core/filter/filter_work.h"

/* Voxels of a whole tile along x, and along y and z. */
enum { CWI_TILE_WIDE = 64, CWI_TILE_HIGH = 16 };

/* A tile. Rows and slices have the same distances in all tiles of a filter, and the corrections
 * are CWI_TILE_WIDE x CWI_TILE_HIGH x CWI_TILE_HIGH. */
typedef struct cwi_filter_tile {
    size_t first[3], size[3]; /* voxels without those around */
    ptrdiff_t row, slice;     /* floats from a value to the next along y and z */
    const float *values; /* of the first voxel; the halo lies before and behind. In units of
                                 the filter from some value of the tile; NaN: no value */
} cwi_filter_tile;

/* A filter that adds a correction to each value. */
typedef struct cwi_tile_filter {
    size_t halo[3];     /* voxels around a tile that it reads */
    size_t work_floats; /* memory for its work on a tile */
    double unit;        /* stored values are divided by it, corrections are multiplied; 0: there
                           is nothing to correct */
    size_t cost;        /* of a voxel, in simple operations */
    const char *step;   /* for progress */
    const void *context;
    /* Sets corrections, in units. Those of voxels without a value are not used. */
    void (*correct)(const void *context, const cwi_filter_tile *tile, float *work,
                    float *corrections);
} cwi_tile_filter;

/* Returns the distances between rows and between slices of tiles. */
void cwi_tile_strides(const size_t halo[3], ptrdiff_t *row, ptrdiff_t *slice);

/* Loads part of a row as floats, (value - base) / unit, where an infinite base becomes the first
 * value. NaN: no value.
 * values, valid  memory for count numbers each; they are what cwi_filter_load() loads, then.
 *                valid: NULL if no voxel is missing */
void cwi_filter_load_floats(const cw_volume *in, const size_t at[3], size_t count, double unit,
                            double *base, double *values, double *valid, float *to);

/* Filters a volume, tile by tile.
 * in       as of cwi_filter_input()
 * Returns  CW_ERR_LIMIT, CW_ERR_NO_MEMORY, CW_ERR_CANCELLED; then *out is zeroed */
CW_NODISCARD cw_status cwi_filter_tiles(const cw_volume *in, const cwi_tile_filter *filter,
                                        const cw_filter_desc *desc, cw_volume *out,
                                        cw_error *err);

#endif
