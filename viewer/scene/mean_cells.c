/* Averages a volume's cells: value, square and gradient, first of its voxels, then level by
 * level. */
#include "viewer/scene/mean_cells.h"

#include "viewer/scene/voxel_rows.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <float.h>
#include <math.h>
#include <string.h>

static size_t cells_along(const cw_volume *v, int axis)
{
    return v->dim[axis] > 1 ? v->dim[axis] - 1 : 1;
}

typedef struct filling {
    const cw_volume *v;
    cwi_mean_cells *cells;
    size_t level;
    float scale, bias; /* from a number of the volume to the stored value */
    bool has_failed;
} filling;

/* --- the first level ----------------------------------------------------------------------- */

/* Sums over cells that have the same place along x; rows of as many numbers as voxels. */
typedef struct sums {
    float *part[6];        /* count, value, square, and gradient */
    float *mean, *rise[2]; /* across the row: of the four voxels around, and along y and z */
} sums;

enum { SUM_ROWS = 9, VOXEL_ROWS = 9 };

/* Adds a row of cells, from the four rows of voxels around it. NaN marks cells without a
 * value. */
static void add_cells(const filling *f, const float *const rows[4], const sums *s)
{
    const size_t n = f->v->dim[0], cells = cells_along(f->v, 0), next = n > 1;
    const float scale = 0.25f * f->scale, bias = f->bias;
    for (size_t i = 0; i < n; i++) {
        const float a = rows[0][i], b = rows[1][i], c = rows[2][i], d = rows[3][i];
        s->mean[i] = scale * ((a + b) + (c + d)) + bias;
        s->rise[0][i] = scale * ((b - a) + (d - c));
        s->rise[1][i] = scale * ((c - a) + (d - b));
    }
    for (size_t i = 0; i < cells; i++) {
        const float mean = 0.5f * (s->mean[i] + s->mean[i + next]);
        const float x = s->mean[i + next] - s->mean[i],
                    y = s->rise[0][i] + s->rise[0][i + next],
                    z = s->rise[1][i] + s->rise[1][i + next];
        const bool is_value = fabsf(mean) <= FLT_MAX;
        s->part[0][i] += is_value ? 1 : 0;
        s->part[1][i] += is_value ? mean : 0;
        s->part[2][i] += is_value ? mean * mean + (x * x + y * y + z * z) * (1.0f / 12) : 0;
        s->part[3][i] += is_value ? x : 0;
        s->part[4][i] += is_value ? y : 0;
        s->part[5][i] += is_value ? z : 0;
    }
}

/* Averages the sums of a row over the cells that each mean cell has along x. across: cells of
 * the volume that it has along the other axes */
static void gather_row(const filling *f, const sums *s, size_t across, size_t to)
{
    const cwi_mean_level *l = &f->cells->levels[f->level];
    const size_t edge = (size_t)1 << l->shift[0], cells = cells_along(f->v, 0);
    for (size_t i = 0; i < l->dim[0]; i++) {
        const size_t first = i * edge, end = first + edge < cells ? first + edge : cells;
        const float fraction = 1 / (float)((end - first) * across);
        float sum[6] = {0};
        for (size_t c = first; c < end; c++)
            for (int p = 0; p < 6; p++)
                sum[p] += s->part[p][c];
        float *m = l->moments[to + i];
        m[0] = fraction * sum[0];
        m[1] = fraction * sum[1];
        m[2] = fraction * sum[2];
        m[3] = 0;
        for (int a = 0; a < 3 && l->gradients; a++)
            l->gradients[to + i][a] = fraction * sum[3 + a];
        if (l->gradients)
            l->gradients[to + i][3] = 0;
    }
}

