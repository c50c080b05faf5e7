/* Replaces values of a volume by the median of those around.
 *
 * The least of any 15 of 27 values has 14 above it, so it is not their median, and neither is the
 * greatest. Both are left out, the next value joins, and so on until all have been seen
 * [Smith1996]. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/filter/filter_work.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

enum { LANES = 16, CUBE = 27, KEPT = CUBE / 2 + 2, MOST = 3, MOST_VALUES = 7 * 7 * 7 };

typedef struct work {
    const cw_volume *in;
    cw_volume *out;
    ptrdiff_t radius;
    bool has_gaps, starved;
} work;

#define LANE       double
#define NAME(name) name##_f64
#include "core/filter/median_network.inc"

/* For types whose numbers all are floats: twice as many side by side. */
#define LANE       float
#define NAME(name) name##_f32
#include "core/filter/median_network.inc"

static bool fits_float(cw_type type)
{
    return type == CW_F32 || cw_type_size(type) < 4;
}

/* Returns the value of a rank, by Hoare's selection. Orders the values in part. */
static double select_rank(double *v, int count, int rank)
{
    for (int low = 0, high = count - 1; low < high;) {
        const double pivot = v[(low + high) / 2];
        int i = low, j = high;
        while (i <= j) {
            while (v[i] < pivot)
                i++;
            while (pivot < v[j])
                j--;
            if (i <= j) {
                const double t = v[i];
                v[i++] = v[j];
                v[j--] = t;
            }
        }
        if (rank <= j)
            high = j;
        else if (rank >= i)
            low = i;
        else
            break;
    }
    return v[rank];
}

/* The input rows around an output row, with `radius` more values at both ends. Those beyond the
 * border are the ones at the border. */
typedef struct bench {
    double *rows, *valid; /* side x side rows of width doubles */
    size_t side, width;
} bench;

static size_t clamp_row(size_t at, ptrdiff_t by, size_t count)
{
    const ptrdiff_t to = (ptrdiff_t)at + by;
    return to < 0 ? 0 : to < (ptrdiff_t)count ? (size_t)to : count - 1;
}

static void pad_row(double *row, size_t count, size_t radius, size_t width)
{
    for (size_t n = 0; n < radius; n++)
        row[n] = row[radius];
    for (size_t n = radius + count; n < width; n++)
        row[n] = row[radius + count - 1];
}

static void load_rows(const work *k, bench *b, size_t j, size_t z)
{
    const cw_volume *in = k->in;
    const size_t r = (size_t)k->radius;
    for (size_t row = 0; row < b->side * b->side; row++) {
        const size_t y = clamp_row(j, (ptrdiff_t)(row % b->side) - k->radius, in->dim[1]),
                     s = clamp_row(z, (ptrdiff_t)(row / b->side) - k->radius, in->dim[2]);
        double *values = b->rows + row * b->width,
               *valid = k->has_gaps ? b->valid + row * b->width : NULL;
        cwi_filter_load(in, y, s, values + r, valid ? valid + r : NULL);
        pad_row(values, in->dim[0], r, b->width);
        if (valid)
            pad_row(valid, in->dim[0], r, b->width);
    }
}

/* One voxel's median of the values that are there: in any cube, with gaps. Returns false where
 * the voxel itself has no value. */
static bool find_median(const work *k, const bench *b, size_t i, double *median)
{
    double values[MOST_VALUES];
    const size_t middle = b->side * b->side / 2;
    int count = 0;
    if (k->has_gaps && !(b->valid[middle * b->width + i + (size_t)k->radius] > 0))
        return false;
    for (size_t row = 0; row < b->side * b->side; row++)
        for (size_t n = i; n < i + b->side; n++)
            if (!k->has_gaps || b->valid[row * b->width + n] > 0)
                values[count++] = b->rows[row * b->width + n];
    *median = select_rank(values, count, (count - 1) / 2);
    return true;
}

static void store_selected(const work *k, const bench *b, char *to)
{
    const size_t size = cw_type_size(k->out->type);
    for (size_t i = 0; i < k->in->dim[0]; i++, to += size) {
        double median;
        if (find_median(k, b, i, &median))
            cwi_voxel_put(k->out->type, to, median);
        else
            cwi_filter_store_gap(k->out, to);
    }
}

/* Stores the medians of an output row, whose input rows are there. */
static void store_row(const work *k, const bench *b, char *to)
{
    if (k->radius > 1 || k->has_gaps) {
        store_selected(k, b, to);
        return;
    }
    if (!fits_float(k->in->type)) {
        store_medians_f64(k->out, b->rows, b->width, to);
        return;
    }
    float *rows = (float *)b->valid; /* not needed without gaps */
    for (size_t n = 0; n < 9 * b->width; n++)
        rows[n] = (float)b->rows[n];
    store_medians_f32(k->out, rows, b->width, to);
}

static void filter_slice(void *context, size_t z)
{
    work *k = context;
    const size_t side = 2 * (size_t)k->radius + 1, width = k->in->dim[0] + side + LANES;
    const size_t row = k->out->dim[0] * cw_type_size(k->out->type);
    char *to = cw_volume_voxels(k->out);
    double *memory = cwi_alloc_zeroed(2 * side * side * width, sizeof *memory);
    bench b = {.rows = memory, .side = side, .width = width};
    if (!memory) {
#pragma omp atomic write
        k->starved = true;
        return;
    }
    b.valid = memory + side * side * width;
    for (size_t j = 0; j < k->out->dim[1]; j++) {
        load_rows(k, &b, j, z);
        store_row(k, &b, to + (z * k->out->dim[1] + j) * row);
    }
    cwi_free(memory);
}

cw_status cw_volume_median(const cw_volume *volume, size_t radius, const cw_filter_desc *desc,
                           cw_volume *out, cw_error *err)
{
    CWI_REQUIRE(err, volume, out);
    const cw_filter_desc none = {0}, *d = desc ? desc : &none;
    cw_volume in;
    *out = (cw_volume){0};
    if (radius < 1 || radius > MOST)
        return cwi_fail(err, CW_ERR_ARGUMENT, "radius is %zu; 1 to %d were expected", radius,
                        MOST);
    cw_status st = cwi_filter_input(volume, "a median", &in, err);
    if (st == CW_OK)
        st = cwi_filter_result(&in, in.dim, d, 0, out, err);
    if (st != CW_OK)
        return st;
    work k = {.in = &in,
              .out = out,
              .radius = (ptrdiff_t)radius,
              .has_gaps = cwi_filter_has_gaps(&in, d->threads)};
    st = cwi_each_layer(in.dim[2], in.dim[0] * in.dim[1] * CUBE, d->threads, &d->progress,
                        "smoothing", filter_slice, &k, err);
    if (st == CW_OK && k.starved)
        st = cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for the rows around a voxel");
    if (st != CW_OK)
        cw_volume_free(out);
    return st;
}
