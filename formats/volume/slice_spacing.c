/* Lays slices out at equal distances: keeps even ones, and interpolates where some are missing
 * or distances vary. */
#include "formats/volume/slice_spacing.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The tolerance of an even step: a twentieth. Positions in headers are rounded to a tenth or a
 * hundredth of a millimetre. */
static const double TOLERANCE = 0.05;
enum { FINEST = 8, MAX_SLICES = 65536 };

void cwi_slices_free(cwi_slices *slices)
{
    cwi_free(slices->items);
    *slices = (cwi_slices){0};
}

static int compare_places(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Returns the distances between neighbours, ascending; NULL without memory. */
static double *measure_distances(const double *positions, size_t count)
{
    double *d = cwi_alloc_array(count, sizeof *d);
    for (size_t i = 0; d && i + 1 < count; i++)
        d[i] = positions[i + 1] - positions[i];
    if (d)
        qsort(d, count - 1, sizeof *d, compare_places);
    return d;
}

/* Returns true if all positions are on an even row of `steps` steps, no two at one. */
static bool on_row(const double *positions, size_t count, double steps)
{
    const double step = (positions[count - 1] - positions[0]) / steps;
    double before = 0;
    for (size_t i = 1; i < count; i++) {
        const double at = (positions[i] - positions[0]) / step, nearest = nearbyint(at);
        if (fabs(at - nearest) > TOLERANCE || nearest <= before)
            return false;
        before = nearest;
    }
    return true;
}

/* Finds the first position whose distance to the next is more than a step and a half. */
static size_t first_gap(const double *positions, size_t count, double step)
{
    size_t i = 0;
    while (i + 2 < count && positions[i + 1] - positions[i] < 1.5 * step)
        i++;
    return i;
}

/* Computes one slice of an even row of count from the first position to the last. */
static cwi_slice slice_at(const double *positions, size_t count, size_t *low, double at,
                          double step)
{
    while (*low + 2 < count && positions[*low + 1] <= at)
        (*low)++;
    const double gap = positions[*low + 1] - positions[*low];
    const double t = (at - positions[*low]) / gap;
    if (t * gap <= TOLERANCE * step)
        return (cwi_slice){*low, *low, 0};
    if ((1 - t) * gap <= TOLERANCE * step)
        return (cwi_slice){*low + 1, *low + 1, 0};
    return (cwi_slice){*low, *low + 1, t};
}

static cw_status lay_row(const double *positions, size_t count, double steps, cwi_slices *s,
                         cw_error *err)
{
    if (steps >= MAX_SLICES)
        return cwi_fail(err, CW_ERR_LIMIT, "%s: %.6g slices would be needed; the most are %d",
                        s->finding, steps + 1, MAX_SLICES);
    s->count = (size_t)steps + 1;
    s->step = (positions[count - 1] - positions[0]) / steps;
    s->items = cwi_alloc_array(s->count, sizeof *s->items);
    if (!s->items)
        return cwi_fail_memory(err);
    for (size_t k = 0, low = 0; k < s->count; k++) {
        s->items[k] =
            slice_at(positions, count, &low, positions[0] + (double)k * s->step, s->step);
        s->made += s->items[k].t > 0;
    }
    return CW_OK;
}

/* Lays the given slices out one step apart. */
static cw_status lay_as_even(const double *positions, size_t count, cwi_slices *s,
                             cw_error *err)
{
    s->count = count;
    s->step = count > 1 ? (positions[count - 1] - positions[0]) / (double)(count - 1) : 0;
    s->items = cwi_alloc_array(count, sizeof *s->items);
    if (!s->items)
        return cwi_fail_memory(err);
    for (size_t k = 0; k < count; k++)
        s->items[k] = (cwi_slice){k, k, 0};
    return CW_OK;
}

/* Finds the number of steps of the row with missing slices, or of a row that is fine enough. */
static double find_row(const double *positions, size_t count, const double *gaps,
                       const char *unit, cwi_slices *s)
{
    const double span = positions[count - 1] - positions[0], usual = gaps[(count - 2) / 2];
    const double steps = nearbyint(span / usual), missing = steps - (double)(count - 1);
    if (missing >= 1 && on_row(positions, count, steps)) {
        const size_t i = first_gap(positions, count, span / steps);
        snprintf(s->finding, sizeof s->finding,
                 "%.0f slice%s %s missing; the first gap is from %.6g to %.6g %s, where others "
                 "are %.6g apart",
                 missing, missing > 1 ? "s" : "", missing > 1 ? "are" : "is", positions[i],
                 positions[i + 1], unit, span / steps);
        return steps;
    }
    snprintf(s->finding, sizeof s->finding,
             "the distances between slices vary from %.6g to %.6g %s", gaps[0], gaps[count - 2],
             unit);
    return ceil(span / fmax(gaps[0], usual / FINEST) - TOLERANCE);
}

cw_status cwi_slices_lay(const double *positions, size_t count, const char *unit, cw_gaps gaps,
                         cwi_slices *slices, cw_error *err)
{
    *slices = (cwi_slices){0};
    if (count < 3 || on_row(positions, count, (double)(count - 1)))
        return lay_as_even(positions, count, slices, err);
    double *sorted = measure_distances(positions, count);
    if (!sorted)
        return cwi_fail_memory(err);
    const double steps = find_row(positions, count, sorted, unit, slices);
    cwi_free(sorted);
    if (gaps == CW_GAPS_STOP)
        return cwi_fail(err, CW_ERR_UNSAFE,
                        "%s; desc->gaps = CW_GAPS_INTERPOLATE makes slices at equal distances, "
                        "desc->gaps = CW_GAPS_ALLOW takes these as if they were",
                        slices->finding);
    return gaps == CW_GAPS_ALLOW ? lay_as_even(positions, count, slices, err)
                                 : lay_row(positions, count, steps, slices, err);
}
