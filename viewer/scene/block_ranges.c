/* Finds the range of values in each block of a volume, in parallel, and each block's distance
 * to the next visible one. */
#include "viewer/scene/block_ranges.h"

#include "viewer/scene/voxel_rows.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <float.h>
#include <math.h>
#include <string.h>

typedef struct job {
    const cw_volume *v;
    cwi_ranges *ranges;
    bool has_failed;
} job;

/* Returns the number of samples of block n along an axis. */
static size_t samples_of(const cw_volume *v, int axis, size_t n)
{
    const size_t left = v->dim[axis] - CWI_RANGE_EDGE * n;
    return left < CWI_RANGE_EDGE + 1 ? left : CWI_RANGE_EDGE + 1;
}

/* A range for each column. */
typedef struct columns {
    float *low, *high;
} columns;

static columns clear_columns(float *from, size_t count)
{
    const columns c = {from, from + count};
    for (size_t i = 0; i < count; i++) {
        c.low[i] = INFINITY;
        c.high[i] = -INFINITY;
    }
    return c;
}

/* Returns true if no number is NaN or infinite. */
static bool are_values(const float *row, size_t count)
{
    int gaps = 0;
    for (size_t i = 0; i < count; i++)
        gaps |= !(fabsf(row[i]) <= FLT_MAX);
    return !gaps;
}

/* Widens ranges by the numbers of a row; returns false when one of them is not a value. */
static bool widen_columns(const float *row, size_t count, columns c)
{
    const bool is_whole = are_values(row, count);
    for (size_t i = 0; i < count && is_whole; i++) {
        c.low[i] = row[i] < c.low[i] ? row[i] : c.low[i];
        c.high[i] = row[i] > c.high[i] ? row[i] : c.high[i];
    }
    for (size_t i = 0; i < count && !is_whole; i++)
        if (fabsf(row[i]) <= FLT_MAX) {
            c.low[i] = fminf(row[i], c.low[i]);
            c.high[i] = fmaxf(row[i], c.high[i]);
        }
    return is_whole;
}

static void join_columns(columns from, size_t count, columns c)
{
    for (size_t i = 0; i < count; i++) {
        c.low[i] = from.low[i] < c.low[i] ? from.low[i] : c.low[i];
        c.high[i] = from.high[i] > c.high[i] ? from.high[i] : c.high[i];
    }
}

/* Scans rows j of a layer of blocks, one above another. */
static bool scan_rows(const cw_volume *v, size_t j, size_t k, float *buffer, columns c)
{
    bool is_whole = true;
    for (size_t z = 0; z < samples_of(v, 2, k); z++) {
        const void *from = cwi_voxel_address(v, 0, j, CWI_RANGE_EDGE * k + z);
        is_whole &= widen_columns(cwi_row_of(v, from, v->dim[0], buffer), v->dim[0], c);
    }
    return is_whole;
}

/* Rounds a little outward: more than the rounding to a float. */
static float round_outward(double x, double sign)
{
    return (float)(x + sign * (fabs(x) * 0x1p-22 + (double)FLT_MIN));
}

/* Computes the range of a block from the columns of its samples. Floats are within half a step
 * of the numbers they represent. */
static void gather_columns(const cw_volume *v, size_t i, columns c, float out[2])
{
    const size_t first = CWI_RANGE_EDGE * i;
    float r[2] = {INFINITY, -INFINITY};
    for (size_t x = first; x < first + samples_of(v, 0, i); x++) {
        r[0] = c.low[x] < r[0] ? c.low[x] : r[0];
        r[1] = c.high[x] > r[1] ? c.high[x] : r[1];
    }
    const bool is_empty = r[0] > r[1];
    const double a = v->slope * (double)round_outward((double)r[0], -1) + v->intercept;
    const double b = v->slope * (double)round_outward((double)r[1], 1) + v->intercept;
    out[0] = is_empty ? 1 : round_outward(a < b ? a : b, -1);
    out[1] = is_empty ? 0 : round_outward(a < b ? b : a, 1);
}

/* Scans a layer of blocks. Rows of blocks share their outer rows of samples: these are read
 * once.
 * buffer  room for five rows */
static bool scan_blocks(const cw_volume *v, const size_t dim[3], size_t k, float *buffer,
                        float (*blocks)[2])
{
    const size_t n = v->dim[0];
    columns shared = clear_columns(buffer + n, n);
    bool is_whole = scan_rows(v, 0, k, buffer, shared);
    for (size_t j = 0; j < dim[1]; j++) {
        const size_t first = CWI_RANGE_EDGE * j, last = first + samples_of(v, 1, j) - 1;
        const columns all = clear_columns(buffer + 3 * n, n);
        join_columns(shared, n, all);
        for (size_t y = first + 1; y < last; y++)
            is_whole &= scan_rows(v, y, k, buffer, all);
        shared = clear_columns(buffer + n, n);
        is_whole &= scan_rows(v, last, k, buffer, shared);
        join_columns(shared, n, all);
        for (size_t i = 0; i < dim[0]; i++)
            gather_columns(v, i, all, blocks[j * dim[0] + i]);
    }
    return is_whole;
}

static void scan_layer(void *context, size_t k)
{
    job *work = context;
    const size_t *dim = work->ranges->dim;
    float *buffer = cwi_alloc_array(work->v->dim[0], 5 * sizeof *buffer);
    if (!buffer) {
        cwi_set_flag(&work->has_failed);
    } else if (!scan_blocks(work->v, dim, k, buffer,
                            work->ranges->blocks + k * dim[1] * dim[0])) {
        cwi_set_flag(&work->ranges->has_gaps);
    }
    cwi_free(buffer);
}

