/* The transfer function over the histogram: points of the opacities, colours below, and the
 * isovalue as a line. */
#include "cli/window/panels.h"

#include "viewer/interact/transfer_edit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Things that the mouse drags: an opacity point, a colour, the isovalue. */
enum { NOTHING, POINT, COLOR, ISO };
enum { NEAR_PX = 8, COLUMNS = 256 };

static const cwi_ui_color dim = {1, 1, 1, 0.16f}, bright = {1, 1, 1, 0.9f},
                          strong = {1, 0.8f, 0.3f, 1}, line_color = {0.55f, 0.8f, 1, 1};

/* Values are left to right over the range, opacities upwards. */
static double x_of(const view *v, const cwi_ui_rect *r, double value)
{
    const double range = v->document.statistics.max - v->document.statistics.min;
    return r->x + (range > 0 ? (value - v->document.statistics.min) / range : 0.5) * r->width;
}

static double value_of(const view *v, const cwi_ui_rect *r, double x)
{
    return v->document.statistics.min +
           (x - r->x) / r->width * (v->document.statistics.max - v->document.statistics.min);
}

static double y_of(const cwi_ui_rect *r, double opacity)
{
    return r->y + (1 - opacity) * r->height;
}

/* Draws the histogram, logarithmic: a column is as high as its fullest bin. */
static void show_histogram(view *v, const cwi_ui_rect *r)
{
    const cw_statistics *s = &v->document.statistics;
    double counts[COLUMNS] = {0}, max = 1;
    for (size_t c = 0; c < COLUMNS && s->bin_count; c++) {
        const size_t end = ((c + 1) * s->bin_count - 1) / COLUMNS;
        for (size_t b = c * s->bin_count / COLUMNS; b <= end; b++)
            counts[c] = fmax(counts[c], log1p((double)s->bins[b]));
        max = fmax(max, counts[c]);
    }
    const double width = r->width / COLUMNS;
    for (int c = 0; c < COLUMNS; c++) {
        const double high = counts[c] / max * r->height;
        const cwi_ui_rect column = {r->x + c * width, r->y + r->height - high, width, high};
        if (high > 0)
            v->ui->box(v->window, CWI_UI_PANEL, &column, dim, true);
    }
}

static void show_opacities(view *v, const cwi_ui_rect *r)
{
    const cw_transfer *t = &v->picture.transfer;
    double points[2 * (CW_TRANSFER_POINTS + 2)];
    size_t n = 0;
    if (t->opacity_count == 0)
        return;
    points[n++] = r->x;
    points[n++] = y_of(r, (double)t->opacities[0].opacity);
    for (size_t p = 0; p < t->opacity_count; p++) {
        points[n++] = x_of(v, r, t->opacities[p].value);
        points[n++] = y_of(r, (double)t->opacities[p].opacity);
    }
    points[n++] = r->x + r->width;
    points[n++] = y_of(r, (double)t->opacities[t->opacity_count - 1].opacity);
    v->ui->clip_begin(v->window, CWI_UI_PANEL, r);
    v->ui->polygon(v->window, CWI_UI_PANEL, points, n / 2, line_color, false);
    v->ui->clip_end(v->window, CWI_UI_PANEL);
    for (size_t p = 0; p < t->opacity_count; p++)
        v->ui->disc(v->window, CWI_UI_PANEL, points[2 * p + 2], points[2 * p + 3],
                    4 * v->ui->scale(v->window), bright,
                    v->widgets->curve.drag != POINT || v->widgets->curve.point != (int)p);
}

static void show_colors(view *v, const cwi_ui_rect *r)
{
    enum { STEPS = 64 };
    cwi_ui_color colors[2] = {{0, 0, 0, 1}, {0, 0, 0, 1}};
    for (int n = 0; n <= STEPS; n++) {
        double rgb[3], opacity;
        cwi_ui_rect part = {r->x + (n - 1) * r->width / STEPS, r->y, r->width / STEPS,
                            r->height};
        cw_transfer_at(&v->picture.transfer, value_of(v, r, part.x + part.width), rgb,
                       &opacity);
        memcpy(colors[0], colors[1], sizeof colors[0]);
        for (int c = 0; c < 3; c++)
            colors[1][c] = (float)rgb[c];
        if (n)
            v->ui->blend(v->window, CWI_UI_PANEL, &part, colors[0], colors[1]);
    }
    for (size_t n = 0; n < v->picture.transfer.color_count; n++) {
        const double x = x_of(v, r, v->picture.transfer.colors[n].value);
        if (x >= r->x && x <= r->x + r->width)
            v->ui->line(v->window, CWI_UI_PANEL, x, r->y, x, r->y + r->height, bright,
                        v->widgets->curve.color == n ? 3 : 1);
    }
}

