/* Frames: input, what it asks for, pictures. */
#include "cli/session/view_measure.h"
#include "cli/window/panels.h"

#include "cli/framework/console.h"
#include "core/base/status.h"

#include <math.h>
#include <string.h>

enum { STEP_MS = 150 }; /* of a time series that plays */
static const double IDLE_S = 0.25;

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
            v->message.text[0] = '\0';
        }
}

static void play_steps(view *v)
{
    const double now = v->ui->seconds(v->window);
    if (!v->shown.playing || v->document.source.series.count < 2 ||
        now < v->widgets->clock.next_step)
        return;
    view_ask(v, "step next");
    v->widgets->clock.next_step = now + 1e-3 * STEP_MS;
}

static double wait_for(const view *v, double wait_s)
{
    if (!view_is_final(v) || v->script.queued_count || v->film.preview || view_gallery_waits(v))
        return 0;
    return v->shown.playing && v->document.source.series.count > 1
               ? fmin(wait_s, fmax(0, v->widgets->clock.next_step - v->ui->seconds(v->window)))
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
        if (v->picture.parts[p].is_shown) {
            is_stale |= v->picture.parts[p].level == VIEW_STALE;
            lowest = v->picture.parts[p].level < lowest ? v->picture.parts[p].level : lowest;
        }
    if (lowest == VIEW_FINAL || (!is_stale && v->ui->pending(v->window)))
        return CW_OK;
    cw_status st = view_draw(v, is_stale ? VIEW_ROUGH : lowest + 1, !is_stale, &why);
    if (st != CW_OK)
        view_say(v, true, why.message);
    return v->input.is_monkey && st == CW_ERR_BACKEND ? cwi_fail(err, st, "%s", why.message)
                                                      : CW_OK;
}

/* Prints, with -v, the time to the first picture. */
static void tell_first(view *v)
{
    if (v->widgets->clock.is_printed || v->picture.parts[VIEW_SPACE].level == VIEW_STALE ||
        !v->document.path)
        return;
    v->widgets->clock.is_printed = true;
    cli_say_v("first picture shown after %.2f s", cli_seconds() - v->widgets->clock.start);
}

cw_status view_show_frame(view *v, double wait_s, cw_error *err)
{
    const cwi_ui_functions *ui = v->ui;
    const cwi_ui_input *in = ui->begin(v->window, wait_for(v, wait_s));
    ui->set_theme(v->window, v->state.args.light_theme ? CWI_UI_LIGHT : CWI_UI_DARK);
    v->layout.width = in->width;
    v->layout.height = in->height;
    v->quits |= in->close || cli_interrupted();
    for (int b = 0; b < CWI_UI_BUTTONS; b++)
        v->input.gesture += in->pressed[b] || in->lifted[b];
    v->input.gesture += in->key_count;
    if (!in->typing)
        press_keys(v, in);
    for (size_t n = 0; n < in->drop_count; n++)
        view_ask_open(v, in->drops[n]);
    view_panels(v);
    view_lay_out(v);
    view_show_parts(v, in);
    view_mouse(v, in);
    play_steps(v);
    cw_status st = ui->end(v->window, err);
    tell_first(v);
    view_run_queued(v);
    view_draw_gallery(v);
    if (st == CW_OK)
        st = view_run_preview(v, err);
    return st == CW_OK ? draw_session(v, err) : st;
}

cw_status view_loop(view *v, cw_error *err)
{
    cw_status st = CW_OK;
    while (st == CW_OK && !v->quits)
        st = view_show_frame(v, IDLE_S, err);
    return st;
}
