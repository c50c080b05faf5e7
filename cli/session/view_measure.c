/* Keeps measurements, and shows them over the pictures: in slices those that lie near the slice,
 * fainter those before and behind it. */
#include "cli/session/view_measure.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "viewer/interact/measure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const float FAINT = 0.25f;

const char *view_measure_name(view_measure_kind kind)
{
    static const char *const names[] = {"off", "distance", "angle", "area"};
    return names[kind > VIEW_MEASURE_AREA ? 0 : kind];
}

const double (*view_measure_points(const view *v, const view_measure *m))[3]
{
    return (const double(*)[3])v->measuring.points + m->first;
}

/* An angle reads in tenths of a degree; lengths and areas have five digits. */
void view_measure_value(const view *v, const view_measure *m, char *text, size_t size)
{
    const double(*p)[3] = view_measure_points(v, m);
    if (m->kind == VIEW_MEASURE_DISTANCE) {
        snprintf(text, size, "%.5g mm", cwi_measure_distance(p[0], p[1]));
    } else if (m->kind == VIEW_MEASURE_ANGLE) {
        snprintf(text, size, "%.1f\xc2\xb0", cwi_measure_angle(p[0], p[1], p[2]));
    } else {
        const double area = cwi_measure_area(p, m->count);
        const double bend = cwi_measure_bend(p, m->count);
        const int used = snprintf(text, size, "%.5g mm\xc2\xb2", area);
        if (cwi_measure_crosses(p, m->count))
            snprintf(text + used, size - (size_t)used, ", its edges cross");
        else if (bend > 1e-3 * sqrt(area))
            snprintf(text + used, size - (size_t)used, ", not flat: %.2g mm", bend);
    }
}

static cw_status check_points(view_measure_kind kind, const double (*points)[3], size_t count,
                              cw_error *err)
{
    const char *name = view_measure_name(kind);
    const size_t needed = kind == VIEW_MEASURE_DISTANCE ? 2 : 3;
    if (count < needed || (count > needed && kind != VIEW_MEASURE_AREA))
        return cwi_fail(err, CW_ERR_ARGUMENT, "measure %s: %s%zu points were expected, not %zu",
                        name, kind == VIEW_MEASURE_AREA ? "at least " : "", needed, count);
    if (count > VIEW_POLYGON)
        return cwi_fail(err, CW_ERR_LIMIT, "measure %s: up to %d points were expected", name,
                        VIEW_POLYGON);
    if (kind == VIEW_MEASURE_ANGLE && isnan(cwi_measure_angle(points[0], points[1], points[2])))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "measure angle: its corner is one of the other points");
    return CW_OK;
}

cw_status view_add_measure(view *v, view_measure_kind kind, const double (*points)[3],
                           size_t count, cw_error *err)
{
    view_measuring *measuring = &v->measuring;
    view_state *s = &v->state;
    cw_status st = check_points(kind, points, count, err);
    if (st == CW_OK && s->measure_count == VIEW_MEASURES)
        st = cwi_fail(err, CW_ERR_LIMIT, "measure: there are %d already", VIEW_MEASURES);
    if (st != CW_OK)
        return st;
    double(*all)[3] =
        realloc(measuring->points, (measuring->point_count + count) * sizeof *all);
    if (!all)
        return cwi_fail_memory(err);
    measuring->points = all;
    memcpy(all + measuring->point_count, points, count * sizeof *all);
    s->measures[s->measure_count++] = (view_measure){kind, measuring->point_count, count};
    measuring->point_count += count;
    return CW_OK;
}

void view_put_measures(const view *v, FILE *out, const char *end)
{
    for (size_t n = 0; n < v->state.measure_count; n++) {
        const view_measure *m = &v->state.measures[n];
        const double(*p)[3] = view_measure_points(v, m);
        fprintf(out, "measure %s", view_measure_name(m->kind));
        for (size_t i = 0; i < m->count; i++)
            fprintf(out, " %.9g %.9g %.9g", p[i][0], p[i][1], p[i][2]);
        fputs(end, out);
    }
}

void view_print_measures(const view *v, FILE *out)
{
    char value[96];
    for (size_t n = 0; n < v->state.measure_count; n++) {
        const view_measure *m = &v->state.measures[n];
        const double(*p)[3] = view_measure_points(v, m);
        view_measure_value(v, m, value, sizeof value);
        fprintf(out, "%zu %s %s:", n + 1, view_measure_name(m->kind), value);
        for (size_t i = 0; i < m->count; i++)
            fprintf(out, "%s %.6g %.6g %.6g", i ? "," : "", p[i][0], p[i][1], p[i][2]);
        fputc('\n', out);
    }
}

/* --- the tool ----------------------------------------------------------------------------- */

void view_choose_tool(view *v, view_measure_kind kind)
{
    view_measuring *measuring = &v->measuring;
    measuring->tool = measuring->tool == kind ? VIEW_MEASURE_NONE : kind;
    measuring->tool_count = 0;
}

