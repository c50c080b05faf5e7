/* Handles the mouse on the pictures. It requests commands, like everything else. */
#include "cli/session/view_measure.h"
#include "cli/window/panels.h"

#include "viewer/interact/clip_box_handles.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NOTHING, ORBIT, PAN, DOLLY, SHIFT, SPLIT, CROSS, GREYS, POINT, HANDLE };
enum { HANDLE_PX = 12, DIVIDER_PX = 6, CLICK_PX = 4 };

static bool is_in(const cwi_ui_rect *r, double x, double y)
{
    return x >= r->x && x < r->x + r->width && y >= r->y && y < r->y + r->height;
}

static int part_under(const view *v, double x, double y)
{
    for (int p = 0; p < VIEW_PARTS; p++)
        if (v->picture.parts[p].is_shown && is_in(&v->picture.parts[p].rect, x, y))
            return p;
    return -1;
}

static cwi_handle_view looked_at(const view *v)
{
    const cwi_ui_rect *r = &v->picture.parts[VIEW_SPACE].rect;
    return (cwi_handle_view){v->state.camera, (size_t)r->width, (size_t)r->height};
}

static cwi_world_box clip_box(const view *v)
{
    double corners[2][3];
    cwi_world_box box;
    view_clip_box(v, corners);
    memcpy(box.low, corners[0], sizeof box.low);
    memcpy(box.high, corners[1], sizeof box.high);
    return box;
}

static bool has_handles(const view *v)
{
    return v->shown.handles && v->document.path && v->state.is_placed;
}

static int handle_under(const view *v, double x, double y)
{
    cwi_handle handles[CWI_HANDLES];
    const cwi_handle_view look = looked_at(v);
    const cwi_world_box box = clip_box(v);
    const double pixel[2] = {x, y};
    cwi_handles_place(&look, &box, handles);
    return cwi_handles_hit(handles, pixel, HANDLE_PX * v->ui->scale(v->window));
}

static bool is_on_divider(const view *v, double x)
{
    const cwi_ui_rect *r = &v->picture.parts[VIEW_SPACE].rect;
    return v->state.args.compare && !v->state.args.difference.given &&
           fabs(x - v->state.left_fraction * r->width) <= DIVIDER_PX * v->ui->scale(v->window);
}

/* Returns the drag that a button pressed on a part begins. */
static int begin_drag(const view *v, const cwi_ui_input *in, int part)
{
    const cwi_ui_rect *r = &v->picture.parts[part].rect;
    const double x = in->x - r->x, y = in->y - r->y;
    const bool left = in->pressed[CWI_UI_LEFT];
    if (part != VIEW_SPACE)
        return left && v->measuring.tool   ? POINT
               : left                      ? CROSS
               : in->pressed[CWI_UI_RIGHT] ? GREYS
                                           : NOTHING;
    const int handle = left && has_handles(v) ? handle_under(v, x, y) : CWI_HANDLE_NONE;
    if (handle != CWI_HANDLE_NONE)
        return HANDLE + handle;
    if (left && is_on_divider(v, x))
        return SPLIT;
    if (left && in->modifiers & CWI_UI_CTRL)
        return SHIFT;
    if (in->pressed[CWI_UI_RIGHT])
        return DOLLY;
    return left && !(in->modifiers & CWI_UI_SHIFT) ? ORBIT : PAN;
}

/* The point of a slice that is seen at a pixel of its part. */
static bool slice_point(const view *v, int part, double x, double y, double point[3])
{
    const view_part *p = &v->picture.parts[part];
    const double pixel[2] = {x, y};
    double origin[3], direction[3];
    const int axis = 3 - part;
    if (p->level == VIEW_STALE || !p->scene.volume ||
        cw_camera_ray(&p->scene.camera, (size_t)p->rect.width, (size_t)p->rect.height, pixel,
                      origin, direction, NULL) != CW_OK)
        return false;
    memcpy(point, origin, 3 * sizeof *point);
    point[axis] = v->state.cross[axis];
    return true;
}

static void move_cross(view *v, const cwi_ui_input *in)
{
    double point[3];
    const cwi_ui_rect *r = &v->picture.parts[v->widgets->mouse.part].rect;
    if (slice_point(v, v->widgets->mouse.part, in->x - r->x, in->y - r->y, point))
        view_ask(v, "cross %.9g %.9g %.9g", point[0], point[1], point[2]);
}

