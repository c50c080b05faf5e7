/* Checks transfer functions, and interpolates their colours and opacities linearly. */
#include <cubewright/transfer.h>

#include "core/base/status.h"

#include <math.h>
#include <string.h>

static cw_status check_value(const char *list, size_t n, double value, double before,
                             cw_error *err)
{
    if (!isfinite(value))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "point %zu of '%s' has a position that is not a number", n, list);
    if (value < before)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "point %zu of '%s' stands at %g, the one before at %g", n, list, value,
                        before);
    return CW_OK;
}

static bool is_fraction(float x)
{
    return x >= 0 && x <= 1;
}

static cw_status check_opacities(const char *list, const cw_opacity_point *p, size_t count,
                                 cw_error *err)
{
    for (size_t n = 0; n < count; n++) {
        cw_status st = check_value(list, n, p[n].value, n ? p[n - 1].value : -INFINITY, err);
        if (st != CW_OK)
            return st;
        if (!is_fraction(p[n].opacity))
            return cwi_fail(err, CW_ERR_ARGUMENT, "point %zu of '%s' is %g, not 0 to 1", n,
                            list, (double)p[n].opacity);
    }
    return CW_OK;
}

static cw_status check_colors(const cw_transfer *t, cw_error *err)
{
    for (size_t n = 0; n < t->color_count; n++) {
        const cw_color_point *p = &t->colors[n];
        cw_status st =
            check_value("colors", n, p->value, n ? t->colors[n - 1].value : -INFINITY, err);
        if (st != CW_OK)
            return st;
        for (int c = 0; c < 3; c++)
            if (!is_fraction(p->color[c]))
                return cwi_fail(err, CW_ERR_ARGUMENT, "point %zu of 'colors' is %g, not 0 to 1",
                                n, (double)p->color[c]);
    }
    return CW_OK;
}

static cw_status check_indices(const cw_transfer *t, cw_error *err)
{
    for (size_t n = 0; n < t->index_count; n++) {
        const cw_index_point *p = &t->indices[n];
        cw_status st =
            check_value("indices", n, p->value, n ? t->indices[n - 1].value : -INFINITY, err);
        if (st != CW_OK)
            return st;
        if (!isfinite(p->index))
            return cwi_fail(err, CW_ERR_ARGUMENT, "point %zu of 'indices' is not a number", n);
    }
    return CW_OK;
}

static cw_status check_length(const char *name, double length, cw_error *err)
{
    if (length == 0 || (isnormal(length) && length > 0))
        return CW_OK;
    return cwi_fail(err, CW_ERR_ARGUMENT, "'%s' is %g: a length was expected", name, length);
}

cw_status cw_transfer_check(const cw_transfer *t, cw_error *err)
{
    CWI_REQUIRE(err, t);
    if (t->color_count > CW_TRANSFER_POINTS || t->opacity_count > CW_TRANSFER_POINTS ||
        t->gradient_count > CW_TRANSFER_POINTS || t->index_count > CW_TRANSFER_POINTS)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a transfer function has at most %d points",
                        CW_TRANSFER_POINTS);
    cw_status st = check_length("unit_mm", t->unit_mm, err);
    if (st == CW_OK)
        st = check_length("surface_mm", t->surface_mm, err);
    if (st == CW_OK)
        st = check_colors(t, err);
    if (st == CW_OK)
        st = check_indices(t, err);
    if (st == CW_OK)
        st = check_opacities("opacities", t->opacities, t->opacity_count, err);
    if (st == CW_OK)
        st = check_opacities("gradients", t->gradients, t->gradient_count, err);
    return st;
}

/* Finds the points around a value: rows n - 1 and n, and the fraction of the way between; at a
 * jump the side above. The points are `count` rows (at least 1) of `row` bytes that begin with
 * their value. */
static size_t find_place(const void *points, size_t row, size_t count, double value,
                         double *fraction)
{
    size_t n = 0;
    *fraction = 0;
#define VALUE(i) (*(const double *)((const char *)points + (i)*row))
    while (n < count && VALUE(n) <= value)
        n++;
    if (n > 0 && n < count) /* in halves: differences may be beyond what doubles hold */
        *fraction = (value / 2 - VALUE(n - 1) / 2) / (VALUE(n) / 2 - VALUE(n - 1) / 2);
#undef VALUE
    return n;
}

double cw_transfer_index(const cw_transfer *t, double value)
{
    double fraction;
    if (t->index_count == 0)
        return value;
    const cw_index_point *p = t->indices;
    const size_t n = find_place(p, sizeof *p, t->index_count, value, &fraction);
    const double low = (double)p[n ? n - 1 : 0].index;
    const double high = (double)p[n < t->index_count ? n : t->index_count - 1].index;
    return low + fraction * (high - low);
}

static double opacity_at(const cw_opacity_point *p, size_t count, double value)
{
    double fraction;
    const size_t n = find_place(p, sizeof *p, count, value, &fraction);
    const cw_opacity_point *low = &p[n ? n - 1 : 0], *high = &p[n < count ? n : count - 1];
    return (double)low->opacity + fraction * ((double)high->opacity - (double)low->opacity);
}

void cw_transfer_at(const cw_transfer *t, double value, double color[3], double *opacity)
{
    double fraction;
    const size_t n = find_place(t->colors, sizeof *t->colors, t->color_count, value, &fraction);
    const size_t last = t->color_count ? t->color_count - 1 : 0;
    const cw_color_point *low = &t->colors[n ? n - 1 : 0];
    const cw_color_point *high = &t->colors[n < last ? n : last];
    for (int c = 0; c < 3; c++)
        color[c] = t->color_count ? (double)low->color[c] + fraction * ((double)high->color[c] -
                                                                        (double)low->color[c])
                                  : 1;
    *opacity = t->opacity_count ? opacity_at(t->opacities, t->opacity_count, value) : 0;
}

double cw_transfer_gradient_factor(const cw_transfer *t, double gradient_per_mm)
{
    return t->gradient_count ? opacity_at(t->gradients, t->gradient_count, gradient_per_mm) : 1;
}
