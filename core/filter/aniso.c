/* Smooths a volume by diffusion along edges and not across [Weickert1998].
 *
 * A step adds to each voxel what flows in through its six faces. A step of 1 / (1 + 2 sum of 1 / h^2)
 * in units of the shortest distance h is that for which plain diffusion keeps every weight of a voxel
 * positive, for unequal distances too.
 *
 * All steps go through a chunk of slices together. Slice s of step n needs slices s - 2 to s + 2 of
 * step n - 1, so a thread keeps a few slices of each step, and no copy of the volume. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/stop.h"
#include "core/base/thread_pool.h"
#include "core/filter/edge_flow.h"
#include "core/filter/tiles.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

enum { MAX_ITERATIONS = 100, MIN_CHUNK = 16, MAX_CHUNK = 128 };

/* Slices that a thread keeps of each step: of values, smoothed ones, and flows. */
enum { RAW = 4, SMOOTH = 3, FLOWS = 1, REACH = 2 };

/* Contrast / noise where the contrast is not given: of 0.5, 1, 1.5 and 2.5 the one that left the least
 * error on the phantoms of the recipes. */
static const double CONTRAST = 0.5;

/* A filter at work: common to all threads. */
typedef struct work {
    const cw_volume *in;
    cw_volume *out;
    size_t steps, chunk;
    double base, unit;  /* values are (stored - base) / unit */
    float per_voxel[3]; /* the shortest distance between voxels / that along the axis */
    float time_step;
    cw_progress progress;
    bool has_gaps, starved;
} work;

/* The memory of a thread. Slices and rows have one more value at each end. */
typedef struct bench {
    double *values, *valid;       /* a row; valid is NULL without gaps */
    float *raw, *smooth, *upward; /* of each step: RAW, SMOOTH and FLOWS slices */
    float *work;                  /* a slice and a row, to smooth; the rows that flows take */
    float *flow;                  /* 5 rows: through faces along x, y twice, z; the result */
    size_t pitch, slice;          /* floats of a row and of a slice */
} bench;

static size_t work_floats(const work *k)
{
    const size_t pitch = k->in->dim[0] + 2, slice = pitch * (k->in->dim[1] + 2);
    const size_t smooth = slice + pitch, flow = cwi_flow_work(pitch);
    return smooth > flow ? smooth : flow;
}

static size_t bench_bytes(const work *k)
{
    const size_t pitch = k->in->dim[0] + 2, slice = pitch * (k->in->dim[1] + 2);
    return 2 * pitch * sizeof(double) +
           ((RAW + SMOOTH + FLOWS) * k->steps * slice + work_floats(k) + 5 * pitch) *
               sizeof(float);
}

/* Finds a slice in a ring of a step, or the one at the border. */
static float *find_slice(const work *k, float *rings, size_t size, size_t step, ptrdiff_t z)
{
    const size_t slice = (k->in->dim[0] + 2) * (k->in->dim[1] + 2);
    const ptrdiff_t last = (ptrdiff_t)k->in->dim[2] - 1;
    const size_t at = (size_t)(z < 0 ? 0 : z > last ? last : z);
    return rings + (size * step + at % size) * slice;
}

static float *raw_slice(const work *k, const bench *b, size_t step, ptrdiff_t z)
{
    return find_slice(k, b->raw, RAW, step, z);
}

static float *smoothed_slice(const work *k, const bench *b, size_t step, ptrdiff_t z)
{
    return find_slice(k, b->smooth, SMOOTH, step, z);
}

static void pad_slice(const work *k, const bench *b, float *slice)
{
    const size_t nx = k->in->dim[0], ny = k->in->dim[1];
    for (size_t j = 1; j <= ny; j++) {
        slice[j * b->pitch] = slice[j * b->pitch + 1];
        slice[j * b->pitch + nx + 1] = slice[j * b->pitch + nx];
    }
    memcpy(slice, slice + b->pitch, b->pitch * sizeof *slice);
    memcpy(slice + (ny + 1) * b->pitch, slice + ny * b->pitch, b->pitch * sizeof *slice);
}