static size_t points_of_tool(const view *v)
{
    return v->measuring.tool == VIEW_MEASURE_DISTANCE ? 2
           : v->measuring.tool == VIEW_MEASURE_ANGLE  ? 3
                                                      : SIZE_MAX;
}

/* Adds what was picked, as a change that undo takes back by itself. */
cw_status view_end_tool(view *v, cw_error *err)
{
    view_measuring *measuring = &v->measuring;
    if (measuring->tool == VIEW_MEASURE_NONE)
        return cwi_fail(err, CW_ERR_ARGUMENT, "measure-end: nothing is being measured");
    const double(*points)[3] = (const double(*)[3])measuring->tool_points;
    cw_status st = view_add_measure(v, measuring->tool, points, measuring->tool_count, err);
    if (st != CW_OK)
        return st;
    measuring->tool_count = 0;
    v->input.gesture++;
    view_remember(v, "measure");
    return CW_OK;
}

cw_status view_add_tool_point(view *v, const double point[3], cw_error *err)
{
    view_measuring *measuring = &v->measuring;
    if (measuring->tool == VIEW_MEASURE_NONE)
        return cwi_fail(err, CW_ERR_ARGUMENT, "no tool measures: 'measure-tool distance'");
    if (measuring->tool_count == VIEW_POLYGON)
        return cwi_fail(err, CW_ERR_LIMIT, "measure: up to %d points were expected",
                        VIEW_POLYGON);
    if (measuring->tool_count &&
        cwi_measure_distance(measuring->tool_points[measuring->tool_count - 1], point) == 0)
        return CW_OK; /* a click that trembled */
    memcpy(measuring->tool_points[measuring->tool_count++], point, 3 * sizeof *point);
    return measuring->tool_count == points_of_tool(v) ? view_end_tool(v, err) : CW_OK;
}

bool view_measure_key(view *v, const char *key)
{
    view_measuring *measuring = &v->measuring;
    if (measuring->tool == VIEW_MEASURE_NONE)
        return false;
    if (strcmp(key, "Escape") == 0) { /* the points first, then the tool */
        if (!measuring->tool_count)
            view_choose_tool(v, VIEW_MEASURE_NONE);
        measuring->tool_count = 0;
        return true;
    }
    if (strcmp(key, "Enter") != 0 || measuring->tool != VIEW_MEASURE_AREA ||
        measuring->tool_count == 0)
        return false;
    view_ask(v, "measure-end");
    return true;
}

void view_tool_hint(const view *v, char *text, size_t size)
{
    const view_measuring *measuring = &v->measuring;
    const size_t needed = points_of_tool(v);
    if (measuring->tool == VIEW_MEASURE_NONE)
        *text = '\0';
    else if (needed == SIZE_MAX)
        snprintf(text, size, "   area: %zu points; Enter or a double click ends it",
                 measuring->tool_count);
    else
        snprintf(text, size, "   %s: click point %zu of %zu",
                 view_measure_name(measuring->tool), measuring->tool_count + 1, needed);
}

/* --- over the pictures -------------------------------------------------------------------- */

/* Projects points to pixels of the window; false: one is behind the eye. */
static bool project_points(const view *v, int part, const double (*points)[3], size_t count,
                           double (*pixels)[2])
{
    const view_part *p = &v->picture.parts[part];
    for (size_t n = 0; n < count; n++) {
        if (!cw_camera_project(&p->scene.camera, (size_t)p->rect.width, (size_t)p->rect.height,
                               points[n], pixels[n], NULL))
            return false;
        pixels[n][0] += p->rect.x;
        pixels[n][1] += p->rect.y;
    }
    return true;
}

/* Returns half the distance of slices along an axis of the world. */
static double half_slice(const view *v, int axis)
{
    double corner[3], step = 0;
    cw_volume_to_world(cli_drawn(&v->document.source), (const double[3]){0}, corner);
    for (int a = 0; a < 3; a++) {
        double index[3] = {0}, world[3];
        index[a] = 1;
        cw_volume_to_world(cli_drawn(&v->document.source), index, world);
        step = fmax(step, fabs(world[axis] - corner[axis]));
    }
    return 0.5 * step;
}

static bool is_near_slice(const view *v, int part, const double (*points)[3], size_t count)
{
    if (part == VIEW_SPACE)
        return true;
    const int axis = 3 - part;
    const double near_mm = half_slice(v, axis) * (1 + 1e-9);
    for (size_t n = 0; n < count; n++)
        if (fabs(points[n][axis] - v->state.cross[axis]) > near_mm)
            return false;
    return true;
}

/* Writes on a dark plate to the right of a point and above it, beside the lines through it. */
static void write_plate(view *v, double x, double y, const cwi_ui_color color, const char *text)
{
    const double scale = v->ui->scale(v->window);
    const cwi_ui_color plate = {0.04f, 0.05f, 0.07f, 0.78f * color[3]};
    double size[2];
    v->ui->text_size(v->window, text, size);
    const cwi_ui_rect r = {x + 5 * scale, y - size[1] - 10 * scale, size[0] + 8 * scale,
                           size[1] + 4 * scale};
    v->ui->box(v->window, CWI_UI_BEHIND, &r, plate, true);
    v->ui->write(v->window, CWI_UI_BEHIND, r.x + 4 * scale, r.y + 2 * scale, color, text);
}

