/* Detects label maps: volumes whose whole numbers stand for objects. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A label map has fewer changes along its rows than MAX_CHANGES: see EQUAL_FRACTION. */
enum { MAX_VOXELS = 1 << 22, MAX_CHANGES = 3 * (MAX_VOXELS / 10), FEWEST_LABELS = 3 };
/* Limits of detection. Equal pairs are at least 0.8 in label maps, and at most 0.25 in scans
 * and photographs. */
static const double EQUAL_FRACTION = 0.7, SKIPPING_FRACTION = 0.2;

/* Whole numbers from LOW to HIGH are tallied in a table; all others are listed and sorted. */
enum { LOW = INT16_MIN, HIGH = UINT16_MAX, SMALL_VALUES = HIGH - LOW + 1 };

/* Voxels of a row that are converted at a time. */
enum { PIECE = 256 };

/* Neighbours along x that are equal, one of each pair. */
typedef struct run {
    double value;
    size_t pairs;
} run;

/* Counts of a small whole number in the rows. */
typedef struct tally {
    uint32_t pairs;
    uint32_t runs; /* later its rank among the values */
} tally;

/* Runs of equal values in the rows that are examined, and the changes between them. */
typedef struct census {
    tally *small; /* SMALL_VALUES */
    run *runs;    /* of other values; later one of each value, rising */
    size_t run_count, listed;
    size_t changes;  /* between neighbours along x */
    size_t skipping; /* of them, those between values that are no neighbours in rank */
    bool is_ranked;  /* the values have ranks: changes are compared, and no run is added */
    bool too_many;   /* changes, for a label map */
    bool is_starved;
    bool is_whole;  /* all values are whole numbers */
    bool must_list; /* values are needed even when some are not whole numbers */
} census;

static bool is_small(double value)
{
    return value >= LOW && value <= HIGH && value == (double)(int)value;
}

static tally *tally_of(const census *c, double value)
{
    return c->small + ((int)value - LOW);
}

/* Lists a run; capacities are powers of two. */
static void list_run(census *c, double value, size_t pairs)
{
    if (!(c->listed & (c->listed - 1))) {
        run *grown = cwi_realloc_array(c->runs, c->listed ? 2 * c->listed : 1, sizeof *c->runs);
        c->is_starved = c->is_starved || !grown;
        c->runs = grown ? grown : c->runs;
    }
    if (!c->is_starved)
        c->runs[c->listed++] = (run){value, pairs};
}

static void add_run(census *c, double value, size_t pairs)
{
    if (c->is_ranked)
        return;
    c->too_many = c->too_many || c->run_count == MAX_CHANGES;
    if (c->too_many)
        return;
    c->run_count++;
    if (is_small(value)) {
        tally *t = tally_of(c, value);
        t->pairs += (uint32_t)pairs;
        t->runs++;
        return;
    }
    c->is_whole = c->is_whole && value == floor(value);
    list_run(c, value, pairs);
}

static int compare_runs(const void *a, const void *b)
{
    const double x = ((const run *)a)->value, y = ((const run *)b)->value;
    return (x > y) - (x < y);
}

static size_t rank_of(const census *c, double value)
{
    if (is_small(value))
        return tally_of(c, value)->runs;
    const run key = {.value = value};
    const run *at = bsearch(&key, c->runs, c->listed, sizeof *c->runs, compare_runs);
    return (size_t)(at - c->runs);
}

static void add_change(census *c, double from, double to)
{
    if (!c->is_ranked) {
        c->changes++;
        return;
    }
    const size_t a = rank_of(c, from), b = rank_of(c, to);
    c->skipping += a + 1 < b || b + 1 < a;
}

/* Converts `count` voxels of a row from `i` on. */
static void load_piece(const cw_volume *v, size_t i, size_t j, size_t k, size_t count,
                       double *piece)
{
    const char *p = cwi_voxel_address(v, i, j, k);
    switch (v->type) {
#define CASE(name, ctype, text)                                                                \
    case name:                                                                                 \
        for (size_t n = 0; n < count; n++)                                                     \
            piece[n] = (double)*(const ctype *)(p + (ptrdiff_t)n * v->stride[0]);              \
        break;
        CW_TYPE_TABLE(CASE)
#undef CASE
    default:
        memset(piece, 0, count * sizeof *piece);
    }
}

