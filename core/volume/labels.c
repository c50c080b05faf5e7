/* Detects label maps: volumes whose whole numbers stand for objects. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <string.h>

enum { MAX_VOXELS = 1 << 22, FEWEST_LABELS = 3 };
/* Limits of detection. Equal pairs are at least 0.8 in label maps, and at most 0.25 in scans
 * and photographs. */
static const double EQUAL_SHARE = 0.7, SKIPPING_SHARE = 0.2;

/* Values in rising order, each with the number under which its pairs are counted. */
typedef struct census {
    size_t count;
    bool too_many;
    double value[CW_LABELS_MAX];
    size_t number[CW_LABELS_MAX];
    uint32_t (*pairs)[CW_LABELS_MAX]; /* counts of neighbours, by the numbers of both */
} census;

static size_t find_value(const census *c, double value)
{
    size_t low = 0, high = c->count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (c->value[middle] < value)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static size_t number_of(census *c, double value)
{
    const size_t at = find_value(c, value);
    if (at < c->count && c->value[at] == value)
        return c->number[at];
    if (c->count == CW_LABELS_MAX) {
        c->too_many = true;
        return 0;
    }
    memmove(c->value + at + 1, c->value + at, (c->count - at) * sizeof *c->value);
    memmove(c->number + at + 1, c->number + at, (c->count - at) * sizeof *c->number);
    c->value[at] = value;
    c->number[at] = c->count;
    return c->count++;
}

static void count_row(const cw_volume *v, size_t j, size_t k, census *c)
{
    const char *p = cwi_voxel_address(v, 0, j, k);
    double last_value = 0;
    size_t last = 0;
    bool has_last = false;
    for (size_t i = 0; i < v->dim[0] && !c->too_many; i++, p += v->stride[0]) {
        const double value = cwi_voxel_at(v->type, p);
        if ((v->has_nodata && value == v->nodata) || value != value) {
            has_last = false;
            continue;
        }
        const size_t n = has_last && value == last_value ? last : number_of(c, value);
        if (has_last)
            c->pairs[last][n]++;
        has_last = true;
        last_value = value;
        last = n;
    }
}

static void count_rows(const cw_volume *v, census *c)
{
    const size_t rows = v->dim[1] * v->dim[2], per_row = v->dim[0];
    const size_t most = MAX_VOXELS / per_row ? MAX_VOXELS / per_row : 1;
    const size_t by = (rows + most - 1) / most;
    for (size_t row = 0; row < rows && !c->too_many; row += by)
        count_row(v, row % v->dim[1], row / v->dim[1], c);
}

/* Returns the number of the value that most pairs have on both sides: the background. */
static size_t most_frequent(const census *c)
{
    size_t best = 0;
    for (size_t n = 1; n < c->count; n++)
        if (c->pairs[n][n] > c->pairs[best][best])
            best = n;
    return best;
}

static bool looks_so(const census *c)
{
    const size_t background = most_frequent(c);
    double equal = 0, apart = 0, skipping = 0;
    for (size_t a = 0; a < c->count; a++)
        for (size_t b = 0; b < c->count; b++) {
            const double pairs = c->pairs[c->number[a]][c->number[b]];
            if (a != b)
                apart += pairs;
            else if (c->number[a] != background)
                equal += pairs;
            if (a + 1 < b || b + 1 < a)
                skipping += pairs;
        }
    return equal > 0 && equal >= EQUAL_SHARE * (equal + apart) &&
           skipping >= SKIPPING_SHARE * apart;
}

cw_status cw_volume_labels(const cw_volume *volume, cw_labels *out, cw_error *err)
{
    cw_volume v;
    census c = {0};
    cw_status st = cw_volume_resolve(volume, &v, err);
    *out = (cw_labels){0};
    const bool known = v.known & CW_KNOWN_LABELS;
    if (st != CW_OK || v.sparse || v.cells ||
        ((v.type == CW_F32 || v.type == CW_F64) && !known))
        return st;
    c.pairs = cwi_alloc_zeroed(CW_LABELS_MAX, sizeof *c.pairs);
    if (!c.pairs)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory to count labels");
    count_rows(&v, &c);
    out->found = known || (!c.too_many && c.count >= FEWEST_LABELS && looks_so(&c));
    out->more = known && c.too_many;
    out->count = out->found ? c.count : 0;
    for (size_t n = 0; n < out->count; n++)
        out->value[n] = v.slope * c.value[n] + v.intercept;
    cwi_free(c.pairs);
    return CW_OK;
}
