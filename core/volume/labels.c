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
/* Scans have more values than FEW, and a smaller fraction of equal pairs than SCATTERED_FRACTION. */
static const double SCATTERED_FRACTION = 0.5;
enum { FEW = 32 };

/* Whole numbers from LOW to HIGH are tallied in a table; all others are listed and sorted. */
enum { LOW = INT16_MIN, HIGH = UINT16_MAX, SMALL_VALUES = HIGH - LOW + 1 };

/* PIECE: voxels of a row that are converted at a time. MAX_LISTED: runs of the last list. */
enum { PIECE = 256, MAX_LISTED = 4096 };

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
    bool is_last;   /* it is decided, and the values of all voxels are listed */
} census;

static bool is_small(double value)
{
    return value >= LOW && value <= HIGH && value == (double)(int)value;
}

static tally *tally_of(const census *c, double value)
{
    return c->small + ((int)value - LOW);
}

static int compare_runs(const void *a, const void *b)
{
    const double x = ((const run *)a)->value, y = ((const run *)b)->value;
    return (x > y) - (x < y);
}

/* Joins the runs of each value, in rising order. */
static void join_runs(census *c)
{
    size_t values = 0;
    if (c->listed)
        qsort(c->runs, c->listed, sizeof *c->runs, compare_runs);
    for (size_t n = 0; n < c->listed; n++) {
        if (values > 0 && c->runs[values - 1].value == c->runs[n].value)
            c->runs[values - 1].pairs += c->runs[n].pairs;
        else
            c->runs[values++] = c->runs[n];
    }
    c->listed = values;
}

/* Lists a run; capacities are powers of two. Of the last list only the lowest values are kept:
 * one more than are listed for the caller. */
static void list_run(census *c, double value, size_t pairs)
{
    if (c->is_last && c->listed == MAX_LISTED) {
        join_runs(c);
        c->listed = c->listed > CW_LABELS_MAX ? CW_LABELS_MAX + 1 : c->listed;
    }
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
    c->too_many = !c->is_last && (c->too_many || c->run_count == MAX_CHANGES);
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
    const bool is_real = v->type == CW_F32 || v->type == CW_F64;
    for (size_t n = 0; is_real && n < count; n++)
        piece[n] = cwi_whole_value(piece[n]);
}

/* Whether further rows can matter. */
static bool goes_on(const census *c)
{
    return !c->is_starved && (c->is_last || (!c->too_many && (c->is_whole || c->must_list)));
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

/* Goes through at most MAX_VOXELS voxels, in rows spread evenly; the last time through all. */
static void count_rows(const cw_volume *v, census *c)
{
    const size_t rows = v->dim[1] * v->dim[2], per_row = v->dim[0];
    const size_t max = MAX_VOXELS / per_row ? MAX_VOXELS / per_row : 1;
    const size_t by = c->is_last ? 1 : (rows + max - 1) / max;
    for (size_t row = 0; row < rows && goes_on(c); row += by)
        count_row(v, row % v->dim[1], row / v->dim[1], c);
}

/* Joins the runs of each value, in rising order, and ranks the small ones. */
static void rank_values(census *c)
{
    for (int n = LOW; n <= HIGH && !c->is_starved; n++)
        if (tally_of(c, n)->runs)
            list_run(c, n, tally_of(c, n)->pairs);
    if (c->is_starved || c->listed == 0)
        return;
    join_runs(c);
    for (size_t n = 0; n < c->listed; n++)
        if (is_small(c->runs[n].value))
            tally_of(c, c->runs[n].value)->runs = (uint32_t)n;
    c->is_ranked = true;
}

/* Returns the number of equal pairs. The value that most of them have is the background, and does
 * not count. */
static size_t count_equal(const census *c)
{
    size_t equal = 0, largest = 0;
    for (size_t n = 0; n < c->listed; n++) {
        equal += c->runs[n].pairs;
        largest = c->runs[n].pairs > largest ? c->runs[n].pairs : largest;
    }
    return equal - largest;
}

/* Returns true if the values are amounts. Where changes were too many, nothing was listed. */
static bool is_scattered(const census *c)
{
    size_t values = c->listed;
    for (int n = LOW; n <= HIGH && !c->is_ranked; n++)
        values += tally_of(c, n)->runs > 0;
    if (values <= FEW || !c->is_whole)
        return false;
    const double equal = (double)count_equal(c), apart = (double)c->changes;
    return c->too_many || equal < SCATTERED_FRACTION * (equal + apart);
}

/* Returns true if neighbours are as in a label map. */
static bool is_label_map(const cw_volume *v, census *c)
{
    const size_t equal = count_equal(c);
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

/* Lists the values of all voxels in place of those of the rows that were examined. */
static void list_values(const cw_volume *v, census *c)
{
    memset(c->small, 0, SMALL_VALUES * sizeof *c->small);
    c->listed = 0;
    c->is_ranked = false;
    c->is_last = true;
    count_rows(v, c);
    rank_values(c);
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
    const bool scattered = !c.is_starved && !c.must_list && is_scattered(&c);
    const bool found = !c.is_starved && (c.must_list || is_found(&v, &c));
    if (found)
        list_values(&v, &c);
    if (c.is_starved)
        st = cwi_fail_memory(err);
    out->scattered = st == CW_OK && scattered;
    if (st == CW_OK && found)
        *out = (cw_labels){.found = true,
                           .more = c.listed > CW_LABELS_MAX,
                           .count = c.listed < CW_LABELS_MAX ? c.listed : CW_LABELS_MAX};
    for (size_t n = 0; n < out->count; n++)
        out->value[n] = cwi_whole_value(v.slope * c.runs[n].value + v.intercept);
    cwi_free(c.small);
    cwi_free(c.runs);
    return st;
}
