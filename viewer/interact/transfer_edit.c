/* Edits a transfer function: finds, moves, inserts and removes points; shifts, scales and
 * mirrors all of them. */
#include "viewer/interact/transfer_edit.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

static double clamp_between(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

/* Returns the distance of two values in tolerances; computed in halves, as differences may be
 * out of the range of doubles. */
static double are_apart(double a, double b, double tolerance)
{
    return (a / 2 - b / 2) / (tolerance / 2);
}

size_t cwi_transfer_near_opacity(const cw_transfer *t, double value, double opacity,
                                 const double tolerance[2])
{
    size_t found = CWI_TRANSFER_NONE;
    double nearest = 1;
    for (size_t n = 0; n < t->opacity_count; n++) {
        const cw_opacity_point *p = &t->opacities[n];
        const double distance = hypot(are_apart(p->value, value, tolerance[0]),
                                      are_apart((double)p->opacity, opacity, tolerance[1]));
        if (distance <= nearest) {
            nearest = distance;
            found = n;
        }
    }
    return found;
}

size_t cwi_transfer_near_color(const cw_transfer *t, double value, double tolerance)
{
    size_t found = CWI_TRANSFER_NONE;
    double nearest = 1;
    for (size_t n = 0; n < t->color_count; n++) {
        const double distance = fabs(are_apart(t->colors[n].value, value, tolerance));
        if (distance <= nearest) {
            nearest = distance;
            found = n;
        }
    }
    return found;
}

/* Returns the distance of the origin from a line's part between two points. */
static double distance_to_line(const double a[2], const double b[2])
{
    const double d[2] = {b[0] - a[0], b[1] - a[1]};
    const double length_sq = d[0] * d[0] + d[1] * d[1];
    const double fraction =
        length_sq > 0 ? clamp_between(-(a[0] * d[0] + a[1] * d[1]) / length_sq, 0, 1) : 0;
    return hypot(a[0] + fraction * d[0], a[1] + fraction * d[1]);
}

size_t cwi_transfer_near_segment(const cw_transfer *t, double value, double opacity,
                                 const double tolerance[2])
{
    static const double FAR = 1e100; /* tolerances: beyond the ends lines are level */
    const cw_opacity_point *p = t->opacities;
    const size_t count = t->opacity_count;
    size_t found = CWI_TRANSFER_NONE;
    double nearest = 1, ends[2][2] = {{-FAR, 0}, {0, 0}};
    for (size_t n = 0; n <= count; n++) {
        const double end = n < count ? (double)p[n].opacity
                           : count   ? (double)p[n - 1].opacity
                                     : 0;
        ends[1][0] = n < count
                         ? clamp_between(are_apart(p[n].value, value, tolerance[0]), -FAR, FAR)
                         : FAR;
        ends[1][1] = are_apart(end, opacity, tolerance[1]);
        if (n == 0)
            ends[0][1] = ends[1][1];
        const double distance = distance_to_line(ends[0], ends[1]);
        if (distance <= nearest) {
            nearest = distance;
            found = n;
        }
        memcpy(ends[0], ends[1], sizeof ends[0]);
    }
    return found;
}

void cwi_transfer_move_opacity(cw_transfer *t, size_t n, double value, double opacity)
{
    cw_opacity_point *p = &t->opacities[n];
    assert(n < t->opacity_count);
    const double low = n > 0 ? p[-1].value : -DBL_MAX;
    const double high = n + 1 < t->opacity_count ? p[1].value : DBL_MAX;
    if (!isfinite(value) || !isfinite(opacity))
        return;
    p->value = clamp_between(value, low, high);
    p->opacity = (float)clamp_between(opacity, 0, 1);
}

void cwi_transfer_move_color(cw_transfer *t, size_t n, double value)
{
    cw_color_point *p = &t->colors[n];
    assert(n < t->color_count);
    const double low = n > 0 ? p[-1].value : -DBL_MAX;
    const double high = n + 1 < t->color_count ? p[1].value : DBL_MAX;
    if (isfinite(value))
        p->value = clamp_between(value, low, high);
}

size_t cwi_transfer_insert_opacity(cw_transfer *t, double value, double opacity)
{
    size_t n = t->opacity_count;
    if (n >= CW_TRANSFER_POINTS || !isfinite(value) || !isfinite(opacity))
        return CWI_TRANSFER_NONE;
    for (; n > 0 && t->opacities[n - 1].value > value; n--)
        t->opacities[n] = t->opacities[n - 1];
    t->opacities[n] = (cw_opacity_point){value, (float)clamp_between(opacity, 0, 1)};
    t->opacity_count++;
    return n;
}

size_t cwi_transfer_insert_color(cw_transfer *t, double value)
{
    double color[3], opacity;
    size_t n = t->color_count;
    if (n >= CW_TRANSFER_POINTS || !isfinite(value))
        return CWI_TRANSFER_NONE;
    cw_transfer_at(t, value, color, &opacity);
    for (; n > 0 && t->colors[n - 1].value > value; n--)
        t->colors[n] = t->colors[n - 1];
    t->colors[n].value = value;
    for (int c = 0; c < 3; c++)
        t->colors[n].color[c] = (float)clamp_between(color[c], 0, 1);
    t->color_count++;
    return n;
}

void cwi_transfer_remove_opacity(cw_transfer *t, size_t n)
{
    assert(n < t->opacity_count);
    t->opacity_count--;
    for (; n < t->opacity_count; n++)
        t->opacities[n] = t->opacities[n + 1];
}

void cwi_transfer_remove_color(cw_transfer *t, size_t n)
{
    assert(n < t->color_count);
    t->color_count--;
    for (; n < t->color_count; n++)
        t->colors[n] = t->colors[n + 1];
}

bool cwi_transfer_range(const cw_transfer *t, double range[2])
{
    if (t->opacity_count > 0) {
        range[0] = t->opacities[0].value;
        range[1] = t->opacities[t->opacity_count - 1].value;
    } else if (t->color_count > 0) {
        range[0] = t->colors[0].value;
        range[1] = t->colors[t->color_count - 1].value;
    }
    return t->opacity_count > 0 || t->color_count > 0;
}

/* An increasing map of values: (value - from) * factor + to. */
typedef struct line {
    double from, factor, to;
} line;

/* Maps a value. Rounding may let values fall, and large ones leave the range of doubles. */
static double map_value(const line *l, double value, double before)
{
    const double mapped = (value - l->from) * l->factor + l->to;
    return isnan(mapped) ? before : clamp_between(mapped, before, DBL_MAX);
}

static void map_values(const line *l, cw_transfer *t)
{
    double before = -DBL_MAX;
    for (size_t n = 0; n < t->color_count; n++)
        before = t->colors[n].value = map_value(l, t->colors[n].value, before);
    before = -DBL_MAX;
    for (size_t n = 0; n < t->opacity_count; n++)
        before = t->opacities[n].value = map_value(l, t->opacities[n].value, before);
}

bool cwi_transfer_shift(const cw_transfer *original, double by, cw_transfer *out)
{
    *out = *original;
    if (!isfinite(by))
        return false;
    map_values(&(line){0, 1, by}, out);
    return true;
}

bool cwi_transfer_scale(const cw_transfer *original, double middle, double factor,
                        cw_transfer *out)
{
    *out = *original;
    if (!isfinite(middle) || !isfinite(factor) || !(factor > 0))
        return false;
    map_values(&(line){middle, factor, middle}, out);
    return true;
}

bool cwi_transfer_window(const cw_transfer *original, double low, double high, cw_transfer *out)
{
    double range[2];
    *out = *original;
    if (!isfinite(low) || !isfinite(high) || !(low < high) ||
        !cwi_transfer_range(original, range))
        return false;
    const double factor = (high / 2 - low / 2) / (range[1] / 2 - range[0] / 2);
    const line wide = {range[0], factor, low}, thin = {range[0], 1, low / 2 + high / 2};
    map_values(isfinite(factor) && factor > 0 ? &wide : &thin, out);
    return true;
}

bool cwi_transfer_fade(const cw_transfer *original, double factor, cw_transfer *out)
{
    *out = *original;
    if (!isfinite(factor) || !(factor >= 0))
        return false;
    for (size_t n = 0; n < out->opacity_count; n++)
        out->opacities[n].opacity =
            (float)clamp_between(factor * (double)out->opacities[n].opacity, 0, 1);
    return true;
}

/* Mirrors colours: each value moves to where it is as far from the other end. */
bool cwi_transfer_mirror(const cw_transfer *original, cw_transfer *out)
{
    const cw_transfer from = *original; /* which may be out */
    const size_t count = from.color_count;
    *out = from;
    for (size_t n = 0; n < count; n++) {
        const cw_color_point *p = &from.colors[count - 1 - n];
        const double before = n > 0 ? out->colors[n - 1].value : from.colors[0].value;
        const double mirrored =
            from.colors[0].value + (from.colors[count - 1].value - p->value);
        out->colors[n] = *p;
        out->colors[n].value = clamp_between(mirrored, before, from.colors[count - 1].value);
    }
    return count > 0;
}
