/* Replaces values of a volume by the median of those around.
 *
 * The least of any 15 of 27 values has 14 above it, so it is not their median, and neither is the
 * greatest. Both are left out, the next value joins, and so on until all have been seen
 * [Smith1996]. Larger cubes, and those with gaps, are those of median_tiles.c. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/filter/median_tiles.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

enum { LANES = 16, SIDE = 3, CUBE = 27, KEPT = CUBE / 2 + 2, MAX_RADIUS = 3 };

typedef struct work {
    const cw_volume *in;
    cw_volume *out;
    bool starved;
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

/* The input rows around an output row, with a value more at both ends. Those beyond the border are
 * the ones at the border. */
typedef struct bench {
    double *rows;  /* SIDE x SIDE rows of width numbers */
    float *floats; /* the same */
    size_t width;
} bench;

static size_t clamp_row(size_t at, size_t by, size_t count)
{
    const size_t to = at + by; /* by 1 more than the row itself */
    return to < 1 ? 0 : to - 1 < count ? to - 1 : count - 1;
}

static void load_rows(const work *k, bench *b, size_t j, size_t z)
{
    const cw_volume *in = k->in;
    const size_t count = in->dim[0];
    for (size_t n = 0; n < (size_t)SIDE * SIDE; n++) {
        double *row = b->rows + n * b->width;
        cwi_filter_load(in, clamp_row(j, n % SIDE, in->dim[1]),
                        clamp_row(z, n / SIDE, in->dim[2]), row + 1, NULL);
        row[0] = row[1];
        for (size_t i = count + 1; i < b->width; i++)
            row[i] = row[count];
    }
}

/* Stores the medians of an output row, whose input rows are there. */
static void store_row(const work *k, const bench *b, char *to)
{
    if (!fits_float(k->in->type)) {
        store_medians_f64(k->out, b->rows, b->width, to);
        return;
    }
    for (size_t n = 0; n < SIDE * SIDE * b->width; n++)
        b->floats[n] = (float)b->rows[n];
    store_medians_f32(k->out, b->floats, b->width, to);
}

static void filter_slice(void *context, size_t z)
{
    work *k = context;
    const size_t width = k->in->dim[0] + SIDE + LANES, count = SIDE * SIDE * width;
    const size_t row = k->out->dim[0] * cw_type_size(k->out->type);
    char *to = cw_volume_voxels(k->out);
    double *memory = cwi_alloc_zeroed(2 * count, sizeof *memory);
    bench b = {.rows = memory, .width = width};
    if (!memory) {
        cwi_set_flag(&k->starved);
        return;
    }
    b.floats = (float *)(memory + count);
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
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_filter_desc none = {0}, *d = desc ? desc : &none;
    cw_volume in;
    *out = (cw_volume){0};
    if (radius < 1 || radius > MAX_RADIUS)
        return cwi_fail(err, CW_ERR_ARGUMENT, "radius is %zu; 1 to %d were expected", radius,
                        MAX_RADIUS);
    cw_status st = cwi_filter_input(volume, "a median", &in, err);
    if (st == CW_OK)
        st = cwi_filter_result(&in, in.type, in.dim, d, 0, out, err);
    if (st != CW_OK)
        return st;
    if (radius > 1 || cwi_filter_has_gaps(&in, d->threads))
        return cwi_median_tiles(&in, radius, d, out, err);
    work k = {.in = &in, .out = out};
    st = cwi_parallel_for(in.dim[2], in.dim[0] * in.dim[1] * CUBE, d->threads, &d->progress,
                          "smoothing", filter_slice, &k, err);
    if (st == CW_OK && k.starved)
        st = cwi_fail_memory(err);
    if (st != CW_OK)
        cw_volume_free(out);
    return st;
}
