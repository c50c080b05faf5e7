/* Draws annotations on an image: the volume's box, axes, scale bar, colour bar, histogram and
 * caption. */
#include <cubewright/overlay.h>

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "viewer/image/isolines.h"
#include "viewer/image/legend.h"
#include "viewer/image/strokes.h"
#include "viewer/scene/mesh_tint.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MAX_BARS = 512, MAX_LABELS = 8, TEXT = 48 };

/* An image that is drawn on. Lengths are pixels of the image, not samples of the frame. */
typedef struct board {
    const cw_overlay *o;
    const cwi_frame *frame;
    cw_image *image;
    double width, height, text, margin;
    double top;   /* above it the middle is taken */
    double right; /* beyond it the legend is */
    double ink[4], halo[4];
    double corners[8][3];
} board;

static const double axis_colors[3][3] = {
    {0.95, 0.45, 0.40}, {0.45, 0.85, 0.45}, {0.50, 0.65, 1}};

/* Returns the longest of 1, 2, 5 times a power of ten that is not above a length. */
static double round_down(double length)
{
    const double power = pow(10, floor(log10(length) + 1e-9)), fraction = length / power;
    return (fraction >= 5 ? 5 : fraction >= 2 ? 2 : 1) * power;
}

static double round_up(double length)
{
    const double power = pow(10, floor(log10(length) + 1e-9)), fraction = length / power;
    return (fraction <= 1 ? 1 : fraction <= 2 ? 2 : fraction <= 5 ? 5 : 10) * power;
}

static void print_length(double mm, char text[TEXT])
{
    if (mm < 1)
        snprintf(text, TEXT, "%.6g \xc2\xb5m", mm * 1000);
    else if (mm < 1000)
        snprintf(text, TEXT, "%.6g mm", mm);
    else
        snprintf(text, TEXT, "%.6g m", mm / 1000);
}

/* Prints a value with a minus sign as long as the plus sign. */
static void print_value(double value, char text[TEXT])
{
    const double shown = value == 0 ? 0 : value; /* not -0 */
    snprintf(text, TEXT, "%s%.6g", shown < 0 ? "\xe2\x88\x92" : "", fabs(shown));
}

static void tint_color(double color[4], const double rgb[3], double alpha)
{
    memcpy(color, rgb, 3 * sizeof *color);
    color[3] = alpha;
}

/* Draws strokes in a colour, on a halo that separates them from any picture. */
static void draw_lines(const board *b, const cwi_stroke *strokes, size_t count, double width,
                       const double color[4])
{
    cwi_pen pen = {.image = b->image, .width = width + 1.6 * b->text / 10};
    memcpy(pen.color, b->halo, sizeof pen.color);
    pen.color[3] *= color[3];
    cwi_pen_draw(&pen, strokes, count);
    pen.width = width;
    memcpy(pen.color, color, sizeof pen.color);
    cwi_pen_draw(&pen, strokes, count);
}

static void write_text(const board *b, double x, double y, double anchor, const double color[4],
                       const char *text)
{
    cwi_text_write(b->image, (const double[2]){x, y}, b->text, anchor, color, b->halo, text);
}

/* Projects a point of the world to the picture; returns false behind the eye. */
static bool project_point(const board *b, const double world[3], double at[2])
{
    const cwi_frame *f = b->frame;
    double d[3], eye[3];
    for (int a = 0; a < 3; a++)
        d[a] = (world[a] - f->eye_mm[a]) / f->unit_mm;
    for (int a = 0; a < 3; a++)
        eye[a] = cwi_dot(f->axes[a], d);
    const double w = f->perspective ? -eye[2] : 1;
    if (w < 1e-9)
        return false;
    at[0] = b->width / 2 * (1 + eye[0] / w / f->half[0]);
    at[1] = b->height / 2 * (1 - eye[1] / w / f->half[1]);
    return true;
}

/* Finds the corners of the volume's box, or else of the mesh's. Bit a of a corner's number is
 * its end along axis a. */
static void find_corners(board *b)
{
    const cwi_frame *f = b->frame;
    double ends[2][3];
    if (!f->volume.data)
        cw_mesh_bounds(f->scene.mesh, ends[0], ends[1]);
    for (int n = 0; n < 8; n++) {
        double p[3];
        for (int a = 0; a < 3; a++)
            p[a] = !f->volume.data ? ends[n >> a & 1][a] : n >> a & 1 ? f->high[a] : f->low[a];
        if (f->volume.data)
            cw_volume_to_world(&f->volume, p, b->corners[n]);
        else
            memcpy(b->corners[n], p, sizeof p);
    }
}

