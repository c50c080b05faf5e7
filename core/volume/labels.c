/* Detects label maps: volumes whose whole numbers stand for objects. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A label map has fewer changes along its rows than MAX_CHANGES: see EQUAL_SHARE. */
enum { MAX_VOXELS = 1 << 22, MAX_CHANGES = 3 * (MAX_VOXELS / 10), FEWEST_LABELS = 3 };
/* Limits of detection. Equal pairs are at least 0.8 in label maps, and at most 0.25 in scans
 * and photographs. */
static const double EQUAL_SHARE = 0.7, SKIPPING_SHARE = 0.2;

/* Neighbours along x that are equal, one of each pair, or that differ. */
typedef struct run {
    double value;
    size_t pairs;
} run;

typedef struct change {
    double from, to;
} change;

/* Runs of equal values in the rows that are examined, and the changes between them. */
typedef struct census {
    run *runs; /* later one of each value, rising */
    change *changes;
    size_t run_count, change_count;
    bool too_many; /* changes, for a label map */
    bool is_starved;
    bool is_whole; /* all values are whole numbers */
} census;

/* Makes room for one more element; capacities are powers of two. */
static void *grow_array(census *c, void *array, size_t count, size_t size)
{
    if (count & (count - 1))
        return array;
    void *grown = cwi_realloc_array(array, count ? 2 * count : 1, size);
    c->is_starved = c->is_starved || !grown;
    return grown ? grown : array;
}

static void add_run(census *c, double value, size_t pairs)
{
    c->is_whole = c->is_whole && value == floor(value);
    c->too_many = c->too_many || c->run_count == MAX_CHANGES;
    c->runs = grow_array(c, c->runs, c->run_count, sizeof *c->runs);
    if (!c->too_many && !c->is_starved)
        c->runs[c->run_count++] = (run){value, pairs};
}

static void add_change(census *c, double from, double to)
{
    c->changes = grow_array(c, c->changes, c->change_count, sizeof *c->changes);
    if (c->change_count < MAX_CHANGES && !c->is_starved)
        c->changes[c->change_count++] = (change){from, to};
}

/* Adds a row. Voxels without a value end a run, and are in no pair. */
static void count_row(const cw_volume *v, size_t j, size_t k, census *c)
{
    const char *p = cwi_voxel_address(v, 0, j, k);
    double last = NAN;
    size_t pairs = 0;
    for (size_t i = 0; i < v->dim[0] && !c->too_many && !c->is_starved;
         i++, p += v->stride[0]) {
        const double value = cwi_voxel_at(v->type, p);
        const bool has_value = value == value && !(v->has_nodata && value == v->nodata);
        if (has_value && value == last) {
            pairs++;
            continue;
        }
        if (last == last)
            add_run(c, last, pairs);
        if (has_value && last == last)
            add_change(c, last, value);
        last = has_value ? value : NAN;
        pairs = 0;
    }
    if (last == last)
        add_run(c, last, pairs);
}

static int compare_runs(const void *a, const void *b)
{
    const double x = ((const run *)a)->value, y = ((const run *)b)->value;
    return (x > y) - (x < y);
}

/* Goes through at most MAX_VOXELS voxels, in rows spread evenly, and joins the runs of each
 * value. */
static void count_rows(const cw_volume *v, census *c)
{
    const size_t rows = v->dim[1] * v->dim[2], per_row = v->dim[0];
    const size_t most = MAX_VOXELS / per_row ? MAX_VOXELS / per_row : 1;
    const size_t by = (rows + most - 1) / most;
    size_t values = 0;
    for (size_t row = 0; row < rows && !c->too_many && !c->is_starved; row += by)
        count_row(v, row % v->dim[1], row / v->dim[1], c);
    if (c->run_count == 0)
        return;
    qsort(c->runs, c->run_count, sizeof *c->runs, compare_runs);
    for (size_t n = 0; n < c->run_count; n++) {
        if (values > 0 && c->runs[values - 1].value == c->runs[n].value)
            c->runs[values - 1].pairs += c->runs[n].pairs;
        else
            c->runs[values++] = c->runs[n];
    }
    c->run_count = values;
}

static size_t rank_of(const census *c, double value)
{
    const run key = {.value = value};
    const run *at = bsearch(&key, c->runs, c->run_count, sizeof *c->runs, compare_runs);
    return (size_t)(at - c->runs);
}

/* Returns true if neighbours are as in a label map. The value that most equal pairs have is the
 * background, and does not count. */
static bool is_label_map(const census *c)
{
    size_t equal = 0, largest = 0, skipping = 0;
    for (size_t n = 0; n < c->run_count; n++) {
        equal += c->runs[n].pairs;
        largest = c->runs[n].pairs > largest ? c->runs[n].pairs : largest;
    }
    equal -= largest;
    for (size_t n = 0; n < c->change_count; n++) {
        const size_t a = rank_of(c, c->changes[n].from), b = rank_of(c, c->changes[n].to);
        skipping += a + 1 < b || b + 1 < a;
    }
    const double apart = (double)c->change_count;
    return equal > 0 && (double)equal >= EQUAL_SHARE * ((double)equal + apart) &&
           (double)skipping >= SKIPPING_SHARE * apart;
}

cw_status cw_volume_labels(const cw_volume *volume, cw_labels *out, cw_error *err)
{
    CWI_REQUIRE(err, volume, out);
    cw_volume v;
    census c = {.is_whole = true};
    cw_status st = cw_volume_resolve(volume, &v, err);
    *out = (cw_labels){0};
    const bool known = v.known & CW_KNOWN_LABELS;
    if (st != CW_OK || v.sparse || v.cells)
        return st;
    count_rows(&v, &c);
    if (c.is_starved)
        st = cwi_fail(err, CW_ERR_NO_MEMORY, "no memory to count labels");
    if (st == CW_OK) {
        out->found =
            known || (!c.too_many && c.is_whole && c.run_count >= FEWEST_LABELS &&
                      v.slope * c.runs[0].value + v.intercept >= 0 && is_label_map(&c));
        out->more = out->found && (c.too_many || c.run_count > CW_LABELS_MAX);
        out->count = !out->found                   ? 0
                     : c.run_count < CW_LABELS_MAX ? c.run_count
                                                   : CW_LABELS_MAX;
    }
    for (size_t n = 0; n < out->count; n++)
        out->value[n] = v.slope * c.runs[n].value + v.intercept;
    cwi_free(c.runs);
    cwi_free(c.changes);
    return st;
}