static void show_iso(view *v, const cwi_ui_rect *r)
{
    const cli_number *iso = &v->state.args.iso;
    if (!iso->given || v->document.source.is_mesh)
        return;
    const double x = x_of(v, r, iso->value);
    v->ui->line(v->window, CWI_UI_PANEL, x, r->y, x, r->y + r->height, strong, 2);
}

static bool is_near_iso(const view *v, const cwi_ui_area *a)
{
    const cli_number *iso = &v->state.args.iso;
    return iso->given && fabs(x_of(v, &a->rect, iso->value) - (a->rect.x + a->x)) < NEAR_PX;
}

/* Where the mouse is, in value and opacity; and how near is near. */
static void locate_pointer(const view *v, const cwi_ui_area *a, double at[2], double near[2])
{
    const double range = v->document.statistics.max - v->document.statistics.min;
    at[0] = value_of(v, &a->rect, a->rect.x + fmin(fmax(a->x, 0), a->rect.width));
    at[1] = fmin(fmax(1 - a->y / a->rect.height, 0), 1);
    near[0] = NEAR_PX / a->rect.width * range;
    near[1] = NEAR_PX / a->rect.height;
}

static void press_point(view *v, const double at[2], const double near[2], bool on_iso)
{
    view_curve_drag *curve = &v->widgets->curve;
    const size_t point = cwi_transfer_near_opacity(&v->picture.transfer, at[0], at[1], near);
    curve->drag = NOTHING;
    if (point != CWI_TRANSFER_NONE) {
        curve->drag = POINT;
        curve->point = (int)point;
    } else if (on_iso) {
        curve->drag = ISO;
    }
}

/* A press moves a point or the isovalue, two put a point in, the right button takes it out. */
static void use_curve(view *v, const cwi_ui_area *a)
{
    view_curve_drag *curve = &v->widgets->curve;
    double at[2], near[2];
    locate_pointer(v, a, at, near);
    const size_t point = cwi_transfer_near_opacity(&v->picture.transfer, at[0], at[1], near);
    if (a->pressed)
        press_point(v, at, near, is_near_iso(v, a));
    if (a->twice && point == CWI_TRANSFER_NONE)
        view_ask(v, "add-point %.9g %.6g", at[0], at[1]);
    else if (a->right && point != CWI_TRANSFER_NONE && v->picture.transfer.opacity_count > 1)
        view_ask(v, "remove-point %zu", point);
    else if (a->is_down && !a->pressed && curve->drag == POINT &&
             (a->x != curve->at[0] || a->y != curve->at[1]))
        view_ask(v, "point %d %.9g %.6g", curve->point, at[0], at[1]);
    else if (a->is_down && curve->drag == ISO && a->x != curve->at[0])
        view_ask(v, "iso %.9g", at[0]);
    if (!a->is_down)
        curve->drag = NOTHING;
    curve->at[0] = a->x;
    curve->at[1] = a->y;
}

/* One press chooses a colour and drags it, two put one in, the right button takes it out. */
static void use_colors(view *v, const cwi_ui_area *a)
{
    view_curve_drag *curve = &v->widgets->curve;
    double at[2], near[2], rgb[3], opacity;
    locate_pointer(v, a, at, near);
    const size_t n = cwi_transfer_near_color(&v->picture.transfer, at[0], near[0]);
    cw_transfer_at(&v->picture.transfer, at[0], rgb, &opacity);
    if (a->pressed && n != CWI_TRANSFER_NONE)
        curve->color = n;
    curve->drags_color =
        a->is_down && (a->pressed ? n != CWI_TRANSFER_NONE : curve->drags_color);
    if (a->twice && n == CWI_TRANSFER_NONE)
        view_ask(v, "add-color %.9g #%02x%02x%02x", at[0], (unsigned)lround(255 * rgb[0]),
                 (unsigned)lround(255 * rgb[1]), (unsigned)lround(255 * rgb[2]));
    else if (a->right && n != CWI_TRANSFER_NONE && v->picture.transfer.color_count > 1)
        view_ask(v, "remove-color %zu", n);
    else if (curve->drags_color && !a->pressed && a->x != curve->color_at)
        view_ask(v, "move-color %zu %.9g", curve->color, at[0]);
    curve->color_at = a->x;
}