/* Returns true if the face at an end of an axis is seen from outside. */
static bool is_seen(const board *b, int axis, int end)
{
    const cwi_frame *f = b->frame;
    const int at = end << axis;
    const double *from = b->corners[at];
    double side[3][3], across[3], eye[3];
    for (int a = 0; a < 3; a++) /* along the axis: from the face inwards */
        for (int c = 0; c < 3; c++)
            side[a][c] = b->corners[at ^ 1 << a][c] - from[c];
    cwi_cross(side[(axis + 1) % 3], side[(axis + 2) % 3], across);
    for (int c = 0; c < 3; c++)
        eye[c] = f->perspective ? f->eye_mm[c] - from[c] : f->axes[2][c];
    return cwi_dot(across, eye) * cwi_dot(across, side[axis]) < 0;
}

static void draw_box(const board *b)
{
    for (int edge = 0; edge < 12; edge++) {
        const int axis = edge / 4, next = (axis + 1) % 3, last = (axis + 2) % 3;
        const int at = (edge & 1) << next | (edge >> 1 & 1) << last;
        const bool seen = is_seen(b, next, edge & 1) || is_seen(b, last, edge >> 1 & 1);
        double color[4];
        cwi_stroke s;
        tint_color(color, b->ink, b->ink[3] * (seen ? 0.7 : 0.25));
        if (project_point(b, b->corners[at], s.from) &&
            project_point(b, b->corners[at | 1 << axis], s.to))
            draw_lines(b, &s, 1, fmax(b->text / 9, 1), color);
    }
}

/* Draws the world's directions, the farthest first. */
static void draw_triad(const board *b)
{
    static const char *const names[3] = {"L", "P", "S"};
    const double size = 3.2 * b->text;
    const double middle[2] = {b->margin + 1.5 * size, b->height - b->margin - 1.5 * size};
    int order[3] = {0, 1, 2};
    for (int i = 0; i < 3; i++)
        for (int j = i + 1; j < 3; j++)
            if (b->frame->axes[2][order[j]] < b->frame->axes[2][order[i]]) {
                const int keep = order[i];
                order[i] = order[j];
                order[j] = keep;
            }
    for (int n = 0; n < 3; n++) {
        const int a = order[n];
        const double right = b->frame->axes[0][a], up = b->frame->axes[1][a];
        const cwi_stroke s = {{middle[0], middle[1]},
                              {middle[0] + size * right, middle[1] - size * up}};
        double color[4];
        tint_color(color, axis_colors[a], 1);
        for (int c = 0; c < 3 && b->halo[0] > 0; c++)
            color[c] *= 0.7; /* on a bright picture */
        draw_lines(b, &s, 1, fmax(b->text / 5, 1.5), color);
        write_text(b, middle[0] + 1.35 * size * right,
                   middle[1] - 1.35 * size * up + b->text / 2, 0.5, color, names[a]);
    }
}

/* Names where a direction leads, the main way first. */
static void name_direction(const double d[3], char text[4])
{
    static const char names[3][2] = {{'R', 'L'}, {'A', 'P'}, {'I', 'S'}};
    bool used[3] = {false};
    size_t count = 0;
    for (int n = 0; n < 3; n++) {
        int best = -1;
        for (int a = 0; a < 3; a++)
            if (!used[a] && fabs(d[a]) > 0.35 && (best < 0 || fabs(d[a]) > fabs(d[best])))
                best = a;
        if (best < 0)
            break;
        used[best] = true;
        text[count++] = names[best][d[best] > 0];
    }
    text[count] = 0;
}

static void draw_letters(const board *b)
{
    const double low = b->height - b->margin - (b->o->scale_bar ? 3.2 * b->text : 0);
    const struct {
        double x, y, anchor;
        int axis, sign;
    } places[4] = {{b->right - b->margin, (b->height + b->text) / 2, 1, 0, 1},
                   {b->margin, (b->height + b->text) / 2, 0, 0, -1},
                   {b->width / 2, b->top + b->text, 0.5, 1, 1},
                   {b->width / 2, low, 0.5, 1, -1}};
    for (int n = 0; n < 4; n++) {
        double d[3];
        char text[4];
        for (int a = 0; a < 3; a++)
            d[a] = places[n].sign * b->frame->axes[places[n].axis][a];
        name_direction(d, text);
        write_text(b, places[n].x, places[n].y, places[n].anchor, b->ink, text);
    }
}

