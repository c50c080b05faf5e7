/* Samples a transfer function into a table, and integrates it over segments [Engel2001]. */
#include "viewer/scene/transfer_table.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"

#include <math.h>

/* Steps of the running integrals between rows of a pre-integrated table. */
enum { FINE = 8 };
static const double PIECES_PER_DEPTH = 40, MAX_PIECES = 32;

static void widen_range(double value, double range[2])
{
    range[0] = fmin(range[0], value);
    range[1] = fmax(range[1], value);
}

/* Finds the range from the first point to the last. */
static void find_range(const cw_transfer *t, double range[2])
{
    range[0] = INFINITY;
    range[1] = -INFINITY;
    if (t->color_count > 0) {
        widen_range(t->colors[0].value, range);
        widen_range(t->colors[t->color_count - 1].value, range);
    }
    if (t->opacity_count > 0) {
        widen_range(t->opacities[0].value, range);
        widen_range(t->opacities[t->opacity_count - 1].value, range);
    }
    if (!(range[0] <= range[1]))
        range[0] = range[1] = 0;
    if (range[0] == range[1]) { /* a jump, or constant */
        const double around = fmax(fabs(range[0]), 1) * 1e-6;
        range[0] -= around;
        range[1] += around;
    }
}

cw_status cwi_table_make(const cwi_frame *frame, cwi_table *table, cw_error *err)
{
    double range[2], color[3], opacity;
    find_range(&frame->transfer, range);
    *table = (cwi_table){.low = range[0], .high = range[1], .count = CWI_TABLE_ROWS};
    table->rows = cwi_alloc_array(table->count, 4 * sizeof *table->rows);
    table->visible = cwi_alloc_array(table->count, sizeof *table->visible);
    if (!table->rows || !table->visible) {
        cwi_table_free(table);
        return cwi_fail_memory(err);
    }
    for (size_t n = 0; n < table->count; n++) {
        float *row = table->rows + 4 * n;
        const double fraction = (double)n / (double)(table->count - 1);
        cw_transfer_at(&frame->transfer, range[0] + fraction * (range[1] - range[0]), color,
                       &opacity);
        for (int c = 0; c < 3; c++)
            row[c] = (float)color[c];
        row[3] = (float)cwi_frame_extinction(frame, opacity);
    }
    size_t next = table->count;
    for (size_t n = table->count; n-- > 0; table->visible[n] = (uint16_t)next)
        next = table->rows[4 * n + 3] > 0 ? n : next;
    return CW_OK;
}

void cwi_table_free(cwi_table *table)
{
    cwi_free(table->rows);
    cwi_free(table->visible);
    *table = (cwi_table){0};
}

/* Returns the row of a value, not rounded. */
static double row_of(const cwi_table *table, double value)
{
    const double fraction = (value - table->low) / (table->high - table->low);
    return fmin(fmax(fraction, 0), 1) * (double)(table->count - 1);
}

bool cwi_table_is_visible(const cwi_table *table, double low, double high)
{
    const size_t first = (size_t)floor(row_of(table, low)),
                 last = (size_t)ceil(row_of(table, high));
    return table->visible[first] <= last;
}

bool cwi_table_is_narrow(const cwi_table *t)
{
    enum { WIDTH = CWI_TABLE_ROWS / 8, REACH = WIDTH / 2 };
    static const double MAX_CHANGE = 0.1;
    double change = 0, total = 0;
    for (int c = 0; c < 4; c++) {
        double window = 0;
#define GLOW(n)                                                                                \
    ((double)t->rows[4 * (n) + 3] * (c < 3 ? (double)t->rows[4 * (n) + (size_t)c] : 1))
        for (size_t n = 0; n < WIDTH; n++)
            window += GLOW(n);
        for (size_t n = REACH; n + REACH < t->count; n++) {
            change += fabs(window / WIDTH - GLOW(n));
            total += GLOW(n);
            window += GLOW(n + REACH) - GLOW(n - REACH);
        }
#undef GLOW
    }
    return change > MAX_CHANGE * total;
}

/* Returns the shortest distance between two points that differ, at most `max`. */
static double find_narrowest(const void *points, size_t row, size_t count, double max)
{
    for (size_t n = 1; n < count; n++) {
        const double a = *(const double *)((const char *)points + (n - 1) * row);
        const double b = *(const double *)((const char *)points + n * row);
        if (b > a && b - a < max)
            max = b - a;
    }
    return max;
}

size_t cwi_table_segment_rows(const cwi_table *table, const cw_transfer *t)
{
    const double range = table->high - table->low;
    double gap = find_narrowest(t->opacities, sizeof *t->opacities, t->opacity_count, range);
    gap = find_narrowest(t->colors, sizeof *t->colors, t->color_count, gap);
    size_t rows = 256;
    while (rows < 1024 && (double)rows * gap < 64 * range)
        rows *= 2;
    return rows;
}

/* Computes running integrals over the table's rows, for `count` rows of the result: of the
 * extinction, and of the colours times it. */