static void choose_color(view *v)
{
    const view_curve_drag *curve = &v->widgets->curve;
    const cw_transfer *t = &v->picture.transfer;
    float rgb[3];
    if (curve->color >= t->color_count)
        return;
    memcpy(rgb, t->colors[curve->color].color, sizeof rgb);
    if (v->ui->color(v->window, "Colour of the point", rgb))
        view_ask(v, "color-point %zu #%02x%02x%02x", curve->color,
                 (unsigned)lroundf(255 * rgb[0]), (unsigned)lroundf(255 * rgb[1]),
                 (unsigned)lroundf(255 * rgb[2]));
}

/* Shows the numbers of the point that was used last. */
void view_show_point(view *v)
{
    view_curve_drag *curve = &v->widgets->curve;
    const cw_transfer *t = &v->picture.transfer;
    const double range = v->document.statistics.max - v->document.statistics.min;
    if (!view_draws_volume(v) || t->opacity_count == 0 ||
        !v->ui->section(v->window, "Curve in numbers", false))
        return;
    size_t n = (size_t)curve->point < t->opacity_count ? (size_t)curve->point : 0;
    double chosen = (double)n, value = t->opacities[n].value,
           opacity = (double)t->opacities[n].opacity;
    if (t->opacity_count > 1 &&
        v->ui->slider(v->window, "Point", &chosen, 0, (double)t->opacity_count - 1, "%.0f"))
        curve->point = (int)lround(chosen);
    v->ui->tip(v->window, "Point of the opacity curve, from the left");
    if (v->ui->number(v->window, "Its value", &value, range / 400, "%.6g"))
        view_ask(v, "point %zu %.9g %.6g", n, value, opacity);
    v->ui->tip(v->window, "Drag, or double-click to type");
    if (v->ui->slider(v->window, "Its opacity", &opacity, 0, 1, "%.3f"))
        view_ask(v, "point %zu %.9g %.6g", n, value, opacity);
    v->ui->tip(v->window, "Opacity for a path of one voxel; Ctrl and a click: type it");
}

void view_curve(view *v)
{
    static const cwi_ui_color back = {0.07f, 0.075f, 0.085f, 1};
    const double scale = v->ui->scale(v->window);
    cwi_ui_area curve, colors;
    char text[128];
    v->ui->area(v->window, "Curve", 0, 130 * scale, &curve);
    v->ui->tip(v->window, "Drag points; double-click adds one; right-click removes it");
    v->ui->box(v->window, CWI_UI_PANEL, &curve.rect, back, true);
    show_histogram(v, &curve.rect);
    show_iso(v, &curve.rect);
    if (view_draws_volume(v)) {
        show_opacities(v, &curve.rect);
        use_curve(v, &curve);
        v->ui->area(v->window, "Colours", 0, 16 * scale, &colors);
        v->ui->tip(v->window,
                   "Click to choose a colour; drag to move it; double-click adds one");
        show_colors(v, &colors.rect);
        use_colors(v, &colors);
        choose_color(v);
    } else if (curve.is_down) {
        view_ask(v, "iso %.9g", value_of(v, &curve.rect, curve.rect.x + curve.x));
    }
    snprintf(text, sizeof text, "%.5g to %.5g%s", v->document.statistics.min,
             v->document.statistics.max, curve.over ? "" : " (logarithmic counts)");
    if (curve.over)
        snprintf(text, sizeof text, "value %.5g",
                 value_of(v, &curve.rect, curve.rect.x + curve.x));
    v->ui->text(v->window, text);
}
