/* Filters slices along x and y as they are needed, and joins them along z. A thread keeps as many
 * slices as the weights along z reach over. Each sum is in the order of its samples. */
#include "core/filter/separable.h"
#include "core/base/thread_pool.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

enum { CHUNK = 32 }; /* output slices that a thread makes in a row */

cw_status cwi_axis_weights_init(cwi_axis_weights *w, size_t count, size_t taps, cw_error *err)
{
    *w = (cwi_axis_weights){.count = count, .taps = taps};
    w->first = cwi_alloc_zeroed(count, sizeof *w->first);
    w->nearest = cwi_alloc_zeroed(count, sizeof *w->nearest);
    size_t weights;
    if (cwi_size_mul(count, taps, &weights))
        w->weights = cwi_alloc_zeroed(weights, sizeof *w->weights);
    if (w->first && w->nearest && w->weights)
        return CW_OK;
    cwi_axis_weights_free(w);
    return cwi_fail_memory(err);
}

void cwi_axis_weights_free(cwi_axis_weights *w)
{
    cwi_free(w->first);
    cwi_free(w->nearest);
    cwi_free(w->weights);
    *w = (cwi_axis_weights){0};
}

static size_t clamp_index(double x, size_t samples)
{
    return x <= 0 ? 0 : x >= (double)(samples - 1) ? samples - 1 : (size_t)x;
}

void cwi_axis_weights_set(cwi_axis_weights *w, size_t n, double position, size_t samples,
                          double reach, double (*kernel)(double x, double width), double width)
{
    const double begin = ceil(position - reach), end = floor(position + reach);
    double *weights = w->weights + n * w->taps, sum = 0;
    const size_t first = clamp_index(begin, samples);
    w->first[n] = first;
    w->nearest[n] = clamp_index(floor(position + 0.5), samples);
    for (double x = begin; x <= end; x++) {
        const double weight = kernel(x - position, width);
        weights[clamp_index(x, samples) - first] += weight;
        sum += weight;
    }
    for (size_t t = 0; t < w->taps; t++)
        weights[t] /= sum;
}

/* A filter at work: common to all threads. */
typedef struct work {
    const cw_volume *in;
    cw_volume *out;
    const cwi_axis_weights *w;
    bool has_gaps, starved;
} work;

/* The memory of a thread. There are two planes of everything: values, and where there are
 * gaps the sums of the weights of those that are there. */
typedef struct bench {
    double *row;         /* an input row */
    double *rows;        /* the input rows of a slice, filtered along x */
    double *ring;        /* slices, filtered along x and y */
    double *line;        /* an output row */
    size_t planes, next; /* input slice that comes next */
} bench;

static size_t bench_doubles(const work *k, size_t sizes[4])
{
    const size_t planes = k->has_gaps ? 2 : 1, *to = k->out->dim;
    sizes[0] = planes * k->in->dim[0];
    sizes[1] = planes * to[0] * k->in->dim[1];
    sizes[2] = planes * to[0] * to[1] * k->w[2].taps;
    sizes[3] = planes * to[0];
    return sizes[0] + sizes[1] + sizes[2] + sizes[3];
}

/* Adds weighted rows: to[i] = sum of w[t] from[t stride + i]. */
static void add_rows(double *restrict to, const double *restrict from, size_t stride,
                     const double *w, size_t taps, size_t count)
{
    memset(to, 0, count * sizeof *to);
    for (size_t t = 0; t < taps; t++) {
        const double weight = w[t], *row = from + t * stride;
        if (weight == 0) /* behind the last sample, too */
            continue;
        for (size_t i = 0; i < count; i++)
            to[i] += weight * row[i];
    }
}

static void filter_row(const cwi_axis_weights *w, const double *restrict row,
                       double *restrict to, size_t samples)
{
    for (size_t n = 0; n < w->count; n++) {
        const double *weights = w->weights + n * w->taps, *from = row + w->first[n];
        const size_t left = samples - w->first[n], taps = left < w->taps ? left : w->taps;
        double sum = 0;
        for (size_t t = 0; t < taps; t++)
            sum += weights[t] * from[t];
        to[n] = sum;
    }
}

/* Puts the next input slice into the ring, filtered along x and y. */
static void take_slice(const work *k, bench *b)
{
    const size_t nx = k->in->dim[0], ny = k->in->dim[1], mx = k->out->dim[0],
                 my = k->out->dim[1], slot = b->next % k->w[2].taps;
    for (size_t j = 0; j < ny; j++) {
        cwi_filter_load(k->in, j, b->next, b->row, k->has_gaps ? b->row + nx : NULL);
        for (size_t p = 0; p < b->planes; p++)
            filter_row(k->w, b->row + p * nx, b->rows + (p * ny + j) * mx, nx);
    }
    for (size_t p = 0; p < b->planes; p++)
        for (size_t j = 0; j < my; j++) {
            const cwi_axis_weights *w = k->w + 1;
            const size_t left = ny - w->first[j];
            add_rows(b->ring + ((slot * b->planes + p) * my + j) * mx,
                     b->rows + (p * ny + w->first[j]) * mx, mx, w->weights + j * w->taps,
                     left < w->taps ? left : w->taps, mx);
        }
    b->next++;
}