/* Fills the mean cells of one row along x. buffer: VOXEL_ROWS rows */
static void fill_row(const filling *f, size_t j, size_t k, float *buffer, const sums *s)
{
    const cw_volume *v = f->v;
    const cwi_mean_level *l = &f->cells->levels[f->level];
    const size_t first[2] = {j << l->shift[1], k << l->shift[2]}, n = v->dim[0];
    const float *rows[3][3] = {0};
    size_t count[2];
    for (int a = 0; a < 2; a++) {
        const size_t edge = (size_t)1 << l->shift[1 + a];
        const size_t left = cells_along(v, 1 + a) - first[a];
        count[a] = left < edge ? left : edge;
    }
    for (size_t z = 0; z <= count[1]; z++)
        for (size_t y = 0; y <= count[0]; y++) {
            const size_t at[2] = {v->dim[1] > 1 ? first[0] + y : 0,
                                  v->dim[2] > 1 ? first[1] + z : 0};
            rows[z][y] = cwi_row_of(v, cwi_voxel_address(v, 0, at[0], at[1]), n,
                                    buffer + (3 * z + y) * n);
        }
    for (int p = 0; p < 6; p++)
        memset(s->part[p], 0, n * sizeof(float));
    for (size_t z = 0; z < count[1]; z++)
        for (size_t y = 0; y < count[0]; y++) {
            const float *const around[4] = {rows[z][y], rows[z][y + 1], rows[z + 1][y],
                                            rows[z + 1][y + 1]};
            add_cells(f, around, s);
        }
    gather_row(f, s, count[0] * count[1], (k * l->dim[1] + j) * l->dim[0]);
}

static void fill_layer(void *context, size_t k)
{
    filling *f = context;
    const size_t n = f->v->dim[0];
    float *buffer = cwi_alloc_array(n, (SUM_ROWS + VOXEL_ROWS) * sizeof *buffer);
    if (!buffer) {
        cwi_set_flag(&f->has_failed);
        return;
    }
    float *rows = buffer + VOXEL_ROWS * n;
    sums s = {.mean = rows + 6 * n, .rise = {rows + 7 * n, rows + 8 * n}};
    for (size_t p = 0; p < 6; p++)
        s.part[p] = rows + p * n;
    for (size_t j = 0; j < f->cells->levels[f->level].dim[1]; j++)
        fill_row(f, j, k, buffer, &s);
    cwi_free(buffer);
}

/* --- the levels above ---------------------------------------------------------------------- */

/* Averages the mean cells of the level below, weighted by the cells of the volume in each. */
static void join_cells(const filling *f, const size_t at[3], float moments[4],
                       float gradients[4])
{
    const cwi_mean_level *l = &f->cells->levels[f->level], *below = l - 1;
    float all = 0;
    memset(moments, 0, 4 * sizeof *moments);
    memset(gradients, 0, 4 * sizeof *gradients);
    for (size_t n = 0; n < 8; n++) {
        size_t from[3];
        float weight = 1;
        for (int a = 0; a < 3; a++) {
            const int step = l->shift[a] - below->shift[a];
            from[a] = (at[a] << step) + (n >> a & 1);
            if (from[a] >= below->dim[a] || (step == 0 && (n >> a & 1)))
                weight = 0;
            const size_t edge = (size_t)1 << below->shift[a];
            const size_t left = cells_along(f->v, a) - from[a] * edge;
            weight *= (float)(left < edge ? left : edge);
        }
        if (weight == 0)
            continue;
        const size_t c = (from[2] * below->dim[1] + from[1]) * below->dim[0] + from[0];
        for (int p = 0; p < 3; p++) {
            moments[p] += weight * below->moments[c][p];
            gradients[p] += l->gradients ? weight * below->gradients[c][p] : 0;
        }
        all += weight;
    }
    for (int p = 0; p < 3; p++) {
        moments[p] /= all;
        gradients[p] /= all;
    }
}

static void join_layer(void *context, size_t k)
{
    const filling *f = context;
    const cwi_mean_level *l = &f->cells->levels[f->level];
    float ignored[4];
    for (size_t j = 0; j < l->dim[1]; j++)
        for (size_t i = 0; i < l->dim[0]; i++) {
            const size_t at[3] = {i, j, k}, to = (k * l->dim[1] + j) * l->dim[0] + i;
            join_cells(f, at, l->moments[to], l->gradients ? l->gradients[to] : ignored);
        }
}

