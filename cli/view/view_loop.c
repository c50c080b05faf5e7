/* Frames: input, what it asks for, pictures. */
#include "cli/view/view.h"
#include "cli/view/view_measure.h"

#include "cli/framework/console.h"
#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { STEP_MS = 150 }; /* of a time series that plays */
static const double IDLE_S = 0.25;

bool view_is_quad(const view *v)
{
    return v->state.args.marks.layout == CLI_LAYOUT_QUAD && v->has_volume &&
           view_fits_mode(v, CW_MODE_SLICES);
}

/* The scene alone, or in the lower right of four. */
void view_place_parts(view *v, const cwi_ui_rect *area, bool is_quad)
{
    const double w = floor(area->width / 2), h = floor(area->height / 2);
    for (int p = 0; p < VIEW_PARTS; p++) {
        view_part *part = &v->parts[p];
        const cwi_ui_rect before = part->rect;
        const int at = p == VIEW_SPACE ? 3 : p - 1; /* of four */
        const double x = at % 2 ? w + 1 : 0, y = at / 2 ? h + 1 : 0;
        part->is_shown = p == VIEW_SPACE || is_quad;
        part->rect =
            is_quad ? (cwi_ui_rect){area->x + x, area->y + y, at % 2 ? area->width - w - 1 : w,
                                    at / 2 ? area->height - h - 1 : h}
                    : *area;
        part->rect.width = fmax(part->rect.width, 1);
        part->rect.height = fmax(part->rect.height, 1);
        if (memcmp(&before, &part->rect, sizeof before) != 0)
            part->level = VIEW_STALE;
    }
}

cwi_ui_rect view_picture_area(const view *v)
{
    return (cwi_ui_rect){0, v->bar_height, fmax(1, (double)v->width - v->panel_width),
                         fmax(1, (double)v->height - v->bar_height - v->strip_height)};
}

void view_lay_out(view *v)
{
    const cwi_ui_rect area = view_picture_area(v);
    view_place_parts(v, &area, view_is_quad(v));
}

static void press_keys(view *v, const cwi_ui_input *in)
{
    bool is_taken[CWI_UI_KEYS] = {false};
    for (size_t k = 0; k < in->key_count; k++)
        is_taken[k] = view_measure_key(v, in->keys[k]);
    for (size_t k = 0; k < in->key_count; k++)
        for (size_t n = 0; n < view_key_count && !is_taken[k]; n++)
            if (view_keys[n].key && strcmp(view_keys[n].key, in->keys[k]) == 0)
                view_ask(v, "%s", view_keys[n].command);
    for (size_t k = 0; k < in->key_count; k++)
        if (!is_taken[k] && strcmp(in->keys[k], "Escape") == 0) {
            v->shown.help = v->shown.about = v->shown.files = false;
            v->shown.save_mesh = v->shown.save_picture = v->shown.gallery = false;
            v->shown.cut = 0;
            v->message[0] = '\0';
        }
}

static void play_steps(view *v)
{
    const double now = v->ui->seconds(v->window);
    if (!v->shown.playing || v->source.series.count < 2 || now < v->play_next)
        return;
    view_ask(v, "step next");
    v->play_next = now + 1e-3 * STEP_MS;
}

static double wait_for(const view *v, double wait_s)
{
    if (!view_is_final(v) || v->asked_count || v->preview || view_gallery_waits(v))
        return 0;
    return v->shown.playing && v->source.series.count > 1
               ? fmin(wait_s, fmax(0, v->play_next - v->ui->seconds(v->window)))
               : wait_s;
}

/* Rough pictures at once, better ones when there is nothing else to do. What cannot be drawn is
 * told in the window; to the monkey GL's errors are failures. */
static cw_status draw_session(view *v, cw_error *err)
{
    cw_error why = {0};
    bool is_stale = false;
    view_level lowest = VIEW_FINAL;
    for (int p = 0; p < VIEW_PARTS; p++)
        if (v->parts[p].is_shown) {
            is_stale |= v->parts[p].level == VIEW_STALE;
            lowest = v->parts[p].level < lowest ? v->parts[p].level : lowest;
        }
    if (lowest == VIEW_FINAL || (!is_stale && v->ui->pending(v->window)))
        return CW_OK;
    cw_status st = view_draw(v, is_stale ? VIEW_ROUGH : lowest + 1, !is_stale, &why);
    if (st != CW_OK)
        view_say(v, true, why.message);
    return v->is_monkey && st == CW_ERR_BACKEND ? cwi_fail(err, st, "%s", why.message) : CW_OK;
}