static double (*running_integrals(const cwi_table *t, size_t count))[4]
{
    double(*sum)[4] = cwi_alloc_zeroed(count * FINE, sizeof *sum);
    const double fine = (double)((count - 1) * FINE);
    double before[4] = {0};
    for (size_t n = 0; sum && n <= (count - 1) * FINE; n++) {
        const double at = (double)n / fine * (double)(t->count - 1);
        const size_t i = (size_t)fmin(floor(at), (double)t->count - 2);
        const double fraction = at - (double)i;
        double now[4];
        for (int c = 0; c < 4; c++)
            now[c] = (1 - fraction) * (double)t->rows[4 * i + (size_t)c] +
                     fraction * (double)t->rows[4 * i + 4 + (size_t)c];
        for (int c = 0; c < 3; c++)
            now[c] *= now[3];
        for (int c = 0; c < 4 && n > 0; c++)
            sum[n][c] = sum[n - 1][c] + (before[c] + now[c]) / 2;
        for (int c = 0; c < 4; c++)
            before[c] = now[c];
    }
    return sum;
}

/* Returns the number of pieces. Within a piece all of it glows alike: the error grows with its
 * depth, so deep ones are cut. */
static size_t piece_count(double depth, size_t span)
{
    const double requested = fmin(ceil(PIECES_PER_DEPTH * depth), MAX_PIECES);
    return requested < 1 ? 1 : requested < (double)span ? (size_t)requested : span;
}

/* Returns the fraction of a piece's glow that leaves it: (1 - exp(-depth)) / depth. The series
 * is exact to 1e-12 where it ends; most pieces are shorter, and exp() takes three times as
 * long. */
static double find_escape(double depth)
{
    static const double SERIES_END = 0.03; /* optical depth below which a series is exact */
    if (depth > SERIES_END)
        return -expm1(-depth) / depth;
    return 1 -
           depth / 2 * (1 - depth / 3 * (1 - depth / 4 * (1 - depth / 5 * (1 - depth / 6))));
}

/* Integrates from row x to row y, which differ: pieces from front to back. scale: length per
 * step of the running integrals. */
static void integrate_segment(const double (*sum)[4], size_t x, size_t y, double scale,
                              float out[4])
{
    const size_t span = (x < y ? y - x : x - y) * FINE;
    const double all = scale * fabs(sum[y * FINE][3] - sum[x * FINE][3]);
    const size_t pieces = piece_count(all, span);
    double light = 1, color[3] = {0};
    size_t from = x * FINE;
    for (size_t p = 1; p <= pieces && all > 0 && light > 1e-9; p++) {
        const size_t offset = span * p / pieces;
        const size_t to = x < y ? x * FINE + offset : x * FINE - offset;
        const double depth = scale * fabs(sum[to][3] - sum[from][3]);
        const double escape = find_escape(depth), through = 1 - depth * escape;
        for (int c = 0; c < 3; c++)
            color[c] += light * scale * escape * fabs(sum[to][c] - sum[from][c]);
        light *= through;
        from = to;
    }
    for (int c = 0; c < 3; c++)
        out[c] = (float)color[c];
    out[3] = (float)(1 - light);
}

/* Integrates a segment of one value. */
static void integrate_flat(const cwi_table *t, double at, double length, float out[4])
{
    const size_t i = (size_t)fmin(floor(at), (double)t->count - 2);
    const double fraction = at - (double)i;
    double row[4];
    for (int c = 0; c < 4; c++)
        row[c] = (1 - fraction) * (double)t->rows[4 * i + (size_t)c] +
                 fraction * (double)t->rows[4 * i + 4 + (size_t)c];
    const double opacity = -expm1(-row[3] * length);
    for (int c = 0; c < 3; c++)
        out[c] = (float)(row[c] * opacity);
    out[3] = (float)opacity;
}

typedef struct integration {
    const cwi_table *table;
    double length;
    size_t count;
    const double (*sum)[4];
    float *out;
} integration;

static void integrate_row(void *context, size_t y)
{
    const integration *w = context;
    for (size_t x = 0; x < w->count; x++) {
        float *to = w->out + 4 * (y * w->count + x);
        const double span = fabs((double)x - (double)y) * FINE;
        const double at = (double)x / (double)(w->count - 1) * (double)(w->table->count - 1);
        if (x == y)
            integrate_flat(w->table, at, w->length, to);
        else
            integrate_segment(w->sum, x, y, w->length / span, to);
    }
}

cw_status cwi_table_preintegrate(const cwi_table *table, double length, size_t count,
                                 int threads, const cw_progress *progress, float *out,
                                 cw_error *err)
{
    double(*sum)[4] = running_integrals(table, count);
    if (!sum)
        return cwi_fail_memory(err);
    enum { WORK = 64 }; /* one entry takes as long as this number of samples elsewhere */
    integration work = {table, length, count, (const double(*)[4])sum, out};
    cw_status st = cwi_parallel_for(count, WORK * count, threads, progress, "integrating",
                                    integrate_row, &work, err);
    cwi_free(sum);
    return st;
}