/* Sizes a level, by the ratios of the spacings to the smallest; returns its number of cells. */
static size_t size_level(const cw_volume *v, const double ratio[3], size_t level,
                         cwi_mean_level *l)
{
    size_t count = 1;
    for (int a = 0; a < 3; a++) {
        const double shift = floor((double)level - log2(ratio[a]) + 0.5);
        const size_t cells = cells_along(v, a);
        l->shift[a] = shift > 0 ? (int)shift : 0;
        while (l->shift[a] > 0 && cells <= (size_t)1 << (l->shift[a] - 1))
            l->shift[a]--;
        l->dim[a] = ((cells - 1) >> l->shift[a]) + 1;
        count *= l->dim[a];
    }
    return count;
}

/* Finds the middle and half the width of the range of values. */
static void find_scale(const cwi_ranges *r, cwi_mean_cells *cells)
{
    double low = INFINITY, high = -INFINITY;
    for (size_t n = 0; n < r->dim[0] * r->dim[1] * r->dim[2]; n++)
        if (r->blocks[n][0] <= r->blocks[n][1]) {
            low = fmin(low, (double)r->blocks[n][0]);
            high = fmax(high, (double)r->blocks[n][1]);
        }
    cells->origin = low <= high ? low / 2 + high / 2 : 0;
    cells->scale = low < high ? high / 2 - low / 2 : 1;
}

static cw_status make_level(filling *f, size_t count, bool has_gradients, int threads,
                            const cw_progress *progress, cw_error *err)
{
    cwi_mean_level *l = &f->cells->levels[f->level];
    f->cells->level_count = f->level + 1;
    l->moments = cwi_alloc_array(count, sizeof *l->moments);
    l->gradients = has_gradients ? cwi_alloc_array(count, sizeof *l->gradients) : NULL;
    if (!l->moments || (has_gradients && !l->gradients))
        return cwi_fail_memory(err);
    cw_status st =
        cwi_parallel_for(l->dim[2], 8 * l->dim[0] * l->dim[1], threads, progress, "averaging",
                         f->level > 1 ? join_layer : fill_layer, f, err);
    if (st == CW_OK && f->has_failed)
        st = cwi_fail_memory(err);
    return st;
}

cw_status cwi_mean_cells_make(const cw_volume *v, const cwi_ranges *ranges, bool has_gradients,
                              int threads, const cw_progress *progress, cwi_mean_cells *cells,
                              cw_error *err)
{
    double spacing[3], ratio[3];
    cw_status st = CW_OK;
    *cells = (cwi_mean_cells){.level_count = 1, .has_gradients = has_gradients};
    cw_volume_spacing(v, spacing);
    for (int a = 0; a < 3; a++)
        ratio[a] = spacing[a] / fmin(fmin(spacing[0], spacing[1]), spacing[2]);
    find_scale(ranges, cells);
    filling f = {.v = v, .cells = cells, .level = 1};
    f.scale = (float)(v->slope / cells->scale);
    f.bias = (float)((v->intercept - cells->origin) / cells->scale);
    size_t count = size_level(v, ratio, 0, &cells->levels[0]);
    for (; count > 1 && f.level < CWI_MEAN_LEVELS && st == CW_OK; f.level++) {
        count = size_level(v, ratio, f.level, &cells->levels[f.level]);
        st = make_level(&f, count, has_gradients, threads, progress, err);
    }
    if (st != CW_OK)
        cwi_mean_cells_free(cells);
    return st;
}

void cwi_mean_cells_free(cwi_mean_cells *cells)
{
    for (size_t n = 0; n < cells->level_count; n++) {
        cwi_free(cells->levels[n].moments);
        cwi_free(cells->levels[n].gradients);
    }
    *cells = (cwi_mean_cells){0};
}
