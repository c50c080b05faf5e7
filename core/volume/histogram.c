/* Computes histograms of volumes, whole or in parts, and Otsu thresholds from them [Otsu1979], [Liao2001]. */
#include "core/volume/histogram.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

static bool is_integer(cw_type type)
{
    return type != CW_F32 && type != CW_F64;
}

/* Loads one row's values, scaled; leaves no-data ones out and counts them. */
static size_t load_row(const cw_volume *v, size_t j, size_t k, double *values, size_t *nodata)
{
    const char *p = cwi_voxel_address(v, 0, j, k);
    size_t n = 0;
    for (size_t i = 0; i < v->dim[0]; i++, p += v->stride[0]) {
        const double x = cwi_voxel_at(v->type, p);
        if (v->has_nodata && x == v->nodata)
            (*nodata)++;
        else
            values[n++] = v->slope * x + v->intercept;
    }
    return n;
}

/* Updates range and counts of values by a row; both are the same in any order. */
static void scan_row(const double *values, size_t n, cw_statistics *s)
{
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(values[i])) {
            s->not_finite++;
            continue;
        }
        s->finite++;
        s->min = values[i] < s->min ? values[i] : s->min;
        s->max = values[i] > s->max ? values[i] : s->max;
    }
}

/* Returns the bin of a finite value. Values of integer types are counted in whole steps: a
 * slope such as 2.02 must not round one into the bin below. */
static size_t bin_of(const cw_statistics *s, double value)
{
    const bool whole = s->quantum > 0;
    const double steps = whole ? rint((s->max - s->min) / s->quantum) + 1 : 0;
    const double bins = (double)s->bin_count;
    double bin = (value - s->min) / (whole ? s->quantum : s->bin_width);
    bin = whole ? rint(bin) * bins / steps : bin;
    return bin < bins ? (size_t)bin : s->bin_count - 1;
}

static void count_row(const double *values, size_t n, cw_statistics *s)
{
    for (size_t i = 0; i < n; i++)
        if (isfinite(values[i]))
            s->bins[bin_of(s, values[i])]++;
}

static void set_bins(cw_statistics *s, size_t bin_count)
{
    double span = s->max - s->min;
    if (s->quantum > 0) {
        span += s->quantum;
        const double values = span / s->quantum;
        bin_count = values < (double)bin_count ? (size_t)(values + 0.5) : bin_count;
    } else if (span == 0) {
        bin_count = 1;
    }
    s->bin_count = bin_count;
    s->bin_width = span > 0 ? span / (double)bin_count : 1;
}

/* A count of all rows, in blocks of slices. A block has counts of its own, which are added to the
 * totals when it is done. */
typedef struct counting {
    const cw_volume *v;
    size_t slices; /* of a block */
    bool bins, is_starved;
    pthread_mutex_t lock; /* for the totals */
    cw_statistics *total;
    uint64_t *shorts;
} counting;

/* Adds the sums of a block, in any order because they are whole numbers, minima and maxima. */
static void add_block(counting *c, const cw_statistics *s)
{
    cw_statistics *total = c->total;
    pthread_mutex_lock(&c->lock);
    for (size_t b = 0; c->bins && b < s->bin_count; b++)
        total->bins[b] += s->bins[b];
    if (!c->bins) {
        total->min = fmin(total->min, s->min);
        total->max = fmax(total->max, s->max);
        total->finite += s->finite;
        total->not_finite += s->not_finite;
        total->nodata += s->nodata;
    }
    pthread_mutex_unlock(&c->lock);
}

static size_t block_end(const counting *c, size_t block)
{
    const size_t end = (block + 1) * c->slices;
    return end < c->v->dim[2] ? end : c->v->dim[2];
}