static void find_scale_bar(const cwi_frame *f, double width, double height, double *mm,
                           double *pixels)
{
    double away = 1;
    if (f->perspective) {
        away = 0;
        for (int a = 0; a < 3; a++)
            away += (f->eye_mm[a] - f->scene.camera.target[a]) / f->unit_mm * f->axes[2][a];
    }
    const double pixels_a_mm = height / (2 * f->half[1] * away * f->unit_mm);
    *mm = round_down(0.25 * width / pixels_a_mm);
    *pixels = *mm * pixels_a_mm;
}

static void draw_scale_bar(const board *b)
{
    double mm, length;
    char text[TEXT];
    find_scale_bar(b->frame, b->width, b->height, &mm, &length);
    const double left = (b->width - length) / 2, y = b->height - b->margin, tick = b->text / 2;
    const cwi_stroke s[3] = {{{left, y}, {left + length, y}},
                             {{left, y - tick}, {left, y}},
                             {{left + length, y - tick}, {left + length, y}}};
    draw_lines(b, s, 3, fmax(b->text / 6, 1), b->ink);
    print_length(mm, text);
    write_text(b, b->width / 2, y - 0.7 * b->text, 0.5, b->ink, text);
}

/* Finds the range from the transfer function's first point to its last. */
static void find_range(const cw_transfer *t, double range[2])
{
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (size_t n = 0; n < t->color_count; n++)
        range[0] = fmin(range[0], t->colors[n].value),
        range[1] = fmax(range[1], t->colors[n].value);
    for (size_t n = 0; n < t->opacity_count; n++)
        range[0] = fmin(range[0], t->opacities[n].value),
        range[1] = fmax(range[1], t->opacities[n].value);
    if (!(range[0] < range[1])) {
        const double middle = isfinite(range[0]) ? range[0] : 0;
        range[0] = middle - 0.5;
        range[1] = middle + 0.5;
    }
}

static void frame_box(const board *b, double left, double top, double right, double bottom)
{
    const cwi_stroke s[4] = {{{left, top}, {right, top}},
                             {{right, top}, {right, bottom}},
                             {{right, bottom}, {left, bottom}},
                             {{left, bottom}, {left, top}}};
    cwi_pen pen = {.image = b->image, .width = fmax(b->text / 9, 1)};
    memcpy(pen.color, b->ink, sizeof pen.color);
    cwi_pen_draw(&pen, s, 4);
}

/* A bar of colours, from its low values at the bottom to high ones. */
typedef struct color_bar {
    double range[2], box[4];       /* left, top, right, bottom */
    const cw_value_slices *values; /* NULL: of the scene's volume, or else of the mesh's tint */
} color_bar;

/* Computes the colour at a fraction of the bar's range. */
static void bar_color(const board *b, const color_bar *bar, double fraction, double rgb[3])
{
    const double *range = bar->range;
    uint8_t bytes[3];
    double opacity;
    if (!bar->values && b->frame->volume.data)
        cw_transfer_at(&b->frame->transfer, range[0] + fraction * (range[1] - range[0]), rgb,
                       &opacity);
    else if (!bar->values)
        cwi_ramp_color(fraction, rgb);
    else
        cw_colormap_color(bar->values->map, fraction, bytes);
    for (int c = 0; c < 3 && bar->values; c++)
        rgb[c] = bytes[c] / 255.0;
}

static void fill_bar(const board *b, const color_bar *bar)
{
    const double *box = bar->box;
    cwi_pen pen = {.image = b->image, .color = {0, 0, 0, 1}};
    for (double y = floor(box[1]); y < box[3]; y++) {
        const double high = fmax(y, box[1]), low = fmin(y + 1, box[3]);
        bar_color(b, bar, (box[3] - (high + low) / 2) / (box[3] - box[1]), pen.color);
        cwi_pen_fill(&pen, box[0], high, box[2], low);
    }
    frame_box(b, box[0], box[1], box[2], box[3]);
}

/* Draws a bar with round values at its left side. */
static void draw_bar(const board *b, const color_bar *bar)
{
    const double *range = bar->range, *box = bar->box;
    const double span = range[1] - range[0], step = round_up(span / (MAX_LABELS - 2));
    fill_bar(b, bar);
    for (double n = ceil(range[0] / step - 1e-9); n * step <= range[1] + 1e-9 * span; n++) {
        const double y = box[3] - (n * step - range[0]) / span * (box[3] - box[1]);
        const cwi_stroke tick = {{box[0] - b->text / 2, y}, {box[0], y}};
        char text[TEXT];
        draw_lines(b, &tick, 1, fmax(b->text / 9, 1), b->ink);
        print_value(n * step, text);
        write_text(b, box[0] - 0.9 * b->text, y + b->text / 2, 1, b->ink, text);
    }
}