static void load_slice(const work *k, const bench *b, size_t z)
{
    float *slice = raw_slice(k, b, 0, (ptrdiff_t)z);
    double base = k->base;
    for (size_t j = 0; j < k->in->dim[1]; j++)
        cwi_filter_load_floats(k->in, (size_t[]){0, j, z}, k->in->dim[0], k->unit, &base,
                               b->values, b->valid, slice + (j + 1) * b->pitch + 1);
    pad_slice(k, b, slice);
}

/* Smooths slice z of a step. */
static void smooth_slice(const work *k, const bench *b, size_t step, size_t z)
{
    const ptrdiff_t s = (ptrdiff_t)z;
    const float *const raw[3] = {raw_slice(k, b, step, s - 1), raw_slice(k, b, step, s),
                                 raw_slice(k, b, step, s + 1)};
    float *to = smoothed_slice(k, b, step, s);
    cwi_smooth_slice(raw, b->pitch, k->in->dim[1], b->work, to);
    pad_slice(k, b, to);
}

/* Describes the slices of a step around slice z. */
static cwi_flow_slices slices_around(const work *k, const bench *b, size_t step, ptrdiff_t z)
{
    cwi_flow_slices s = {.pitch = b->pitch};
    for (int n = 0; n < 3; n++) {
        s.raw[n] = raw_slice(k, b, step, z + n - 1);
        s.smooth[n] = smoothed_slice(k, b, step, z + n - 1);
        s.per_voxel[n] = k->per_voxel[n];
    }
    return s;
}

/* Sets what flows through the faces behind a row or slice, of which the last has none. */
static void find_flow(const work *k, const bench *b, const cwi_flow_slices *s, size_t row,
                      int axis, bool is_last, float *flow)
{
    const size_t count = k->in->dim[0];
    if (is_last)
        memset(flow, 0, count * sizeof *flow);
    else
        cwi_edge_flow(s, row, axis, count, b->work, flow);
}

/* Stores a row of the last step. */
static void store_row(const work *k, const bench *b, const float *made, size_t j, size_t z)
{
    const size_t nx = k->in->dim[0], size = cw_type_size(k->out->type);
    char *to = (char *)cw_volume_voxels(k->out) + (z * k->in->dim[1] + j) * nx * size;
    float *before = b->flow; /* no longer needed */
    double base = k->base;
    cwi_filter_load_floats(k->in, (size_t[]){0, j, z}, nx, k->unit, &base, b->values, b->valid,
                           before);
    for (size_t i = 0; i < nx; i++, to += size)
        if (b->valid && !(b->valid[i] > 0))
            cwi_filter_store_gap(k->out, to);
        else
            cwi_filter_store(k->out, to,
                             b->values[i] + k->unit * (double)(made[i] - before[i]));
}

/* Makes slice z of a step from slices of the step before. */
static void step_slice(const work *k, const bench *b, size_t step, size_t z)
{
    const size_t nx = k->in->dim[0], ny = k->in->dim[1], p = b->pitch;
    const cwi_flow_slices s = slices_around(k, b, step - 1, (ptrdiff_t)z);
    float *made_slice = step < k->steps ? raw_slice(k, b, step, (ptrdiff_t)z) : NULL;
    float *x = b->flow, *before = x + p, *behind = x + 2 * p, *above = x + 3 * p,
          *made = x + 4 * p;
    memset(before, 0, nx * sizeof *before);
    for (size_t j = 1; j <= ny; j++) {
        const float *value = s.raw[1] + j * p + 1;
        float *below = b->upward + (step - 1) * b->slice + j * p;
        find_flow(k, b, &s, j, 0, false, x + 1);
        x[0] = x[nx] = 0;
        find_flow(k, b, &s, j, 1, j == ny, behind);
        find_flow(k, b, &s, j, 2, z + 1 == k->in->dim[2], above);
        for (size_t i = 0; i < nx; i++)
            made[i] = value[i] + k->time_step * (x[i + 1] - x[i] + (behind[i] - before[i]) +
                                                 (above[i] - below[i]));
        memcpy(below, above, nx * sizeof *below);
        memcpy(before, behind, nx * sizeof *before);
        if (made_slice)
            memcpy(made_slice + j * p + 1, made, nx * sizeof *made);
        else
            store_row(k, b, made, j - 1, z);
    }
    if (made_slice)
        pad_slice(k, b, made_slice);
}