static void count_block(void *context, size_t block)
{
    counting *c = context;
    const cw_volume *v = c->v;
    cw_statistics s = cwi_statistics_of(v);
    double *values = cwi_alloc_array(v->dim[0], sizeof *values);
    if (c->bins) {
        s = *c->total;
        s.bins = cwi_alloc_zeroed(s.bin_count, sizeof *s.bins);
    }
    if (!values || (c->bins && !s.bins)) {
        cwi_set_flag(&c->is_starved);
    } else {
        for (size_t k = block * c->slices; k < block_end(c, block); k++)
            for (size_t j = 0; j < v->dim[1]; j++) {
                const size_t n = load_row(v, j, k, values, &s.nodata);
                (c->bins ? count_row : scan_row)(values, n, &s);
            }
        add_block(c, &s);
    }
    cwi_free(values);
    cwi_free(c->bins ? s.bins : NULL);
}

/* Divides the volume into blocks that take far longer to count than to add, and counts them. */
static void each_block(counting *c, int threads, void (*count)(void *context, size_t block))
{
    enum { BLOCK_SAMPLES = 1 << 20 };
    const size_t slice = c->v->dim[0] * c->v->dim[1];
    c->slices = BLOCK_SAMPLES / slice + 1;
    pthread_mutex_init(&c->lock, NULL);
    cwi_parallel_for_all((c->v->dim[2] + c->slices - 1) / c->slices, c->slices * slice, threads,
                         count, c);
    pthread_mutex_destroy(&c->lock);
}

/* Calls one of the two row functions for every row. */
static cw_status each_row(const cw_volume *v, int threads, bool bins, cw_statistics *total,
                          cw_error *err)
{
    counting c = {.v = v, .bins = bins, .total = total};
    each_block(&c, threads, count_block);
    return c.is_starved ? cwi_fail_memory(err) : CW_OK;
}

/* Returns true for types with so few numbers that the frequency of each can be counted. */
static bool is_short(cw_type type)
{
    return is_integer(type) && cw_type_size(type) <= 2;
}

enum { SHORTS = 1 << 16, SHORT_ZERO = 1 << 15 };

static void count_shorts(const cw_volume *v, size_t j, size_t k, uint64_t *counts)
{
    const char *p = cwi_voxel_address(v, 0, j, k);
    switch (v->type) {
#define CASE(name, ctype)                                                                      \
    case name:                                                                                 \
        for (size_t i = 0; i < v->dim[0]; i++)                                                 \
            counts[SHORT_ZERO + *(const ctype *)(p + (ptrdiff_t)i * v->stride[0])]++;          \
        break;
        CASE(CW_U8, uint8_t)
        CASE(CW_I8, int8_t)
        CASE(CW_I16, int16_t)
#undef CASE
    case CW_U16: /* a type without negative numbers */
        for (size_t i = 0; i < v->dim[0]; i++)
            counts[*(const uint16_t *)(p + (ptrdiff_t)i * v->stride[0])]++;
        break;
    default:
        break;
    }
}

static void count_block_shorts(void *context, size_t block)
{
    counting *c = context;
    uint64_t *own = cwi_alloc_zeroed(SHORTS, sizeof *own);
    if (!own) {
        cwi_set_flag(&c->is_starved);
        return;
    }
    for (size_t k = block * c->slices; k < block_end(c, block); k++)
        for (size_t j = 0; j < c->v->dim[1]; j++)
            count_shorts(c->v, j, k, own);
    pthread_mutex_lock(&c->lock);
    for (size_t n = 0; n < SHORTS; n++)
        c->shorts[n] += own[n];
    pthread_mutex_unlock(&c->lock);
    cwi_free(own);
}

/* Counts the frequency of each number, from the lowest; returns NULL without memory. */
static uint64_t *count_all_shorts(const cw_volume *v, int threads)
{
    counting c = {.v = v, .shorts = cwi_alloc_zeroed(SHORTS, sizeof *c.shorts)};
    if (c.shorts)
        each_block(&c, threads, count_block_shorts);
    if (!c.is_starved)
        return c.shorts;
    cwi_free(c.shorts);
    return NULL;
}

static double short_at(const cw_volume *v, size_t n)
{
    return (double)n - (v->type == CW_U16 ? 0 : SHORT_ZERO);
}

