/* Finds the box around what a transfer function shows of a volume, so that it can be framed. */
#include <cubewright/transfer.h>

#include "viewer/scene/voxel_rows.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

enum { ROWS = 4096, MAX_VOXELS = 1 << 24 };

/* The fraction of all opacity that is left outside at each end of each axis: noise, dust. */
static const double OUTSIDE = 0.001;

/* Opacities are counted in whole numbers, whose sums are the same in any order. */
static const double UNITS = 65535;

typedef struct job {
    const cw_volume *v;
    uint32_t opacities[ROWS]; /* over the range of the function's points */
    double low, scale;        /* from a stored number to a row */
    size_t step, layers;      /* one row and one layer in `step` are counted */
    uint64_t *columns, *rows; /* of each layer counted: sums for each x, and for each y */
    bool has_failed;
} job;

static void count_layer(void *context, size_t n)
{
    job *j = context;
    const cw_volume *v = j->v;
    const size_t nx = v->dim[0], ny = v->dim[1];
    float *buffer = cwi_alloc_array(nx, sizeof *buffer);
    if (!buffer) {
        cwi_set_flag(&j->has_failed);
        return;
    }
    for (size_t y = 0; y < ny; y += j->step) {
        const float *row = cwi_row_of(v, cwi_voxel_address(v, 0, y, n * j->step), nx, buffer);
        for (size_t x = 0; x < nx; x++) {
            const double at = ((double)row[x] - j->low) * j->scale;
            if (isnan(at))
                continue;
            const uint32_t o = j->opacities[at <= 0 ? 0 : at >= ROWS - 1 ? ROWS - 1 : (int)at];
            j->columns[n * nx + x] += o;
            j->rows[n * ny + y] += o;
        }
    }
    cwi_free(buffer);
}

/* Fills the table of opacities, from the function's first point to its last. */
static void make_rows(const cw_transfer *t, job *j)
{
    const size_t last = t->opacity_count ? t->opacity_count - 1 : 0;
    const double low = t->opacities[0].value, width = t->opacities[last].value - low;
    double color[3], opacity;
    for (int n = 0; n < ROWS; n++) {
        cw_transfer_at(t, low + width * n / (ROWS - 1), color, &opacity);
        j->opacities[n] = (uint32_t)lround(UNITS * opacity);
    }
    const double per_value = width > 0 ? (ROWS - 1) / width : 0;
    j->scale = j->v->slope * per_value;
    j->low = (low - j->v->intercept) / j->v->slope;
}

/* Finds the first and the last index between which nearly all of the sums are; false: all are
 * 0. */
static bool trim_ends(const uint64_t *sums, size_t count, double ends[2])
{
    double total = 0, below = 0, above = 0;
    size_t first = 0, last = count;
    for (size_t n = 0; n < count; n++)
        total += (double)sums[n];
    if (!(total > 0))
        return false;
    while ((below += (double)sums[first]) <= OUTSIDE * total)
        first++;
    while ((above += (double)sums[last - 1]) <= OUTSIDE * total)
        last--;
    ends[0] = (double)first;
    ends[1] = (double)last - 1;
    return true;
}

/* Joins the layers' sums, and trims each axis; ends are indices, widened by what was not
 * counted. */
static bool find_ends(const job *j, uint64_t *sums, double ends[3][2])
{
    const cw_volume *v = j->v;
    const size_t max = v->dim[0] + v->dim[1] + j->layers;
    bool is_visible = true;
    memset(sums, 0, max * sizeof *sums);
    uint64_t *x = sums, *y = x + v->dim[0], *z = y + v->dim[1];
    for (size_t n = 0; n < j->layers; n++) {
        for (size_t i = 0; i < v->dim[0]; i++) {
            x[i] += j->columns[n * v->dim[0] + i];
            z[n] += j->columns[n * v->dim[0] + i];
        }
        for (size_t i = 0; i < v->dim[1]; i++)
            y[i] += j->rows[n * v->dim[1] + i];
    }
    is_visible = trim_ends(x, v->dim[0], ends[0]) && trim_ends(y, v->dim[1], ends[1]) &&
                 trim_ends(z, j->layers, ends[2]);
    for (int e = 0; e < 2 && is_visible; e++)
        ends[2][e] *= (double)j->step;
    for (int a = 0; a < 3; a++) {
        const double margin = a ? (double)j->step : 1, end = (double)v->dim[a] - 1;
        ends[a][0] = is_visible ? fmax(ends[a][0] - margin, 0) : 0;
        ends[a][1] = is_visible ? fmin(ends[a][1] + margin, end) : end;
        if (v->dim[a] == 1)
            ends[a][0] = -0.5, ends[a][1] = 0.5;
    }
    return is_visible;
}

static void find_corners(const cw_volume *v, const double ends[3][2], double low[3],
                         double high[3])
{
    for (int n = 0; n < 8; n++) {
        const double index[3] = {ends[0][n & 1], ends[1][n >> 1 & 1], ends[2][n >> 2]};
        double p[3];
        cw_volume_to_world(v, index, p);
        for (int a = 0; a < 3; a++) {
            low[a] = n ? fmin(low[a], p[a]) : p[a];
            high[a] = n ? fmax(high[a], p[a]) : p[a];
        }
    }
}

cw_status cw_transfer_box(const cw_volume *volume, const cw_transfer *transfer, int threads,
                          double low[3], double high[3], cw_error *err)
{
    CWI_REQUIRE(err, volume, transfer, low, high);
    cw_volume v;
    double ends[3][2];
    cw_status st = cw_volume_select(volume, 0, 0, &v, err);
    if (st == CW_OK)
        st = cwi_volume_expect_even(&v, "a box of what is visible", err);
    if (st == CW_OK)
        st = cw_transfer_check(transfer, err);
    job *j = st == CW_OK ? cwi_alloc_zeroed(1, sizeof *j) : NULL;
    if (!j)
        return st == CW_OK ? cwi_fail_memory(err) : st;
    j->v = &v;
    j->step = 1;
    while (v.dim[0] * (v.dim[1] / j->step) * (v.dim[2] / j->step) > MAX_VOXELS)
        j->step++;
    j->layers = (v.dim[2] + j->step - 1) / j->step;
    make_rows(transfer, j);
    j->columns = cwi_alloc_zeroed(j->layers * v.dim[0], sizeof *j->columns);
    j->rows = cwi_alloc_zeroed(j->layers * v.dim[1], sizeof *j->rows);
    uint64_t *sums = cwi_alloc_array(v.dim[0] + v.dim[1] + j->layers, sizeof *sums);
    if (!j->columns || !j->rows || !sums)
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_parallel_for(j->layers, v.dim[0] * v.dim[1] / j->step, threads,
                              &(cw_progress){0}, "box", count_layer, j, err);
    if (st == CW_OK && j->has_failed)
        st = cwi_fail_memory(err);
    if (st == CW_OK) {
        find_ends(j, sums, ends);
        find_corners(&v, (const double(*)[2])ends, low, high);
    }
    cwi_free(sums);
    cwi_free(j->columns);
    cwi_free(j->rows);
    cwi_free(j);
    return st;
}