/* To the right: more of the values between black and white; down: brighter. */
static void move_greys(view *v, const cwi_ui_input *in)
{
    const cw_statistics *s = &v->document.statistics;
    double w[2];
    const double range = s->max - s->min;
    view_grey_range(v, w);
    double middle = 0.5 * (w[0] + w[1]), width = w[1] - w[0];
    middle -= in->dy / 400 * range;
    width = fmax(width * exp(in->dx / 200), 1e-6 * range);
    if (range > 0)
        view_ask(v, "window %.9g %.9g", middle - 0.5 * width, middle + 0.5 * width);
}

/* To the right: all values of the transfer function higher; up: more opaque. */
static void shift_curve(view *v, const cwi_ui_input *in)
{
    const cli_scene *s = &v->state.args.scene;
    const double range = v->document.statistics.max - v->document.statistics.min;
    const double opacity = s->opacity.given ? s->opacity.value : 1;
    if (in->dx != 0)
        view_ask(v, "shift %.9g", s->shift.value + in->dx / 800 * range);
    if (in->dy != 0)
        view_ask(v, "opacity %.9g", opacity * exp(-in->dy / 200));
}

static void drag_handle(view *v, const cwi_ui_input *in, int handle)
{
    const cwi_ui_rect *r = &v->picture.parts[VIEW_SPACE].rect;
    const cwi_handle_view look = looked_at(v);
    cwi_world_box bounds, box = clip_box(v);
    const double pixel[2] = {in->x - r->x, in->y - r->y};
    const int axis = handle / 2;
    memcpy(bounds.low, v->document.box[0], sizeof bounds.low);
    memcpy(bounds.high, v->document.box[1], sizeof bounds.high);
    const double thin = 1e-3 * (bounds.high[axis] - bounds.low[axis]);
    if (cwi_handles_drag(&look, &bounds, thin, handle, pixel, &box))
        view_ask(v, "clip-face %d %.9g", handle, handle % 2 ? box.high[axis] : box.low[axis]);
}

static void go_on_dragging(view *v, const cwi_ui_input *in)
{
    const view_drag *mouse = &v->widgets->mouse;
    const cwi_ui_rect *r = &v->picture.parts[VIEW_SPACE].rect;
    if ((in->dx == 0 && in->dy == 0) || !v->document.path)
        return;
    if (mouse->drag == ORBIT)
        view_ask(v, "orbit %.6g %.6g", -in->dx * 0.4, in->dy * 0.4);
    else if (mouse->drag == PAN)
        view_ask(v, "pan %.6g %.6g", in->dx, in->dy);
    else if (mouse->drag == DOLLY)
        view_ask(v, "dolly %.6g", exp(-in->dy / 200));
    else if (mouse->drag == SHIFT && v->document.has_volume)
        shift_curve(v, in);
    else if (mouse->drag == SPLIT)
        view_ask(v, "split %.6g", fmin(fmax((in->x - r->x) / r->width, 0), 1));
    else if (mouse->drag == CROSS)
        move_cross(v, in);
    else if (mouse->drag == GREYS)
        move_greys(v, in);
    else if (mouse->drag >= HANDLE)
        drag_handle(v, in, mouse->drag - HANDLE);
}

static void turn_wheel(view *v, const cwi_ui_input *in, int part)
{
    static const char axes[] = "xyz";
    if (v->shown.cut)
        view_ask(v, "cut %c %.6g", axes[v->shown.cut - 1], in->wheel * 2);
    else if (part != VIEW_SPACE && in->modifiers & CWI_UI_CTRL)
        view_ask(v, "zoom-slices %.6g", v->state.slice_zoom * exp(in->wheel * 0.1));
    else if (part != VIEW_SPACE)
        view_ask(v, "cross-by %c %.6g", axes[3 - part], in->wheel);
    else
        view_ask(v, "dolly %.6g", exp(in->wheel * 0.1));
}