/* Computes the results of scan_row() over all rows from the frequencies. */
static void scan_shorts(const cw_volume *v, const uint64_t *counts, cw_statistics *s)
{
    for (size_t n = 0; n < SHORTS; n++) {
        const double x = short_at(v, n), value = v->slope * x + v->intercept;
        if (!counts[n])
            continue;
        if (v->has_nodata && x == v->nodata) {
            s->nodata += counts[n];
            continue;
        }
        if (!isfinite(value)) {
            s->not_finite += counts[n];
            continue;
        }
        s->finite += counts[n];
        s->min = fmin(s->min, value);
        s->max = fmax(s->max, value);
    }
}

static void bin_shorts(const cw_volume *v, const uint64_t *counts, cw_statistics *s)
{
    for (size_t n = 0; n < SHORTS; n++) {
        const double x = short_at(v, n), value = v->slope * x + v->intercept;
        if (counts[n] && isfinite(value) && !(v->has_nodata && x == v->nodata))
            s->bins[bin_of(s, value)] += counts[n];
    }
}

cw_statistics cwi_statistics_of(const cw_volume *shape)
{
    return (cw_statistics){.min = INFINITY,
                           .max = -INFINITY,
                           .quantum = is_integer(shape->type) ? fabs(shape->slope) : 0};
}

cw_status cwi_statistics_scan(cw_statistics *s, const cw_volume *part, int threads,
                              cw_error *err)
{
    return each_row(part, threads, false, s, err);
}

cw_status cwi_statistics_divide(cw_statistics *s, size_t bin_count, cw_error *err)
{
    if (!s->finite)
        s->min = s->max = 0;
    if (!bin_count || !s->finite)
        return CW_OK;
    set_bins(s, bin_count);
    s->bins = cwi_alloc_zeroed(s->bin_count, sizeof *s->bins);
    return s->bins ? CW_OK : cwi_fail_memory(err);
}

cw_status cwi_statistics_count(cw_statistics *s, const cw_volume *part, int threads,
                               cw_error *err)
{
    return s->bins ? each_row(part, threads, true, s, err) : CW_OK;
}

/* Computes the range first, then the bins; for short types both from the frequencies of all
 * numbers. */
static cw_status gather_histogram(const cw_volume *v, size_t bin_count, int threads,
                                  cw_statistics *s, cw_error *err)
{
    cw_status st = CW_OK;
    uint64_t *counts = NULL;
    if (is_short(v->type) && !(counts = count_all_shorts(v, threads)))
        return cwi_fail_memory(err);
    if (counts)
        scan_shorts(v, counts, s);
    else
        st = cwi_statistics_scan(s, v, threads, err);
    if (st == CW_OK)
        st = cwi_statistics_divide(s, bin_count, err);
    if (st == CW_OK && counts && s->bins)
        bin_shorts(v, counts, s);
    else if (st == CW_OK)
        st = cwi_statistics_count(s, v, threads, err);
    cwi_free(counts);
    return st;
}

cw_status cw_volume_statistics(const cw_volume *volume, size_t bin_count, int threads,
                               cw_statistics *out, cw_error *err)
{
    CWI_REQUIRE(err, volume, out);
    cw_volume v;
    memset(out, 0, sizeof *out);
    cw_status st = cw_volume_select(volume, 0, 0, &v, err);
    if (st != CW_OK)
        return st;
    if (v.sparse) { /* leaves are stored one after another */
        v.dim[0] = v.dim[1] = CWI_LEAF;
        v.dim[2] = CWI_LEAF * v.sparse->leaf_count;
    }
    cw_statistics s = cwi_statistics_of(&v);
    st = gather_histogram(&v, bin_count, threads, &s, err);
    if (st == CW_OK)
        *out = s;
    else
        cw_statistics_free(&s);
    return st;
}

void cw_statistics_free(cw_statistics *statistics)
{
    if (!statistics)
        return;
    cwi_free(statistics->bins);
    memset(statistics, 0, sizeof *statistics);
}

/* Joins ranges and counts. Bins of integer types keep whole steps if all parts have the same. */
static void join_ranges(const cw_statistics *parts, size_t count, cw_statistics *s)
{
    *s = (cw_statistics){.min = INFINITY, .max = -INFINITY};
    for (size_t n = 0; n < count; n++) {
        const cw_statistics *p = &parts[n];
        s->not_finite += p->not_finite;
        s->nodata += p->nodata;
        if (!p->finite)
            continue;
        s->quantum = s->finite && s->quantum != p->quantum ? 0 : p->quantum;
        s->finite += p->finite;
        s->min = fmin(s->min, p->min);
        s->max = fmax(s->max, p->max);
    }
    if (!s->finite)
        s->min = s->max = 0;
}