/* Makes an output row from the slices of the ring. */
static void join_slices(const work *k, bench *b, size_t j, size_t z)
{
    const cwi_axis_weights *w = k->w + 2;
    const size_t mx = k->out->dim[0], my = k->out->dim[1];
    memset(b->line, 0, b->planes * mx * sizeof *b->line);
    for (size_t t = 0; t < w->taps; t++) {
        const double weight = w->weights[z * w->taps + t];
        const size_t slot = (w->first[z] + t) % w->taps;
        if (weight == 0)
            continue;
        for (size_t p = 0; p < b->planes; p++) {
            const double *row = b->ring + ((slot * b->planes + p) * my + j) * mx;
            double *line = b->line + p * mx;
            for (size_t i = 0; i < mx; i++)
                line[i] += weight * row[i];
        }
    }
}

/* Returns true if the input sample nearest to an output sample has no value. */
static bool is_gap(const work *k, size_t i, size_t j, size_t z)
{
    const cw_volume *in = k->in;
    const double x =
        cwi_voxel_at(in->type, cwi_voxel_address(in, k->w[0].nearest[i], k->w[1].nearest[j],
                                                 k->w[2].nearest[z]));
    return !isfinite(x) || (in->has_nodata && x == in->nodata);
}

/* A sum of weights this near to 1 has all of them: a value then does not depend on gaps elsewhere. */
static const double ROUNDING = 1e-12;

/* Weights of kernels may be negative: where too few values are left, their sum means nothing. */
static const double MIN_WEIGHT = 0.25;

static void store_row(const work *k, const bench *b, size_t j, size_t z)
{
    const size_t mx = k->out->dim[0], size = cw_type_size(k->out->type);
    char *to = (char *)cw_volume_voxels(k->out) + (z * k->out->dim[1] + j) * mx * size;
    for (size_t i = 0; i < mx; i++, to += size) {
        const double left = k->has_gaps ? b->line[mx + i] : 1,
                     weight = fabs(left - 1) < ROUNDING ? 1 : left;
        if (k->has_gaps && (is_gap(k, i, j, z) || weight < MIN_WEIGHT))
            cwi_filter_store_gap(k->out, to);
        else
            cwi_filter_store(k->out, to, b->line[i] / weight);
    }
}

static void filter_slices(const work *k, bench *b, size_t chunk)
{
    const cwi_axis_weights *w = k->w + 2;
    const size_t end = k->in->dim[2];
    b->next = w->first[CHUNK * chunk];
    for (size_t z = CHUNK * chunk; z < CHUNK * (chunk + 1) && z < w->count; z++) {
        b->next = b->next < w->first[z] ? w->first[z] : b->next;
        while (b->next < end && b->next < w->first[z] + w->taps)
            take_slice(k, b);
        for (size_t j = 0; j < k->out->dim[1]; j++) {
            join_slices(k, b, j, z);
            store_row(k, b, j, z);
        }
    }
}

static void filter_chunk(void *context, size_t chunk)
{
    work *k = context;
    size_t sizes[4];
    double *memory = cwi_alloc_array(bench_doubles(k, sizes), sizeof *memory);
    bench b = {.row = memory, .planes = k->has_gaps ? 2 : 1};
    if (!memory) {
        cwi_set_flag(&k->starved);
        return;
    }
    b.rows = b.row + sizes[0];
    b.ring = b.rows + sizes[1];
    b.line = b.ring + sizes[2];
    filter_slices(k, &b, chunk);
    cwi_free(memory);
}

cw_status cwi_separable_filter(const cw_volume *in, const cwi_axis_weights w[3],
                               const cw_filter_desc *desc, const char *step, cw_volume *out,
                               cw_error *err)
{
    const size_t dim[3] = {w[0].count, w[1].count, w[2].count};
    const size_t chunks = (dim[2] + CHUNK - 1) / CHUNK;
    work k = {.in = in, .out = out, .w = w, .has_gaps = cwi_filter_has_gaps(in, desc->threads)};
    size_t sizes[4];
    *out = (cw_volume){.dim = {dim[0], dim[1], dim[2]}};
    const size_t threads = (size_t)cwi_threads(desc->threads),
                 bytes = bench_doubles(&k, sizes) * sizeof(double) *
                         (threads < chunks ? threads : chunks);
    cw_status st = cwi_filter_result(in, cw_filter_type(in), dim, desc, bytes, out, err);
    if (st == CW_OK)
        st = cwi_parallel_for(chunks, CHUNK * dim[0] * dim[1], desc->threads, &desc->progress,
                              step, filter_chunk, &k, err);
    if (st == CW_OK && k.starved)
        st = cwi_fail_memory(err);
    if (st != CW_OK)
        cw_volume_free(out);
    return st;
}