/* Whether further rows can matter. */
static bool goes_on(const census *c)
{
    return !c->too_many && !c->is_starved && (c->is_whole || c->must_list);
}

/* Adds a row. Voxels without a value end a run, and are in no pair. */
static void count_row(const cw_volume *v, size_t j, size_t k, census *c)
{
    double piece[PIECE], last = NAN;
    size_t pairs = 0;
    for (size_t i = 0; i < v->dim[0] && goes_on(c); i++) {
        const size_t left = v->dim[0] - i;
        if (i % PIECE == 0)
            load_piece(v, i, j, k, left < PIECE ? left : PIECE, piece);
        const double value = piece[i % PIECE];
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

/* Goes through at most MAX_VOXELS voxels, in rows spread evenly. */
static void count_rows(const cw_volume *v, census *c)
{
    const size_t rows = v->dim[1] * v->dim[2], per_row = v->dim[0];
    const size_t max = MAX_VOXELS / per_row ? MAX_VOXELS / per_row : 1;
    const size_t by = (rows + max - 1) / max;
    for (size_t row = 0; row < rows && goes_on(c); row += by)
        count_row(v, row % v->dim[1], row / v->dim[1], c);
}

/* Joins the runs of each value, in rising order, and ranks the small ones. */
static void rank_values(census *c)
{
    size_t values = 0;
    for (int n = LOW; n <= HIGH && !c->is_starved; n++)
        if (tally_of(c, n)->runs)
            list_run(c, n, tally_of(c, n)->pairs);
    if (c->is_starved || c->listed == 0)
        return;
    qsort(c->runs, c->listed, sizeof *c->runs, compare_runs);
    for (size_t n = 0; n < c->listed; n++) {
        if (values > 0 && c->runs[values - 1].value == c->runs[n].value)
            c->runs[values - 1].pairs += c->runs[n].pairs;
        else
            c->runs[values++] = c->runs[n];
    }
    c->listed = values;
    for (size_t n = 0; n < values; n++)
        if (is_small(c->runs[n].value))
            tally_of(c, c->runs[n].value)->runs = (uint32_t)n;
    c->is_ranked = true;
}

/* Returns true if neighbours are as in a label map. The value that most equal pairs have is the
 * background, and does not count. */
static bool is_label_map(const cw_volume *v, census *c)
{
    size_t equal = 0, largest = 0;
    for (size_t n = 0; n < c->listed; n++) {
        equal += c->runs[n].pairs;
        largest = c->runs[n].pairs > largest ? c->runs[n].pairs : largest;
    }
    equal -= largest;
    const double apart = (double)c->changes;
    if (equal == 0 || (double)equal < EQUAL_FRACTION * ((double)equal + apart))
        return false;
    count_rows(v, c);
    return (double)c->skipping >= SKIPPING_FRACTION * apart;
}

/* Whether the values that were counted are those of a label map. */
static bool is_found(const cw_volume *v, census *c)
{
    return !c->too_many && c->is_whole && c->listed >= FEWEST_LABELS &&
           v->slope * c->runs[0].value + v->intercept >= 0 && is_label_map(v, c);
}

cw_status cw_volume_labels(const cw_volume *volume, cw_labels *out, cw_error *err)
{
    CWI_REQUIRE(err, volume, out);
    cw_volume v;
    cw_status st = cw_volume_resolve(volume, &v, err);
    *out = (cw_labels){0};
    if (st != CW_OK || v.sparse || v.cells)
        return st;
    census c = {.is_whole = true, .must_list = v.known & CW_KNOWN_LABELS};
    c.small = cwi_alloc_zeroed(SMALL_VALUES, sizeof *c.small);
    c.is_starved = !c.small;
    count_rows(&v, &c);
    if (c.must_list || (c.is_whole && !c.too_many))
        rank_values(&c);
    if (c.is_starved)
        st = cwi_fail_memory(err);
    if (st == CW_OK) {
        out->found = c.must_list || is_found(&v, &c);
        out->more = out->found && (c.too_many || c.listed > CW_LABELS_MAX);
        out->count = !out->found ? 0 : c.listed < CW_LABELS_MAX ? c.listed : CW_LABELS_MAX;
    }
    for (size_t n = 0; n < out->count; n++)
        out->value[n] = v.slope * c.runs[n].value + v.intercept;
    cwi_free(c.small);
    cwi_free(c.runs);
    return st;
}