cw_status cw_statistics_join(const cw_statistics *parts, size_t count, size_t bin_count,
                             cw_statistics *out, cw_error *err)
{
    CWI_REQUIRE(err, out);
    CWI_REQUIRE_ARRAY(err, parts, count);
    join_ranges(parts, count, out);
    if (!bin_count || !out->finite)
        return CW_OK;
    set_bins(out, bin_count);
    out->bins = cwi_alloc_zeroed(out->bin_count, sizeof *out->bins);
    if (!out->bins)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < count; n++)
        for (size_t b = 0; b < parts[n].bin_count; b++) {
            const double middle = parts[n].min + parts[n].bin_width * ((double)b + 0.5);
            out->bins[bin_of(out, middle - parts[n].quantum / 2)] += parts[n].bins[b];
        }
    return CW_OK;
}

/* Zeroth and first moments of the bins before b, so that a class is a difference of two. */
typedef struct moments {
    double *count, *sum;
} moments;

/* Returns the contribution of a class of bins [from, to) to the variance between classes, up to
 * a constant. */
static double class_variance(const moments *m, size_t from, size_t to)
{
    const double count = m->count[to] - m->count[from], sum = m->sum[to] - m->sum[from];
    return count > 0 ? sum * sum / count : -1;
}

/* Computes best[c][b]: the largest variance of bins [0, b) in c + 1 classes, none empty.
 * from[c][b] is the start of the last class. */
static void divide_classes(const moments *m, size_t bins, int classes, double *best,
                           size_t *from)
{
    const size_t row = bins + 1;
    for (size_t b = 0; b <= bins; b++)
        best[b] = class_variance(m, 0, b);
    for (size_t c = 1; c < (size_t)classes; c++)
        for (size_t b = 0; b <= bins; b++) {
            best[c * row + b] = -1;
            for (size_t a = c; a < b; a++) {
                const double head = best[(c - 1) * row + a], tail = class_variance(m, a, b);
                if (head >= 0 && tail >= 0 && head + tail > best[c * row + b]) {
                    best[c * row + b] = head + tail;
                    from[c * row + b] = a;
                }
            }
        }
}

/* Returns the level between two classes: the middle of the empty bins between them. For
 * integers it is between two values, where no sample lies. */
static double level_before(const cw_statistics *s, size_t bin)
{
    size_t below = bin;
    while (below > 0 && s->bins[below - 1] == 0)
        below--;
    return s->min + 0.5 * (double)(below + bin) * s->bin_width - 0.5 * s->quantum;
}

bool cw_statistics_otsu(const cw_statistics *s, int level_count, double *levels)
{
    if (!s || !levels)
        return false;
    const size_t bins = s->bin_count, row = bins + 1, classes = (size_t)level_count + 1;
    if (level_count < 1 || level_count > 3 || !s->bins)
        return false;
    double *memory = cwi_alloc_zeroed((2 + classes) * row, sizeof *memory);
    size_t *from = cwi_alloc_zeroed(classes * row, sizeof *from);
    bool found = memory && from;
    if (found) {
        const moments m = {memory, memory + row};
        double *best = memory + 2 * row;
        for (size_t b = 0; b < bins; b++) {
            m.count[b + 1] = m.count[b] + (double)s->bins[b];
            m.sum[b + 1] = m.sum[b] + (double)s->bins[b] * ((double)b + 0.5);
        }
        divide_classes(&m, bins, (int)classes, best, from);
        found = best[(classes - 1) * row + bins] >= 0;
        for (size_t c = classes - 1, b = bins; c > 0 && found; c--) {
            b = from[c * row + b];
            while (b + 1 < bins && s->bins[b] == 0)
                b++;
            levels[c - 1] = level_before(s, b);
        }
    }
    cwi_free(memory);
    cwi_free(from);
    return found;
}