static cw_status draw_color_bar(const board *b, cw_error *err)
{
    const double right = b->width - b->margin;
    color_bar bar = {.box = {right - 1.6 * b->text, 3.2 * b->margin, right, 0.44 * b->height}};
    if (b->frame->volume.data)
        find_range(&b->frame->transfer, bar.range);
    else if (cwi_tint_range(&b->frame->scene, bar.range, err) != CW_OK)
        return CW_ERR_ARGUMENT;
    draw_bar(b, &bar);
    return CW_OK;
}

static void draw_values_bar(const board *b)
{
    const double right = b->width - b->margin, h = b->height;
    const bool is_below = b->o->color_bar;
    color_bar bar = {.values = b->o->values_bar,
                     .range = {b->o->values_bar->low, b->o->values_bar->high},
                     .box = {right - 1.6 * b->text, is_below ? 0.56 * h : 3.2 * b->margin,
                             right, is_below ? h - 3.2 * b->margin : 0.44 * h}};
    draw_bar(b, &bar);
}

/* Computes heights of bars, 0 to 1, each of the most frequent of its bins. */
static void find_bars(const cw_statistics *s, double *bars, size_t count)
{
    double max_y = 1;
    memset(bars, 0, count * sizeof *bars);
    for (size_t n = 0; n < s->bin_count; n++)
        max_y = fmax(max_y, log1p((double)s->bins[n]));
    for (size_t i = 0; i < count; i++)
        for (size_t n = i * s->bin_count / count; n <= ((i + 1) * s->bin_count - 1) / count;
             n++)
            bars[i] = fmax(bars[i], log1p((double)s->bins[n]) / max_y);
}

/* Finds the opacity at the ends of a range, and at the transfer function's points between. */
static size_t find_curve(const cw_transfer *t, const double range[2],
                         double points[CW_TRANSFER_POINTS + 2][2])
{
    double color[3];
    size_t count = 1;
    points[0][0] = range[0];
    for (size_t n = 0; n < t->opacity_count; n++)
        if (t->opacities[n].value > range[0] && t->opacities[n].value < range[1]) {
            points[count][0] = t->opacities[n].value;
            points[count++][1] = (double)t->opacities[n].opacity;
        }
    points[count][0] = range[1];
    cw_transfer_at(t, range[0], color, &points[0][1]);
    cw_transfer_at(t, range[1], color, &points[count][1]);
    return count + 1;
}

/* Draws the opacity curve. Its highest point is as high as the box, and is labelled with its
 * value. */
static void draw_curve(const board *b, const double range[2], const double box[4])
{
    double points[CW_TRANSFER_POINTS + 2][2], max_y = 0, color[4];
    cwi_stroke s[CW_TRANSFER_POINTS + 1];
    char text[TEXT];
    const size_t count = find_curve(&b->frame->transfer, range, points);
    for (size_t n = 0; n < count; n++)
        max_y = fmax(max_y, points[n][1]);
    for (size_t n = 0; n < count; n++) {
        const double at[2] = {box[0] + (points[n][0] - range[0]) / (range[1] - range[0]) *
                                           (box[2] - box[0]),
                              box[3] - points[n][1] / fmax(max_y, 1e-6) * (box[3] - box[1])};
        if (n > 0)
            memcpy(s[n - 1].to, at, sizeof at);
        if (n + 1 < count)
            memcpy(s[n].from, at, sizeof at);
    }
    tint_color(color, (const double[3]){1, 0.75, 0.2}, 1);
    draw_lines(b, s, count - 1, fmax(b->text / 6, 1.2), color);
    print_value(max_y, text);
    write_text(b, box[0] - b->text / 2, box[1] + b->text, 1, color, text);
}

