/* Loads tiles of a volume, has a filter correct them, and stores the results. */
#include "core/filter/tiles.h"
#include "core/base/thread_pool.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

static const size_t WHOLE[3] = {CWI_TILE_WIDE, CWI_TILE_HIGH, CWI_TILE_HIGH};

enum { TILE_VOXELS = CWI_TILE_WIDE * CWI_TILE_HIGH * CWI_TILE_HIGH };

/* A filter at work: common to all threads. */
typedef struct work {
    const cw_volume *in;
    cw_volume *out;
    const cwi_tile_filter *filter;
    size_t tiles[3];
    bool has_gaps, starved;
} work;

/* The memory of a thread. */
typedef struct bench {
    double *values, *valid;    /* a row with halo; valid is NULL without gaps */
    float *loaded;             /* a tile with halo */
    float *corrections, *work; /* a tile; as the filter needs it */
} bench;

void cwi_tile_strides(const size_t halo[3], ptrdiff_t *row, ptrdiff_t *slice)
{
    *row = (ptrdiff_t)(WHOLE[0] + 2 * halo[0]);
    *slice = *row * (ptrdiff_t)(WHOLE[1] + 2 * halo[1]);
}

static size_t padded_floats(const size_t halo[3])
{
    ptrdiff_t row, slice;
    cwi_tile_strides(halo, &row, &slice);
    return (size_t)slice * (WHOLE[2] + 2 * halo[2]);
}

/* Makes a view of part of a row, for cwi_filter_load(). */
static cw_volume view_row(const cw_volume *in, const size_t at[3], size_t count)
{
    cw_volume view = *in;
    view.data = cwi_voxel_address(in, at[0], at[1], at[2]);
    view.dim[0] = count;
    return view;
}

void cwi_filter_load_floats(const cw_volume *in, const size_t at[3], size_t count, double unit,
                            double *base, double *values, double *valid, float *to)
{
    /* Squares of differences must be finite: float has 3e38. */
    static const double MAX_DIFFERENCE = 1e15;
    const cw_volume view = view_row(in, at, count);
    const double by = 1 / unit;
    cwi_filter_load(&view, 0, 0, values, valid);
    for (size_t i = 0; i < count && !isfinite(*base); i++)
        *base = !valid || valid[i] > 0 ? values[i] : *base;
    for (size_t i = 0; i < count; i++) {
        const double x = (values[i] - *base) * by;
        to[i] = (float)(x < -MAX_DIFFERENCE  ? -MAX_DIFFERENCE
                        : x > MAX_DIFFERENCE ? MAX_DIFFERENCE
                                             : x);
    }
    for (size_t i = 0; i < count && valid; i++)
        to[i] = valid[i] > 0 ? to[i] : NAN;
}

static size_t clamp_index(size_t at, size_t halo, size_t count)
{
    return at < halo ? 0 : at - halo < count ? at - halo : count - 1;
}

/* Loads a row of a tile. Beyond the border values go on as they are there. */
static void load_row(const work *k, const bench *b, const cwi_filter_tile *tile, size_t y,
                     size_t z, double *base, float *to)
{
    const size_t *halo = k->filter->halo, *dim = k->in->dim;
    const size_t end = tile->first[0] + tile->size[0] + halo[0];
    const size_t at[3] = {clamp_index(tile->first[0], halo[0], dim[0]),
                          clamp_index(tile->first[1] + y, halo[1], dim[1]),
                          clamp_index(tile->first[2] + z, halo[2], dim[2])};
    const size_t before = at[0] + halo[0] - tile->first[0],
                 count = (end < dim[0] ? end : dim[0]) - at[0];
    cwi_filter_load_floats(k->in, at, count, k->filter->unit, base, b->values, b->valid,
                           to + before);
    for (size_t i = 0; i < before; i++)
        to[i] = to[before];
    for (size_t i = before + count; i < tile->size[0] + 2 * halo[0]; i++)
        to[i] = to[before + count - 1];
}