static void draw_path(view *v, const double (*pixels)[2], size_t count, bool is_closed,
                      const cwi_ui_color color)
{
    const double scale = v->ui->scale(v->window);
    const cwi_ui_color under = {0, 0, 0, 0.6f * color[3]};
    for (int pass = 0; pass < 2; pass++)
        for (size_t n = 0; n + !is_closed < count; n++) {
            const double *a = pixels[n], *b = pixels[(n + 1) % count];
            v->ui->line(v->window, CWI_UI_BEHIND, a[0], a[1], b[0], b[1], pass ? color : under,
                        (pass ? 1.5 : 3.5) * scale);
        }
    for (size_t n = 0; n < count; n++)
        v->ui->disc(v->window, CWI_UI_BEHIND, pixels[n][0], pixels[n][1], 3 * scale, color,
                    true);
}

static void show_measure(view *v, int part, size_t number)
{
    const view_measure *m = &v->state.measures[number];
    const double(*points)[3] = view_measure_points(v, m);
    const bool is_near = is_near_slice(v, part, points, m->count);
    const cwi_ui_color color = {1, 0.85f, 0.25f, is_near ? 1 : FAINT};
    double pixels[VIEW_POLYGON][2], at[2] = {0, 0};
    char value[96], text[sizeof value + 24]; /* with a number in front */
    if (!project_points(v, part, points, m->count, pixels))
        return;
    draw_path(v, (const double(*)[2])pixels, m->count, m->kind == VIEW_MEASURE_AREA, color);
    for (size_t n = 0; n < m->count; n++)
        for (int a = 0; a < 2; a++)
            at[a] += pixels[n][a] / (double)m->count;
    view_measure_value(v, m, value, sizeof value);
    snprintf(text, sizeof text, "%zu: %s", number + 1, value);
    if (is_near)
        write_plate(v, m->kind == VIEW_MEASURE_ANGLE ? pixels[1][0] : at[0],
                    m->kind == VIEW_MEASURE_ANGLE ? pixels[1][1] : at[1], color, text);
}

cw_status view_mark_measures(const view *v, int part, const cw_scene *scene, double text_px,
                             cw_image *image, cw_error *err)
{
    char value[96], texts[VIEW_MEASURES][sizeof value + 24];
    cw_world_mark marks[VIEW_MEASURES];
    const size_t count = v->state.measure_count;
    for (size_t n = 0; n < count; n++) {
        const view_measure *m = &v->state.measures[n];
        const double(*points)[3] = view_measure_points(v, m);
        const bool is_near = is_near_slice(v, part, points, m->count);
        view_measure_value(v, m, value, sizeof value);
        snprintf(texts[n], sizeof texts[n], "%zu: %s", n + 1, value);
        marks[n] = (cw_world_mark){.points = points,
                                   .count = m->count,
                                   .is_closed = m->kind == VIEW_MEASURE_AREA,
                                   .text = is_near ? texts[n] : NULL,
                                   .text_point = m->kind == VIEW_MEASURE_ANGLE ? 1 : m->count,
                                   .opacity = is_near ? 1 : FAINT};
    }
    return count ? cw_world_marks_draw(marks, count, text_px, scene, image, err) : CW_OK;
}

/* Shows the points picked so far, and a line to the mouse. */
static void show_tool(view *v, int part, const cwi_ui_input *in)
{
    static const cwi_ui_color color = {0.35f, 0.95f, 1, 1};
    const cwi_ui_rect *r = &v->picture.parts[part].rect;
    const double(*points)[3] = (const double(*)[3])v->measuring.tool_points;
    double pixels[VIEW_POLYGON + 1][2];
    size_t count = v->measuring.tool_count;
    if (!count || !project_points(v, part, points, count, pixels))
        return;
    if (in->x >= r->x && in->x < r->x + r->width && in->y >= r->y && in->y < r->y + r->height &&
        !in->over_widget) {
        pixels[count][0] = in->x;
        pixels[count++][1] = in->y;
    }
    draw_path(v, (const double(*)[2])pixels, count, false, color);
}

void view_show_measures(view *v, int part, const cwi_ui_input *in)
{
    if (v->picture.parts[part].level == VIEW_STALE ||
        (!v->state.measure_count && !v->measuring.tool_count))
        return;
    v->ui->clip_begin(v->window, CWI_UI_BEHIND, &v->picture.parts[part].rect);
    for (size_t n = 0; n < v->state.measure_count; n++)
        show_measure(v, part, n);
    show_tool(v, part, in);
    v->ui->clip_end(v->window, CWI_UI_BEHIND);
}