static void draw_histogram(const board *b)
{
    const cw_statistics *s = b->o->statistics;
    const double range[2] = {s->min, s->max > s->min ? s->max : s->min + 1};
    const double bottom = b->height - b->margin - 1.6 * b->text;
    const double box[4] = {0.70 * b->width, bottom - 0.18 * b->height, b->width - b->margin,
                           bottom};
    double bars[MAX_BARS];
    const size_t count = (size_t)fmin(fmax(floor(box[2] - box[0]), 1), MAX_BARS);
    const double wide = (box[2] - box[0]) / (double)count;
    char text[TEXT];
    cwi_pen pen = {.image = b->image};
    tint_color(pen.color, b->halo, 0.45);
    cwi_pen_fill(&pen, box[0], box[1], box[2], box[3]);
    find_bars(s, bars, count);
    tint_color(pen.color, b->ink, 0.55);
    for (size_t n = 0; n < count; n++)
        cwi_pen_fill(&pen, box[0] + (double)n * wide, box[3] - bars[n] * (box[3] - box[1]),
                     box[0] + (double)(n + 1) * wide, box[3]);
    draw_curve(b, range, box);
    frame_box(b, box[0], box[1], box[2], box[3]);
    for (int end = 0; end < 2; end++) {
        print_value(range[end], text);
        write_text(b, box[2 * end], box[3] + 1.5 * b->text, end, b->ink, text);
    }
}

/* Draws the legend between the colour bar and the histogram, if these are there. */
static void draw_legend(board *b)
{
    const cw_overlay *o = b->o;
    cwi_legend legend = {.items = o->legend,
                         .count = o->legend_count,
                         .text = b->text,
                         .right = b->width - b->margin,
                         .max_width = 0.4 * b->width,
                         .top = o->color_bar ? 0.44 * b->height + 2 * b->margin : b->margin,
                         .bottom = b->height - b->margin};
    if (o->histogram)
        legend.bottom -= 0.18 * b->height + 3.2 * b->text;
    memcpy(legend.ink, b->ink, sizeof legend.ink);
    memcpy(legend.halo, b->halo, sizeof legend.halo);
    b->right = cwi_legend_draw(&legend, b->image);
}

/* Draws the isoline, as wide as the box's edges. */
static cw_status draw_isoline(const board *b, cw_error *err)
{
    static const double yellow[4] = {1, 0.8, 0.2, 1};
    const uint8_t *c = b->o->isoline_color;
    const bool given = c[0] || c[1] || c[2] || c[3];
    cwi_pen pen = {.image = b->image, .width = fmax(b->text / 8, 1.2)};
    cwi_stroke *strokes;
    size_t count;
    cw_status st = cwi_isolines_find(b->frame, b->image, b->o->isovalue, &strokes, &count, err);
    const double width = pen.width;
    pen.width = width + 1.4;
    pen.color[3] = 0.5 * (given ? c[3] / 255.0 : 1);
    if (st == CW_OK && count)
        st = cwi_pen_draw_many(&pen, strokes, count, err);
    for (int a = 0; a < 4; a++)
        pen.color[a] = given ? c[a] / 255.0 : yellow[a];
    pen.width = width;
    if (st == CW_OK && count)
        st = cwi_pen_draw_many(&pen, strokes, count, err);
    cwi_free(strokes);
    return st;
}

/* Draws the caption. The letter at the top moves below lines that reach it. */
static cw_status draw_caption(board *b, cw_error *err)
{
    const char *line = b->o->caption;
    for (double y = b->margin + b->text; line; y += 1.8 * b->text) {
        const char *end = strchr(line, '\n');
        const size_t length = end ? (size_t)(end - line) : strlen(line);
        char *text = cwi_alloc_array(length + 1, 1);
        if (!text)
            return cwi_fail_memory(err);
        memcpy(text, line, length);
        text[length] = 0;
        write_text(b, b->margin, y, 0, b->ink, text);
        if (b->margin + cwi_text_width(b->text, text) > b->width / 2 - 2 * b->text)
            b->top = y + 0.8 * b->text;
        cwi_free(text);
        line = end ? end + 1 : NULL;
    }
    return CW_OK;
}

/* Returns true if the picture's rim, where texts are written, is bright; transparent pixels
 * count as dark. */
static bool is_bright(const cw_image *image)
{
    const size_t w = image->width, h = image->height;
    double sum = 0, count = 0;
    for (size_t y = 0; y < h; y++)
        for (size_t x = 0; x < w;
             x += y < h / 8 || y >= h - h / 8 || w < 2 ? 1 : w - 1, count++) {
            const uint8_t *p = image->pixels + 4 * (y * w + x);
            sum += (0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]) / 255 * (p[3] / 255.0);
        }
    return sum > 0.5 * count;
}