/* With -v: how long people waited for something to see. */
static void tell_first(view *v)
{
    if (v->is_told || v->parts[VIEW_SPACE].level == VIEW_STALE || !v->path)
        return;
    v->is_told = true;
    cli_say_v("first picture shown after %.2f s", cli_seconds() - v->start);
}

cw_status view_frame(view *v, double wait_s, cw_error *err)
{
    const cwi_ui_functions *ui = v->ui;
    const cwi_ui_input *in = ui->begin(v->window, wait_for(v, wait_s));
    ui->set_theme(v->window, v->state.args.light_theme ? CWI_UI_LIGHT : CWI_UI_DARK);
    v->width = in->width;
    v->height = in->height;
    v->quits |= in->close || cli_interrupted();
    for (int b = 0; b < CWI_UI_BUTTONS; b++)
        v->gesture += in->pressed[b] || in->lifted[b];
    v->gesture += in->key_count;
    if (!in->typing)
        press_keys(v, in);
    for (size_t n = 0; n < in->drop_count; n++)
        view_ask_open(v, in->drops[n]);
    view_panels(v, in);
    view_lay_out(v);
    view_show_parts(v, in);
    view_mouse(v, in);
    play_steps(v);
    cw_status st = ui->end(v->window, err);
    tell_first(v);
    view_run_asked(v);
    view_draw_gallery(v);
    if (st == CW_OK)
        st = view_run_preview(v, err);
    return st == CW_OK ? draw_session(v, err) : st;
}

cw_status view_take_in(view *v, cw_error *err)
{
    cw_status st = view_frame(v, 0, err);
    while (st == CW_OK && (v->ui->pending(v->window) || v->asked_count) && !v->quits)
        st = view_frame(v, 0, err);
    for (int n = 0; n < 3 && st == CW_OK && v->ui->focused(v->window); n++)
        st = view_frame(v, 0, err); /* the widget that has the keys follows them */
    return st;
}

/* Twice more in the end: widgets that show what has been drawn. */
cw_status view_settle(view *v, cw_error *err)
{
    cw_status st = view_take_in(v, err);
    while (st == CW_OK && !view_is_final(v) && !v->quits)
        st = view_frame(v, 0, err);
    for (int n = 0; n < 2 && st == CW_OK; n++)
        st = view_frame(v, 0, err);
    return st;
}

cw_status view_loop(view *v, cw_error *err)
{
    cw_status st = CW_OK;
    while (st == CW_OK && !v->quits)
        st = view_frame(v, IDLE_S, err);
    return st;
}

static double draw_random(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

cw_status view_monkey(view *v, uint64_t *seed, cw_error *err)
{
    const double what = draw_random(seed), x = draw_random(seed), y = draw_random(seed);
    cwi_ui_event e = {
        .kind = CWI_UI_MOVE, .x = x * (double)v->width, .y = y * (double)v->height};
    char text[16];
    if (what < 0.2) {
        const view_key *k = &view_keys[(size_t)(x * (double)view_key_count)];
        e.kind = CWI_UI_KEY;
        e.text = k->key ? k->key : "Escape";
    } else if (what < 0.6) {
        e.kind = what < 0.4 ? CWI_UI_PRESS : CWI_UI_LIFT;
        e.button = (int)(x * 1.3); /* the left one mostly */
        e.modifiers = y < 0.1 ? CWI_UI_CTRL : y < 0.2 ? CWI_UI_SHIFT : 0;
    } else if (what < 0.7) {
        e.kind = CWI_UI_WHEEL;
        e.y = y < 0.5 ? -1 : 1;
    } else if (what < 0.72) {
        e = (cwi_ui_event){.kind = CWI_UI_RESIZE, .x = 40 + 600 * x, .y = 40 + 500 * y};
    } else if (what < 0.75) {
        snprintf(text, sizeof text, "%g", 1000 * x - 300);
        e = (cwi_ui_event){.kind = CWI_UI_WRITE, .text = text};
    }
    cw_status st = v->ui->feed(v->window, &e, err);
    return st == CW_OK ? view_frame(v, 0, err) : st;
}