/* The value of the volume that is seen, for slices; of the scene only on a cross-hair. */
static void probe_part(view *v, const cwi_ui_input *in, int part)
{
    double point[3];
    char label[CLI_LABEL_NAME + 32];
    bool there = false;
    memcpy(point, v->state.cross, sizeof point);
    if (part > VIEW_SPACE)
        there = slice_point(v, part, in->x - v->picture.parts[part].rect.x,
                            in->y - v->picture.parts[part].rect.y, point);
    v->input.probe[0] = '\0';
    if (!v->document.has_volume ||
        cli_drawn(&v->document.source)->cells) /* the value at any point is unknown */
        return;
    const double value = cw_volume_sample(cli_drawn(&v->document.source), point);
    view_label_at(v, point, label, sizeof label);
    if (view_slice_labels(v).is_base) /* values between labels mean nothing */
        snprintf(v->input.probe, sizeof v->input.probe, "%s%.80s at %.1f, %.1f, %.1f mm",
                 there ? "" : "cross-hair: ", *label ? label : "no label", point[0], point[1],
                 point[2]);
    else
        snprintf(v->input.probe, sizeof v->input.probe, "%s %.5g at %.1f, %.1f, %.1f mm%s%.80s",
                 there ? "value" : "cross-hair:", value, point[0], point[1], point[2],
                 *label ? ": " : "", label);
}

/* Returns the cursor that shows the effect of a press. */
static int cursor_for(const view *v, const cwi_ui_input *in, int part)
{
    const view_drag *mouse = &v->widgets->mouse;
    enum { ARROW, CROSS_HAIR, HAND, LEFT_RIGHT };
    const cwi_ui_rect *r = &v->picture.parts[VIEW_SPACE].rect;
    if (part > VIEW_SPACE ||
        (part == VIEW_SPACE && v->measuring.tool && mouse->drag == NOTHING))
        return CROSS_HAIR;
    if (part != VIEW_SPACE || !v->document.path)
        return ARROW;
    if (mouse->drag == SPLIT || is_on_divider(v, in->x - r->x))
        return LEFT_RIGHT;
    return mouse->drag >= HANDLE ||
                   (has_handles(v) &&
                    handle_under(v, in->x - r->x, in->y - r->y) != CWI_HANDLE_NONE)
               ? HAND
               : ARROW;
}

/* Measures at a click: a press and a lift at one place. Drags are what they are without a tool,
 * so that a scene can be turned between two points. */
static void click_tool(view *v, const cwi_ui_input *in, int part)
{
    view_drag *mouse = &v->widgets->mouse;
    const cwi_ui_rect *r = &v->picture.parts[part < 0 ? 0 : part].rect;
    const double x = in->x - r->x, y = in->y - r->y;
    double point[3];
    if (in->pressed[CWI_UI_LEFT]) {
        const bool ends = in->twice[CWI_UI_LEFT];
        mouse->from[0] = !ends && part >= 0 ? in->x : -2 * CLICK_PX; /* nowhere */
        mouse->from[1] = in->y;
        if (ends && v->measuring.tool == VIEW_MEASURE_AREA && v->measuring.tool_count)
            view_ask(v, "measure-end");
    }
    if (!in->lifted[CWI_UI_LEFT] || part < 0 || mouse->part != part ||
        hypot(in->x - mouse->from[0], in->y - mouse->from[1]) >
            CLICK_PX * v->ui->scale(v->window))
        return;
    if (part == VIEW_SPACE)
        view_ask(v, "measure-pick %.6g %.6g", x, y);
    else if (slice_point(v, part, x, y, point))
        view_ask(v, "measure-point %.9g %.9g %.9g", point[0], point[1], point[2]);
}

void view_mouse(view *v, const cwi_ui_input *in)
{
    view_drag *mouse = &v->widgets->mouse;
    const int part = in->over_widget ? -1 : part_under(v, in->x, in->y);
    bool pressed = false, is_down = false;
    for (int b = 0; b < CWI_UI_BUTTONS; b++) {
        pressed |= in->pressed[b];
        is_down |= in->down[b];
    }
    probe_part(v, in, part);
    if (pressed && part >= 0 && v->document.path && mouse->drag == NOTHING) {
        mouse->drag = begin_drag(v, in, part);
        mouse->part = part;
        if (mouse->drag == CROSS)
            move_cross(v, in);
    } else if (mouse->drag != NOTHING) {
        go_on_dragging(v, in);
    }
    if (v->measuring.tool && v->document.path)
        click_tool(v, in, part);
    if (!is_down)
        mouse->drag = NOTHING;
    v->input.is_dragging = mouse->drag != NOTHING;
    if (in->twice[CWI_UI_LEFT] && part == VIEW_SPACE && v->document.path && !v->measuring.tool)
        view_ask(v, "pick %.6g %.6g", in->x - v->picture.parts[part].rect.x,
                 in->y - v->picture.parts[part].rect.y);
    if (in->wheel != 0 && part >= 0 && v->document.path)
        turn_wheel(v, in, part);
    v->ui->set_cursor(v->window, cursor_for(v, in, part));
}