static void choose_ink(board *b)
{
    const uint8_t *c = b->o->color;
    const bool given = c[0] || c[1] || c[2] || c[3];
    const double plain = is_bright(b->image) ? 0 : 1;
    for (int a = 0; a < 4; a++)
        b->ink[a] = given ? c[a] / 255.0 : a < 3 ? plain : 1;
    const double bright = 0.2126 * b->ink[0] + 0.7152 * b->ink[1] + 0.0722 * b->ink[2];
    tint_color(b->halo, bright > 0.5 ? (const double[3]){0} : (const double[3]){1, 1, 1}, 0.5);
}

static cw_status check_overlay(const cw_overlay *o, const cwi_frame *f, cw_error *err)
{
    const cw_statistics *s = o->statistics;
    if (o->histogram && !(s && s->bin_count > 0 && s->bins))
        return cwi_fail(err, CW_ERR_ARGUMENT, "a histogram needs statistics with bins");
    if (o->histogram && !f->volume.data)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a histogram is of a volume that is drawn");
    if (o->color_bar && !f->volume.data && f->scene.mesh_look.tint == CW_TINT_COLORS)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a colour bar needs a volume or a tinted mesh");
    if (o->isoline && f->scene.mode != CW_MODE_SLICES)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "isolines are drawn on slices, not in the mode %s",
                        cw_mode_name(f->scene.mode));
    if (o->isoline && f->scene.mesh)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "isolines are not drawn on slices with a mesh before them");
    if (o->values_bar && !(o->values_bar->low < o->values_bar->high))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the bar of values needs a range");
    if (o->isoline && !isfinite(o->isovalue))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the isoline's isovalue is not a finite number");
    if (!(o->text_px >= 0 && o->text_px <= 1000))
        return cwi_fail(err, CW_ERR_ARGUMENT, "letters %g pixels high: expected up to 1000",
                        o->text_px);
    return CW_OK;
}

/* Computes the frame of a scene, if the image has its shape to a pixel. */
static cw_status take_frame(const cw_scene *scene, const cw_image *image, cwi_frame *frame,
                            cw_error *err)
{
    if (!image->pixels)
        return cwi_fail(err, CW_ERR_ARGUMENT, "the image is empty");
    cw_status st = cwi_frame_init(frame, scene, err);
    if (st != CW_OK)
        return st;
    const double w = (double)frame->scene.width, h = (double)frame->scene.height;
    if (fabs((double)image->width * h - (double)image->height * w) > fmax(w, h))
        return cwi_fail(err, CW_ERR_ARGUMENT, "an image of %zu x %zu is not one of this scene",
                        image->width, image->height);
    return CW_OK;
}

cw_status cw_scale_bar(const cw_scene *scene, const cw_image *image, double *length_mm,
                       double *length_px, cw_error *err)
{
    CWI_REQUIRE(err, scene, image, length_mm, length_px);
    cwi_frame frame;
    cw_status st = take_frame(scene, image, &frame, err);
    if (st == CW_OK)
        find_scale_bar(&frame, (double)image->width, (double)image->height, length_mm,
                       length_px);
    return st;
}

cw_status cw_overlay_draw(const cw_overlay *overlay, const cw_scene *scene, cw_image *image,
                          cw_error *err)
{
    CWI_REQUIRE(err, overlay, scene, image);
    cwi_frame frame;
    cw_status st = take_frame(scene, image, &frame, err);
    if (st == CW_OK)
        st = check_overlay(overlay, &frame, err);
    if (st != CW_OK)
        return st;
    const double h = (double)image->height;
    board b = {.o = overlay,
               .frame = &frame,
               .image = image,
               .width = (double)image->width,
               .height = h,
               .text = overlay->text_px > 0 ? overlay->text_px : fmax(round(h / 48), 7)};
    b.margin = b.top = 1.2 * b.text;
    b.right = b.width;
    choose_ink(&b);
    if (overlay->isoline)
        st = draw_isoline(&b, err);
    if (st == CW_OK)
        st = draw_caption(&b, err);
    if (overlay->legend_count > 0)
        draw_legend(&b);
    if (overlay->axes) {
        find_corners(&b);
        draw_box(&b);
        draw_triad(&b);
    }
    if (overlay->letters)
        draw_letters(&b);
    if (overlay->scale_bar)
        draw_scale_bar(&b);
    if (overlay->color_bar && st == CW_OK)
        st = draw_color_bar(&b, err);
    if (overlay->values_bar)
        draw_values_bar(&b);
    if (overlay->histogram)
        draw_histogram(&b);
    return st;
}
