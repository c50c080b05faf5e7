/* Draws antialiased strokes and rectangles onto images, a row at a time. */
#include "viewer/image/strokes.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>

static double clamp_number(double x, double low, double high)
{
    return fmin(fmax(x, low), high);
}

/* Blends a colour over a pixel; neither is premultiplied. */
static void blend_pixel(uint8_t *pixel, const double color[4], double fraction)
{
    const double alpha = color[3] * fraction, below = pixel[3] / 255.0 * (1 - alpha);
    if (alpha <= 0)
        return;
    for (int c = 0; c < 3; c++)
        pixel[c] =
            (uint8_t)lround((255 * color[c] * alpha + pixel[c] * below) / (alpha + below));
    pixel[3] = (uint8_t)lround(255 * (alpha + below));
}

static double square_of_distance(const cwi_stroke *s, double x, double y)
{
    const double d[2] = {s->to[0] - s->from[0], s->to[1] - s->from[1]};
    const double p[2] = {x - s->from[0], y - s->from[1]};
    const double length_sq = d[0] * d[0] + d[1] * d[1];
    const double t =
        length_sq > 0 ? clamp_number((p[0] * d[0] + p[1] * d[1]) / length_sq, 0, 1) : 0;
    const double off[2] = {p[0] - t * d[0], p[1] - t * d[1]};
    return off[0] * off[0] + off[1] * off[1];
}

/* Finds the pixels from low to high, within a picture of that size. */
static void cut_span(double low, double high, size_t size, size_t span[2])
{
    span[0] = (size_t)clamp_number(floor(low), 0, (double)size);
    span[1] = (size_t)clamp_number(ceil(high), 0, (double)size);
}

static void find_rows(const cwi_stroke *strokes, size_t count, double reach, size_t size,
                      size_t span[2])
{
    double low = INFINITY, high = -INFINITY;
    for (size_t n = 0; n < count; n++) {
        low = fmin(low, fmin(strokes[n].from[1], strokes[n].to[1]));
        high = fmax(high, fmax(strokes[n].from[1], strokes[n].to[1]));
    }
    cut_span(low - reach, high + reach, size, span);
}

/* Finds the columns in which strokes may touch a row: those of their parts that are in reach of
 * it. */
static void find_columns(const cwi_stroke *strokes, size_t count, double y, double reach,
                         size_t size, size_t span[2])
{
    double low = INFINITY, high = -INFINITY;
    for (size_t n = 0; n < count; n++) {
        const cwi_stroke *s = &strokes[n];
        const double rise = s->to[1] - s->from[1], away = y - s->from[1];
        double t[2] = {0, 1};
        if (fabs(rise) > 1e-9) {
            const double a = (away - reach) / rise, b = (away + reach) / rise;
            t[0] = clamp_number(fmin(a, b), 0, 1);
            t[1] = clamp_number(fmax(a, b), 0, 1);
        }
        for (int e = 0; e < 2 && t[0] <= t[1]; e++) {
            const double x = s->from[0] + t[e] * (s->to[0] - s->from[0]);
            low = fmin(low, x);
            high = fmax(high, x);
        }
    }
    cut_span(low - reach, high + reach, size, span);
}

void cwi_pen_draw(const cwi_pen *pen, const cwi_stroke *strokes, size_t count)
{
    const double reach = pen->width / 2 + 0.5;
    size_t columns[2], rows[2];
    find_rows(strokes, count, reach, pen->image->height, rows);
    for (size_t row = rows[0]; row < rows[1]; row++) {
        const double y = (double)row + 0.5;
        find_columns(strokes, count, y, reach, pen->image->width, columns);
        for (size_t x = columns[0]; x < columns[1]; x++) {
            double near = INFINITY;
            for (size_t n = 0; n < count; n++)
                near = fmin(near, square_of_distance(&strokes[n], (double)x + 0.5, y));
            blend_pixel(pen->image->pixels + 4 * (row * pen->image->width + x), pen->color,
                        clamp_number(reach - sqrt(near), 0, 1) * fmin(pen->width, 1));
        }
    }
}

/* Keeps for each pixel the distance of the nearest stroke, which only pixels near by can have. */
cw_status cwi_pen_draw_many(const cwi_pen *pen, const cwi_stroke *strokes, size_t count,
                            cw_error *err)
{
    const cw_image *image = pen->image;
    const size_t width = image->width, all = width * image->height;
    const double reach = pen->width / 2 + 0.5;
    float *near = cwi_alloc_array(all, sizeof *near);
    if (!near)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < all; n++)
        near[n] = INFINITY;
    for (size_t n = 0; n < count; n++) {
        const cwi_stroke *s = &strokes[n];
        size_t x[2], y[2];
        cut_span(fmin(s->from[0], s->to[0]) - reach, fmax(s->from[0], s->to[0]) + reach, width,
                 x);
        cut_span(fmin(s->from[1], s->to[1]) - reach, fmax(s->from[1], s->to[1]) + reach,
                 image->height, y);
        for (size_t row = y[0]; row < y[1]; row++)
            for (size_t column = x[0]; column < x[1]; column++) {
                float *at = &near[row * width + column];
                *at = fminf(
                    *at, (float)square_of_distance(s, (double)column + 0.5, (double)row + 0.5));
            }
    }
    for (size_t n = 0; n < all; n++)
        if ((double)near[n] < reach * reach)
            blend_pixel(image->pixels + 4 * n, pen->color,
                        clamp_number(reach - sqrt((double)near[n]), 0, 1) *
                            fmin(pen->width, 1));
    cwi_free(near);
    return CW_OK;
}

/* Returns the fraction of pixel n that is between two coordinates. */
static double overlap_pixel(size_t n, double low, double high)
{
    return fmax(fmin(high, (double)n + 1) - fmax(low, (double)n), 0);
}

void cwi_pen_fill(const cwi_pen *pen, double left, double top, double right, double bottom)
{
    size_t columns[2], rows[2];
    cut_span(left, right, pen->image->width, columns);
    cut_span(top, bottom, pen->image->height, rows);
    for (size_t y = rows[0]; y < rows[1]; y++)
        for (size_t x = columns[0]; x < columns[1]; x++)
            blend_pixel(pen->image->pixels + 4 * (y * pen->image->width + x), pen->color,
                        overlap_pixel(x, left, right) * overlap_pixel(y, top, bottom));
}