/* --- marks over the pictures -------------------------------------------------------------- */

static void show_cross(view *v, int part)
{
    static const cwi_ui_color colors[3] = {
        {0.95f, 0.4f, 0.35f, 0.8f}, {0.45f, 0.85f, 0.4f, 0.8f}, {0.4f, 0.65f, 1, 0.8f}};
    const view_part *p = &v->picture.parts[part];
    const cwi_ui_rect *r = &p->rect;
    double pixel[2];
    if (p->level == VIEW_STALE ||
        !cw_camera_project(&p->scene.camera, (size_t)r->width, (size_t)r->height,
                           v->state.cross, pixel, NULL))
        return;
    const double x = r->x + pixel[0], y = r->y + pixel[1];
    const int across = part == VIEW_SAGITTAL ? 1 : 0, up = part == VIEW_AXIAL ? 1 : 2;
    if (part == VIEW_SPACE) {
        v->ui->disc(v->window, CWI_UI_BEHIND, x, y, 4 * v->ui->scale(v->window), colors[0],
                    false);
        return;
    }
    if (x >= r->x && x < r->x + r->width)
        v->ui->line(v->window, CWI_UI_BEHIND, x, r->y, x, r->y + r->height, colors[across],
                    v->ui->scale(v->window));
    if (y >= r->y && y < r->y + r->height)
        v->ui->line(v->window, CWI_UI_BEHIND, r->x, y, r->x + r->width, y, colors[up],
                    v->ui->scale(v->window));
}

static void show_handles(view *v)
{
    static const cwi_ui_color front = {1, 0.8f, 0.3f, 0.9f}, back = {1, 0.8f, 0.3f, 0.3f};
    const cwi_ui_rect *r = &v->picture.parts[VIEW_SPACE].rect;
    const cwi_handle_view look = looked_at(v);
    const cwi_world_box box = clip_box(v);
    cwi_handle handles[CWI_HANDLES];
    cwi_box_edge edges[CWI_BOX_EDGES];
    cwi_handles_place(&look, &box, handles);
    cwi_handles_edges(&look, &box, edges);
    v->ui->clip_begin(v->window, CWI_UI_BEHIND, r);
    for (int n = 0; n < CWI_BOX_EDGES; n++)
        if (edges[n].shown)
            v->ui->line(v->window, CWI_UI_BEHIND, r->x + edges[n].pixels[0][0],
                        r->y + edges[n].pixels[0][1], r->x + edges[n].pixels[1][0],
                        r->y + edges[n].pixels[1][1], edges[n].is_behind ? back : front,
                        1.5 * v->ui->scale(v->window));
    for (int n = 0; n < CWI_HANDLES; n++)
        if (handles[n].shown)
            v->ui->disc(v->window, CWI_UI_BEHIND, r->x + handles[n].pixel[0],
                        r->y + handles[n].pixel[1], 6 * v->ui->scale(v->window),
                        handles[n].faces_away ? back : front, true);
    v->ui->clip_end(v->window, CWI_UI_BEHIND);
}

static void show_divider(view *v, const cwi_ui_input *in)
{
    static const cwi_ui_color white = {1, 1, 1, 0.9f};
    const cwi_ui_rect *r = &v->picture.parts[VIEW_SPACE].rect;
    const double x = r->x + v->state.left_fraction * r->width;
    const bool over = is_in(r, in->x, in->y) && is_on_divider(v, in->x - r->x);
    v->ui->line(v->window, CWI_UI_BEHIND, x, r->y, x, r->y + r->height, white,
                (over ? 3 : 1) * v->ui->scale(v->window));
}

void view_show_parts(view *v, const cwi_ui_input *in)
{
    for (int p = 0; p < VIEW_PARTS; p++) {
        const view_part *part = &v->picture.parts[p];
        if (!part->is_shown || !v->document.path)
            continue;
        v->ui->show(v->window, p, &part->rect);
        if (p > VIEW_SPACE || (v->shown.cross && view_fits_mode(v, CW_MODE_SLICES)))
            show_cross(v, p);
    }
    if (has_handles(v))
        show_handles(v);
    for (int p = 0; p < VIEW_PARTS && v->document.path; p++)
        if (v->picture.parts[p].is_shown)
            view_show_measures(v, p, in);
    if (!v->document.path || !v->state.args.compare || !view_draws_volume(v))
        return;
    if (!v->state.args.difference.given)
        show_divider(v, in);
    view_show_badges(v);
}