static void load_tile(const work *k, const bench *b, cwi_filter_tile *tile)
{
    const size_t *halo = k->filter->halo;
    double base = INFINITY;
    cwi_tile_strides(halo, &tile->row, &tile->slice);
    for (size_t z = 0; z < tile->size[2] + 2 * halo[2]; z++)
        for (size_t y = 0; y < tile->size[1] + 2 * halo[1]; y++)
            load_row(k, b, tile, y, z, &base,
                     b->loaded + z * (size_t)tile->slice + y * (size_t)tile->row);
    tile->values =
        b->loaded + halo[2] * (size_t)tile->slice + halo[1] * (size_t)tile->row + halo[0];
}

/* Stores the values plus their corrections. */
static void store_tile(const work *k, const bench *b, const cwi_filter_tile *tile)
{
    const size_t size = cw_type_size(k->out->type), *dim = k->out->dim;
    for (size_t row = 0; row < tile->size[1] * tile->size[2]; row++) {
        const size_t y = row % tile->size[1], z = row / tile->size[1];
        const size_t at[3] = {tile->first[0], tile->first[1] + y, tile->first[2] + z};
        const cw_volume view = view_row(k->in, at, tile->size[0]);
        const float *by = b->corrections + (z * CWI_TILE_HIGH + y) * CWI_TILE_WIDE;
        char *to = (char *)cw_volume_voxels(k->out) +
                   ((at[2] * dim[1] + at[1]) * dim[0] + at[0]) * size;
        cwi_filter_load(&view, 0, 0, b->values, b->valid);
        for (size_t i = 0; i < tile->size[0]; i++, to += size)
            if (b->valid && !(b->valid[i] > 0))
                cwi_filter_store_gap(k->out, to);
            else
                cwi_filter_store(k->out, to, b->values[i] + k->filter->unit * (double)by[i]);
    }
}

static size_t bench_bytes(const cwi_tile_filter *f)
{
    const size_t width = WHOLE[0] + 2 * f->halo[0];
    return 2 * width * sizeof(double) +
           (padded_floats(f->halo) + TILE_VOXELS + f->work_floats) * sizeof(float);
}

static void filter_tile(void *context, size_t n)
{
    work *k = context;
    const cwi_tile_filter *f = k->filter;
    const size_t width = WHOLE[0] + 2 * f->halo[0];
    const size_t tile_index[3] = {n % k->tiles[0], n / k->tiles[0] % k->tiles[1],
                                  n / k->tiles[0] / k->tiles[1]};
    double *memory = cwi_alloc_zeroed(bench_bytes(f), 1);
    bench b = {.values = memory};
    cwi_filter_tile tile;
    if (!memory) {
        cwi_set_flag(&k->starved);
        return;
    }
    b.valid = k->has_gaps ? memory + width : NULL;
    b.loaded = (float *)(memory + 2 * width);
    b.corrections = b.loaded + padded_floats(f->halo);
    b.work = b.corrections + TILE_VOXELS;
    for (int a = 0; a < 3; a++) {
        const size_t left = k->in->dim[a] - tile_index[a] * WHOLE[a];
        tile.first[a] = tile_index[a] * WHOLE[a];
        tile.size[a] = left < WHOLE[a] ? left : WHOLE[a];
    }
    if (f->unit > 0) {
        load_tile(k, &b, &tile);
        f->correct(f->context, &tile, b.work, b.corrections);
    }
    store_tile(k, &b, &tile);
    cwi_free(memory);
}

cw_status cwi_filter_tiles(const cw_volume *in, const cwi_tile_filter *filter,
                           const cw_filter_desc *desc, cw_volume *out, cw_error *err)
{
    work k = {.in = in, .out = out, .filter = filter};
    size_t count = 1;
    for (int a = 0; a < 3; a++) {
        k.tiles[a] = (in->dim[a] + WHOLE[a] - 1) / WHOLE[a];
        count *= k.tiles[a];
    }
    const size_t threads = (size_t)cwi_threads(desc->threads);
    const size_t bytes = bench_bytes(filter) * (threads < count ? threads : count);
    cw_status st = cwi_filter_result(in, cw_filter_type(in), in->dim, desc, bytes, out, err);
    if (st != CW_OK)
        return st;
    k.has_gaps = cwi_filter_has_gaps(in, desc->threads);
    st = cwi_parallel_for(count, TILE_VOXELS * filter->cost, desc->threads, &desc->progress,
                          filter->step, filter_tile, &k, err);
    if (st == CW_OK && k.starved)
        st = cwi_fail_memory(err);
    if (st != CW_OK)
        cw_volume_free(out);
    return st;
}