cw_status cwi_ranges_make(const cw_volume *volume, int threads, const cw_progress *progress,
                          cwi_ranges *ranges, cw_error *err)
{
    *ranges = (cwi_ranges){0};
    size_t count = 1;
    for (int a = 0; a < 3; a++) {
        const size_t cells = volume->dim[a] > 1 ? volume->dim[a] - 1 : 1;
        ranges->dim[a] = (cells + CWI_RANGE_EDGE - 1) / CWI_RANGE_EDGE;
        count *= ranges->dim[a];
    }
    ranges->blocks = cwi_alloc_array(count, sizeof *ranges->blocks);
    if (!ranges->blocks)
        return cwi_fail_memory(err);
    job work = {volume, ranges, false};
    cw_status st =
        cwi_parallel_for(ranges->dim[2], volume->dim[0] * volume->dim[1] * CWI_RANGE_EDGE,
                         threads, progress, "ranges", scan_layer, &work, err);
    if (st == CW_OK && work.has_failed)
        st = cwi_fail_memory(err);
    if (st != CW_OK)
        cwi_ranges_free(ranges);
    return st;
}

/* Computes the range of coarse block (i, j, k) from its eight fine ones. */
static void gather_children(const cwi_ranges *fine, size_t i, size_t j, size_t k, float out[2])
{
    out[0] = INFINITY;
    out[1] = -INFINITY;
    for (size_t z = 2 * k; z < 2 * k + 2 && z < fine->dim[2]; z++)
        for (size_t y = 2 * j; y < 2 * j + 2 && y < fine->dim[1]; y++)
            for (size_t x = 2 * i; x < 2 * i + 2 && x < fine->dim[0]; x++) {
                const float *r = fine->blocks[(z * fine->dim[1] + y) * fine->dim[0] + x];
                if (r[0] <= r[1]) {
                    out[0] = fminf(out[0], r[0]);
                    out[1] = fmaxf(out[1], r[1]);
                }
            }
}

cw_status cwi_ranges_halve(const cwi_ranges *fine, cwi_ranges *coarse, cw_error *err)
{
    *coarse = (cwi_ranges){.has_gaps = fine->has_gaps};
    size_t *dim = coarse->dim, count = 1;
    for (int a = 0; a < 3; a++)
        count *= dim[a] = (fine->dim[a] + 1) / 2;
    coarse->blocks = cwi_alloc_array(count, sizeof *coarse->blocks);
    if (!coarse->blocks)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < count; n++)
        gather_children(fine, n % dim[0], n / dim[0] % dim[1], n / dim[0] / dim[1],
                        coarse->blocks[n]);
    return CW_OK;
}

void cwi_ranges_free(cwi_ranges *ranges)
{
    cwi_free(ranges->blocks);
    *ranges = (cwi_ranges){0};
}

/* Makes one pass over a lattice that has a margin of one block on every side. Each byte becomes
 * at most one more than the least of its 13 neighbours in front (behind, if backward). After a
 * pass each way, every byte is the distance along the longest axis to the next 0, up to 255. */
static void relax_distances(uint8_t *d, const ptrdiff_t dim[3], bool backward)
{
    const ptrdiff_t row = dim[0], layer = dim[0] * dim[1], margin = layer + row + 1;
    const ptrdiff_t count = layer * dim[2] - 2 * margin, s = backward ? -1 : 1;
    ptrdiff_t before[13];
    for (int o = 0; o < 13; o++)
        before[o] = s * ((o / 9 - 1) * layer + (o / 3 % 3 - 1) * row + o % 3 - 1);
    for (ptrdiff_t m = 0; m < count; m++) {
        uint8_t *at = d + margin + (backward ? count - 1 - m : m);
        int near = 254;
        for (int o = 0; o < 13; o++)
            near = at[before[o]] < near ? at[before[o]] : near;
        *at = near + 1 < *at ? (uint8_t)(near + 1) : *at;
    }
}

cw_status cwi_ranges_distances(const cwi_ranges *r,
                               bool (*is_visible)(const void *context, double low, double high),
                               const void *context, uint8_t **distances, cw_error *err)
{
    const size_t nx = r->dim[0], ny = r->dim[1], nz = r->dim[2], wide = (nx + 2) * (ny + 2);
    uint8_t *d = cwi_alloc_array(wide, nz + 2); /* then the lattice without its margin */
    *distances = d;
    if (!d)
        return cwi_fail_memory(err);
    memset(d, 255, wide * (nz + 2));
#define ROW(j, k) (d + ((k) + 1) * wide + ((j) + 1) * (nx + 2) + 1)
    for (size_t n = 0; n < nx * ny * nz; n++) {
        const double low = (double)r->blocks[n][0], high = (double)r->blocks[n][1];
        if (low <= high && is_visible(context, low, high))
            ROW(n / nx % ny, n / nx / ny)[n % nx] = 0;
    }
    const ptrdiff_t dim[3] = {(ptrdiff_t)nx + 2, (ptrdiff_t)ny + 2, (ptrdiff_t)nz + 2};
    relax_distances(d, dim, false);
    relax_distances(d, dim, true);
    for (size_t n = 0; n < ny * nz; n++)
        memmove(d + n * nx, ROW(n % ny, n / ny), nx);
#undef ROW
    return CW_OK;
}
