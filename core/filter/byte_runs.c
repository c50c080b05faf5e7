/* Finds runs of voxels along x, and joins those that touch. */
#include "core/filter/byte_runs.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"

#include <string.h>

/* Goes through the runs of a row; stores them unless `to` is NULL. Returns how many there are. */
static size_t scan_row(const uint8_t *row, uint8_t value, size_t count, cwi_byte_run *to)
{
    size_t runs = 0;
    for (size_t i = 0; i < count;) {
        size_t end = i;
        while (end < count && row[end] == value)
            end++;
        if (end > i && to)
            to[runs] = (cwi_byte_run){(uint32_t)i, (uint32_t)end};
        runs += end > i;
        i = end + 1;
    }
    return runs;
}

/* Joins the runs of two rows that overlap. */
static void join_rows(cwi_byte_runs *r, size_t a, size_t b)
{
    size_t m = r->rows[a], n = r->rows[b];
    while (m < r->rows[a + 1] && n < r->rows[b + 1]) {
        const cwi_byte_run *x = r->runs + m, *y = r->runs + n;
        if (x->first < y->end && y->first < x->end)
            cwi_sets_join(r->component, (uint32_t)m, (uint32_t)n);
        if (x->end < y->end)
            m++;
        else
            n++;
    }
}

cw_status cwi_byte_runs_init(const uint8_t *bytes, uint8_t value, const size_t dim[3],
                             cwi_byte_runs *out, cw_error *err)
{
    const size_t rows = dim[1] * dim[2], nx = dim[0];
    *out = (cwi_byte_runs){.dim = {dim[0], dim[1], dim[2]}};
    out->rows = cwi_alloc_array(rows + 1, sizeof *out->rows);
    if (out->rows) {
        for (size_t row = 0; row < rows; row++) {
            out->rows[row] = out->count;
            out->count += scan_row(bytes + row * nx, value, nx, NULL);
        }
        out->rows[rows] = out->count;
        if (out->count >= UINT32_MAX || nx >= UINT32_MAX) {
            cwi_byte_runs_free(out);
            return cwi_fail(err, CW_ERR_LIMIT,
                            "components have more than 2^32 - 1 runs of voxels");
        }
        out->runs = cwi_alloc_array(out->count, sizeof *out->runs);
        out->component = cwi_sets_alloc(out->count);
    }
    if (!out->runs || !out->component) {
        cwi_byte_runs_free(out);
        return cwi_fail_memory(err);
    }
    for (size_t row = 0; row < rows; row++) {
        scan_row(bytes + row * nx, value, nx, out->runs + out->rows[row]);
        if (row % dim[1] > 0)
            join_rows(out, row - 1, row);
        if (row >= dim[1])
            join_rows(out, row - dim[1], row);
    }
    for (uint32_t n = 0; n < out->count; n++)
        out->component[n] = cwi_sets_find(out->component, n);
    return CW_OK;
}

void cwi_byte_runs_free(cwi_byte_runs *runs)
{
    cwi_free(runs->rows);
    cwi_free(runs->runs);
    cwi_free(runs->component);
    *runs = (cwi_byte_runs){0};
}

void cwi_byte_runs_measure(const cwi_byte_runs *r, size_t *voxels)
{
    memset(voxels, 0, r->count * sizeof *voxels);
    for (size_t n = 0; n < r->count; n++)
        voxels[r->component[n]] += r->runs[n].end - r->runs[n].first;
}