/* Sets what flows up into the first slice of a step that a chunk needs. */
static void begin_step(const work *k, const bench *b, size_t step, size_t z)
{
    const cwi_flow_slices s = slices_around(k, b, step - 1, (ptrdiff_t)z - 1);
    for (size_t j = 1; j <= k->in->dim[1]; j++)
        find_flow(k, b, &s, j, 2, z == 0, b->upward + (step - 1) * b->slice + j * b->pitch);
}

/* Makes the slice of a step whose turn it is, if the chunk needs it, and the smoothed ones of the step
 * before. Later steps need REACH slices more at each end. */
static void advance_step(const work *k, const bench *b, size_t step, size_t z, size_t begin,
                         size_t end)
{
    const size_t ahead = REACH * (k->steps - step), last = k->in->dim[2] - 1;
    const size_t first = begin < ahead ? 0 : begin - ahead;
    if (z > last || z >= end + ahead)
        return;
    if (z + 1 == first || z == first)
        smooth_slice(k, b, step - 1, z);
    if (z < first)
        return;
    if (z == first)
        begin_step(k, b, step, z);
    if (z < last)
        smooth_slice(k, b, step - 1, z + 1);
    step_slice(k, b, step, z);
}

/* Makes the slices of a chunk. Each round loads a slice and makes one of every step, which is REACH
 * slices behind the step before. */
static void filter_slices(work *k, const bench *b, size_t chunk)
{
    const size_t begin = chunk * k->chunk, left = k->in->dim[2] - begin,
                 end = begin + (left < k->chunk ? left : k->chunk);
    const size_t ahead = REACH * k->steps;
    for (size_t z = begin < ahead ? 0 : begin - ahead; z < end + ahead; z++) {
        if (cwi_progress(&k->progress, "smoothing", -1, NULL) != CW_OK)
            return;
        if (z < k->in->dim[2])
            load_slice(k, b, z);
        for (size_t step = 1; step <= k->steps && REACH * step <= z; step++)
            advance_step(k, b, step, z - REACH * step, begin, end);
    }
}

static void filter_chunk(void *context, size_t chunk)
{
    work *k = context;
    double *memory = cwi_alloc_zeroed(bench_bytes(k), 1);
    bench b = {.values = memory, .pitch = k->in->dim[0] + 2};
    if (!memory) {
        cwi_set_flag(&k->starved);
        return;
    }
    b.slice = b.pitch * (k->in->dim[1] + 2);
    b.valid = k->has_gaps ? memory + b.pitch : NULL;
    b.flow = (float *)(memory + 2 * b.pitch);
    b.work = b.flow + 5 * b.pitch;
    b.raw = b.work + work_floats(k);
    b.smooth = b.raw + RAW * k->steps * b.slice;
    b.upward = b.smooth + SMOOTH * k->steps * b.slice;
    filter_slices(k, &b, chunk);
    cwi_free(memory);
}

/* Sets the distances between voxels and the step, for which no weight of a voxel is negative. */
static void set_distances(work *k)
{
    double mm[3], min_mm = INFINITY, sum = 0;
    cw_volume_spacing(k->in, mm);
    for (int a = 0; a < 3; a++)
        min_mm = mm[a] > 0 && k->in->dim[a] > 1 ? fmin(min_mm, mm[a]) : min_mm;
    for (int a = 0; a < 3; a++) {
        const double ratio = mm[a] > 0 && isfinite(min_mm) ? fmin(min_mm / mm[a], 1) : 1;
        k->per_voxel[a] = (float)ratio;
        sum += k->in->dim[a] > 1 ? ratio * ratio : 0;
    }
    k->time_step = (float)(1 / (1 + 2 * sum));
}

