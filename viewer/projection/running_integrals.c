/* Sums up a transfer function's table, row by row, and takes means between values. */
#include "viewer/projection/running_integrals.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>

cw_status cwi_integrals_make(const cwi_frame *frame, cwi_integrals *r, cw_error *err)
{
    *r = (cwi_integrals){0};
    cw_status st = cwi_table_make(frame, &r->table, err);
    if (st != CW_OK)
        return st;
    r->sums = cwi_alloc_zeroed(r->table.count, sizeof *r->sums);
    if (!r->sums) {
        cwi_integrals_free(r);
        return cwi_fail_memory(err);
    }
    for (size_t n = 1; n < r->table.count; n++) {
        const float *row = r->table.rows + 4 * (n - 1);
        for (size_t c = 0; c < 4; c++) {
            const double a = (double)row[c] * (c < 3 ? (double)row[3] : 1);
            const double b = (double)row[c + 4] * (c < 3 ? (double)row[7] : 1);
            r->sums[n][c] = r->sums[n - 1][c] + (a + b) / 2;
        }
    }
    return CW_OK;
}

void cwi_integrals_free(cwi_integrals *r)
{
    cwi_table_free(&r->table);
    cwi_free(r->sums);
    *r = (cwi_integrals){0};
}

/* Computes colour times extinction, and extinction, at a row that need not be whole; beyond the
 * ends they are constant. */
static void at_row(const cwi_integrals *r, double row, double out[4])
{
    const double last = (double)r->table.count - 1, at = fmin(fmax(row, 0), last);
    const size_t n = (size_t)fmin(floor(at), last - 1);
    const double fraction = at - (double)n;
    const float *rows = r->table.rows + 4 * n;
    for (size_t c = 0; c < 4; c++) {
        const double a = (double)rows[c] * (c < 3 ? (double)rows[3] : 1);
        const double b = (double)rows[c + 4] * (c < 3 ? (double)rows[7] : 1);
        out[c] = a + fraction * (b - a);
    }
}

/* Computes the integrals up to a row. */
static void up_to_row(const cwi_integrals *r, double row, double out[4])
{
    const double last = (double)r->table.count - 1, at = fmin(fmax(row, 0), last);
    const size_t n = (size_t)fmin(floor(at), last - 1);
    const double fraction = at - (double)n, beyond = row - at;
    double here[4], low[4];
    at_row(r, (double)n, low);
    at_row(r, at, here);
    for (int c = 0; c < 4; c++)
        out[c] = r->sums[n][c] + fraction * (low[c] + here[c]) / 2 + beyond * here[c];
}

void cwi_integrals_mean(const cwi_integrals *r, double from, double to, double mean[4])
{
    static const double SAME_ROWS = 1e-3; /* rows, within which the middle stands for all */
    const double scale = ((double)r->table.count - 1) / (r->table.high - r->table.low);
    const double x = (from - r->table.low) * scale, y = (to - r->table.low) * scale;
    double a[4], b[4];
    if (!(fabs(y - x) > SAME_ROWS)) {
        at_row(r, (x + y) / 2, mean);
        return;
    }
    up_to_row(r, x, a);
    up_to_row(r, y, b);
    for (int c = 0; c < 4; c++)
        mean[c] = fmax((b[c] - a[c]) / (y - x), 0);
}
