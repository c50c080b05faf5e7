/* Estimates the noise of a volume from how far voxels differ from the mean of their neighbours. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/filter/filter_work.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

/* Bins of differences: the leading bits of a float above 0, whose order is that of the numbers.
 * A bin is 1/1024 of its number wide. */
enum { DROPPED_BITS = 13, BINS = 1 << (31 - DROPPED_BITS), ROWS = 5 };

typedef struct work {
    const cw_volume *in;
    size_t *counts; /* BINS */
    bool has_gaps, starved;
} work;

static size_t find_bin(double difference)
{
    const float number = (float)fmin(difference, 1e38);
    uint32_t bits;
    memcpy(&bits, &number, sizeof bits);
    return bits >> DROPPED_BITS;
}

static double bin_middle(size_t bin)
{
    const uint32_t bits = (uint32_t)bin << DROPPED_BITS | 1u << (DROPPED_BITS - 1);
    float number;
    memcpy(&number, &bits, sizeof number);
    return (double)number;
}

/* Adds a difference to those of its axis, of three numbers in a row; none without values. */
static void add_second(double before, double middle, double after, double *sum, int *count)
{
    *sum += 2 * middle - before - after;
    *count += 2;
}

/* Counts the differences of a row. rows, valid: the row, then those before and behind it along y
 * and z, or NULL. Neighbours come in pairs, so that slopes do not count. */
static void count_row(const work *k, double *const rows[ROWS], double *const valid[ROWS])
{
    const size_t nx = k->in->dim[0];
    for (size_t i = 0; i < nx; i++) {
        double sum = 0;
        int count = 0;
        bool is_flat = true;
        if (k->has_gaps && !(valid[0][i] > 0))
            continue;
        const double x = rows[0][i];
        if (i > 0 && i + 1 < nx &&
            (!k->has_gaps || (valid[0][i - 1] > 0 && valid[0][i + 1] > 0))) {
            add_second(rows[0][i - 1], x, rows[0][i + 1], &sum, &count);
            is_flat = rows[0][i - 1] == x && rows[0][i + 1] == x;
        }
        for (int n = 1; n < ROWS; n += 2)
            if (rows[n] && rows[n + 1] &&
                (!k->has_gaps || (valid[n][i] > 0 && valid[n + 1][i] > 0))) {
                add_second(rows[n][i], x, rows[n + 1][i], &sum, &count);
                is_flat = is_flat && rows[n][i] == x && rows[n + 1][i] == x;
            }
        if (count == 0 || is_flat)
            continue;
        /* The variance of m x - sum of m neighbours is (m^2 + m) sigma^2. */
        const double scale = sqrt((double)count * (double)count + (double)count);
        const size_t bin = find_bin(fabs(sum) / scale);
        __atomic_fetch_add(&k->counts[bin], 1, __ATOMIC_RELAXED);
    }
}

static void count_slice(void *context, size_t z)
{
    work *k = context;
    const size_t *dim = k->in->dim, nx = dim[0];
    double *memory = cwi_alloc_array(2 * ROWS * nx, sizeof *memory);
    if (!memory) {
        cwi_set_flag(&k->starved);
        return;
    }
    for (size_t j = 0; j < dim[1]; j++) {
        const ptrdiff_t around[ROWS][2] = {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}};
        double *rows[ROWS], *valid[ROWS];
        for (size_t n = 0; n < ROWS; n++) {
            const ptrdiff_t y = (ptrdiff_t)j + around[n][0], s = (ptrdiff_t)z + around[n][1];
            const bool is_there =
                y >= 0 && s >= 0 && y < (ptrdiff_t)dim[1] && s < (ptrdiff_t)dim[2];
            rows[n] = is_there ? memory + n * nx : NULL;
            valid[n] = memory + (ROWS + n) * nx;
            if (is_there)
                cwi_filter_load(k->in, (size_t)y, (size_t)s, rows[n],
                                k->has_gaps ? valid[n] : NULL);
        }
        count_row(k, rows, valid);
    }
    cwi_free(memory);
}

/* Returns the median of what was counted; 0: nothing was. */
static double find_median(const size_t *counts)
{
    size_t all = 0, below = 0, bin = 0;
    for (size_t n = 0; n < BINS; n++)
        all += counts[n];
    if (!all)
        return 0;
    while (below + counts[bin] <= (all - 1) / 2)
        below += counts[bin++];
    return bin_middle(bin);
}

cw_status cw_volume_noise(const cw_volume *volume, int threads, double *sigma, cw_error *err)
{
    /* The median of |x| of a normal distribution is 0.6745 sigma. */
    static const double SIGMA_PER_MEDIAN = 1.4826022185;
    CWI_REQUIRE(err, volume, sigma);
    cw_volume in;
    *sigma = 0;
    cw_status st = cwi_filter_input(volume, "an estimate of noise", &in, err);
    if (st != CW_OK)
        return st;
    work k = {.in = &in, .counts = cwi_alloc_zeroed(BINS, sizeof *k.counts)};
    if (!k.counts)
        return cwi_fail_memory(err);
    k.has_gaps = cwi_filter_has_gaps(&in, threads);
    st = cwi_parallel_for(in.dim[2], 8 * in.dim[0] * in.dim[1], threads, &(cw_progress){0},
                          "estimating noise", count_slice, &k, err);
    if (st == CW_OK && k.starved)
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        *sigma = SIGMA_PER_MEDIAN * find_median(k.counts) * fabs(in.slope);
    cwi_free(k.counts);
    return st;
}
