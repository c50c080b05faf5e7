/* Splits a transfer function into linear pieces, and cuts cubics where these pieces begin and
 * end. */
#include "viewer/scene/transfer_segments.h"

#include "core/geometry/cubic.h"

#include <math.h>
#include <stdlib.h>

static int in_order(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Adds the breakpoint between two opacities at which the maximum opacity is reached, beyond
 * which extinction is constant. */
static void add_limit(const cw_opacity_point *p, cwi_knots *k)
{
    const double a = (double)p[0].opacity - CWI_MAX_OPACITY,
                 b = (double)p[1].opacity - CWI_MAX_OPACITY;
    if (a * b < 0)
        k->at[k->count++] = p[0].value + a / (a - b) * (p[1].value - p[0].value);
}

static void find_knots(const cw_transfer *t, cwi_knots *k)
{
    k->count = 0;
    for (size_t n = 0; n < t->color_count; n++)
        k->at[k->count++] = t->colors[n].value;
    for (size_t n = 0; n < t->opacity_count; n++)
        k->at[k->count++] = t->opacities[n].value;
    for (size_t n = 0; n + 1 < t->opacity_count; n++)
        add_limit(&t->opacities[n], k);
    qsort(k->at, k->count, sizeof *k->at, in_order);
    size_t kept = 0;
    for (size_t n = 0; n < k->count; n++)
        if (kept == 0 || k->at[n] > k->at[kept - 1])
            k->at[kept++] = k->at[n];
    k->count = kept;
}

/* Fits a line through two values inside the piece, so that jumps at its ends do not matter. */
static void fit_line(const cw_transfer *t, cwi_linear *l)
{
    double a = l->low + (l->high - l->low) / 4, b = l->low + (l->high - l->low) * 3 / 4;
    double color[2][3], opacity[2];
    if (!isfinite(a) || !isfinite(b))
        a = b = isfinite(l->high) ? l->high - fabs(l->high) - 1 : l->low;
    cw_transfer_at(t, a, color[0], &opacity[0]);
    cw_transfer_at(t, b, color[1], &opacity[1]);
    const double width = b - a;
    l->origin = a;
    l->opacity = opacity[0];
    l->opacity_slope = width > 0 ? (opacity[1] - opacity[0]) / width : 0;
    for (int c = 0; c < 3; c++) {
        l->color[c] = color[0][c];
        l->color_slope[c] = width > 0 ? (color[1][c] - color[0][c]) / width : 0;
    }
    l->is_visible = opacity[0] > 0 || opacity[1] > 0;
}

void cwi_knots_make(const cw_transfer *t, cwi_knots *k)
{
    find_knots(t, k);
    for (size_t n = 0; n <= k->count; n++) {
        k->linear[n].low = n > 0 ? k->at[n - 1] : -INFINITY;
        k->linear[n].high = n < k->count ? k->at[n] : INFINITY;
        if (k->count == 0)
            k->linear[n].low = 0;
        fit_line(t, &k->linear[n]);
        if (k->count == 0)
            k->linear[n].low = -INFINITY;
    }
}

size_t cwi_knots_below(const cwi_knots *k, double value)
{
    size_t low = 0, high = k->count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (k->at[middle] <= value)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

bool cwi_knots_is_visible(const cwi_knots *k, double low, double high)
{
    const size_t last = cwi_knots_below(k, high);
    for (size_t n = cwi_knots_below(k, low); n <= last; n++)
        if (k->linear[n].is_visible)
            return true;
    return false;
}

/* Cuts a part in which the cubic does not turn: up, or down, from breakpoint to breakpoint. A
 * jump belongs to the side above, so a cubic that falls from a breakpoint is below it. */
static size_t cut_part(const cwi_knots *k, const double c[4], double from, double to,
                       cwi_transfer_segment *pieces)
{
    const double first = cwi_cubic_at(c, from), last = cwi_cubic_at(c, to);
    const bool falls = last < first;
    size_t count = 0, n = cwi_knots_below(k, first);
    while (falls && n > 0 && k->at[n - 1] >= first)
        n--;
    for (;;) {
        const bool meets =
            falls ? n > 0 && k->at[n - 1] > last : n < k->count && k->at[n] < last;
        const double x = meets ? cwi_cubic_meets(c, from, to, k->at[falls ? n - 1 : n]) : to;
        if (x > from)
            pieces[count++] = (cwi_transfer_segment){from, x, &k->linear[n]};
        if (!meets)
            return count;
        from = x;
        n = falls ? n - 1 : n + 1;
    }
}

size_t cwi_knots_cut(const cwi_knots *k, const double c[4], cwi_transfer_segment *pieces)
{
    double turns[2], from = 0;
    const int turn_count = cwi_cubic_turns(c, turns);
    size_t count = 0;
    for (int n = 0; n <= turn_count; n++) {
        const double to = n < turn_count ? turns[n] : 1;
        count += cut_part(k, c, from, to, pieces + count);
        from = to;
    }
    return count;
}