/* Sets the first value of the volume as the base. */
static cw_status set_base(work *k, cw_error *err)
{
    const size_t *dim = k->in->dim;
    double *row = cwi_alloc_array(2 * dim[0], sizeof *row);
    if (!row)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < dim[1] * dim[2] && !isfinite(k->base); n++) {
        cwi_filter_load(k->in, n % dim[1], n / dim[1], row, row + dim[0]);
        for (size_t i = 0; i < dim[0] && !isfinite(k->base); i++)
            k->base = row[dim[0] + i] > 0 ? row[i] : k->base;
    }
    k->base = isfinite(k->base) ? k->base : 0;
    cwi_free(row);
    return CW_OK;
}

/* Returns how many threads there is memory for: at least one. */
static size_t choose_threads(const work *k, const cw_filter_desc *d)
{
    const size_t *dim = k->in->dim, threads = (size_t)cwi_threads(d->threads);
    const size_t result = dim[0] * dim[1] * dim[2] * cw_type_size(cw_filter_type(k->in));
    const size_t left = d->max_bytes > result ? d->max_bytes - result : 0;
    const size_t fit = d->max_bytes ? left / bench_bytes(k) : threads;
    return fit < 1 ? 1 : fit < threads ? fit : threads;
}

static cw_status run_steps(work *k, const cw_filter_desc *d, cw_error *err)
{
    const size_t *dim = k->in->dim, threads = choose_threads(k, d);
    const size_t chunk_layers = (dim[2] + threads - 1) / threads;
    cwi_stop stop;
    k->chunk = chunk_layers < MIN_CHUNK   ? MIN_CHUNK
               : chunk_layers > MAX_CHUNK ? MAX_CHUNK
                                          : chunk_layers;
    const size_t chunks = (dim[2] + k->chunk - 1) / k->chunk;
    const size_t bytes = bench_bytes(k) * (threads < chunks ? threads : chunks);
    cw_status st = cwi_filter_result(k->in, cw_filter_type(k->in), dim, d, bytes, k->out, err);
    if (st != CW_OK)
        return st;
    k->has_gaps = cwi_filter_has_gaps(k->in, d->threads);
    set_distances(k);
    cwi_stop_init(&stop, &d->progress);
    k->progress = cwi_stop_progress(&stop);
    st = set_base(k, err);
    if (st == CW_OK)
        st = cwi_parallel_for(chunks, k->chunk * dim[0] * dim[1] * k->steps, (int)threads,
                              &k->progress, "smoothing", filter_chunk, k, err);
    if (st == CW_OK && stop.stopped)
        st = cwi_fail(err, CW_ERR_CANCELLED, "interrupted while smoothing");
    if (st == CW_OK && k->starved)
        st = cwi_fail_memory(err);
    return st;
}

cw_status cw_volume_aniso(const cw_volume *volume, size_t steps, double contrast,
                          const cw_filter_desc *desc, cw_volume *out, cw_error *err)
{
    CWI_REQUIRE(err, volume, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_filter_desc none = {0}, *d = desc ? desc : &none;
    cw_volume in;
    *out = (cw_volume){0};
    if (steps < 1 || steps > MAX_ITERATIONS)
        return cwi_fail(err, CW_ERR_ARGUMENT, "steps is %zu; 1 to %d were expected", steps,
                        MAX_ITERATIONS);
    if (!(contrast >= 0 && isfinite(contrast)))
        return cwi_fail(err, CW_ERR_ARGUMENT, "contrast is %g; 0 or more was expected",
                        contrast);
    cw_status st = cwi_filter_input(volume, "diffusion", &in, err);
    if (st == CW_OK && contrast == 0) {
        st = cw_volume_noise(&in, d->threads, &contrast, err);
        contrast *= CONTRAST;
    }
    if (st != CW_OK)
        return st;
    work k = {.in = &in,
              .out = out,
              .steps = steps,
              .base = INFINITY,
              .unit = contrast > 0 ? contrast / fabs(in.slope) : 1};
    if (contrast > 0)
        st = run_steps(&k, d, err);
    else /* there is no noise */
        st = cwi_filter_tiles(&in, &(cwi_tile_filter){.step = "smoothing", .cost = 1}, d, out,
                              err);
    if (st != CW_OK)
        cw_volume_free(out);
    return st;
}
