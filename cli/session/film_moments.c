/* Shows moments of a film: what has numbers changes smoothly between key frames. Plays it in the window. */
#include "cli/session/film.h"

#include "core/geometry/monotone_curve.h"

#include <math.h>
#include <stdlib.h>

void view_free_key_frames(view_key_frames *f)
{
    free(f->keys);
    free(f->times);
    *f = (view_key_frames){0};
}

/* Blends the double at an offset of the keys' states, over count keys from the first on. */
static double blend_double(const view_key_frames *f, size_t first, size_t count, double time,
                           size_t offset)
{
    double values[VIEW_KEY_FRAMES];
    for (size_t n = 0; n < count; n++)
        values[n] = *(const double *)((const char *)&f->keys[first + n].state + offset);
    return cwi_monotone_curve(f->times + first, values, count, time);
}

static const cli_number *number_of(const view_key_frame *k, size_t offset)
{
    return (const cli_number *)((const char *)&k->state + offset);
}

/* Blends a number of all keys; where some keys lack it, of the two keys around. */
static double blend_number(const view_key_frames *f, size_t at, double time, size_t offset)
{
    const size_t value = offset + offsetof(cli_number, value);
    bool is_everywhere = true;
    for (size_t n = 0; n < f->count; n++)
        is_everywhere = is_everywhere && number_of(&f->keys[n], offset)->given;
    return is_everywhere ? blend_double(f, 0, f->count, time, value)
                         : blend_double(f, at, 2, time, value);
}

/* Blends the options that are numbers in both of the keys around. */
static void blend_options(const view *v, const view_key_frames *f, size_t at, double time,
                          view_state *s)
{
    const view_key_frame *a = &f->keys[at], *b = a + 1;
    for (size_t n = 0; n < v->command->option_count; n++) {
        const cli_option *o = &v->command->options[n];
        if (o->kind != CLI_NUMBER && o->kind != CLI_LEVEL)
            continue;
        const size_t offset = offsetof(view_state, args) + o->offset;
        cli_number *number = (cli_number *)((char *)s + offset);
        if (number_of(a, offset)->given && number_of(b, offset)->given)
            number->value = blend_number(f, at, time, offset);
    }
}

static void blend_doubles(const view_key_frames *f, double time, size_t offset, size_t count,
                          view_state *s)
{
    for (size_t n = 0; n < count; n++)
        ((double *)((char *)s + offset))[n] =
            blend_double(f, 0, f->count, time, offset + n * sizeof(double));
}

static void blend_slices_and_boxes(const view_key_frames *f, size_t at, double time,
                                   view_state *s)
{
    const view_state *a = &f->keys[at].state, *b = &f->keys[at + 1].state;
    const cli_ranges *boxes[2] = {&a->args.scene.clip_box, &b->args.scene.clip_box};
    blend_doubles(f, time, offsetof(view_state, cross), 3, s);
    blend_doubles(f, time, offsetof(view_state, slice_zoom), 1, s);
    blend_doubles(f, time, offsetof(view_state, left_fraction), 1, s);
    if (a->window[0] < a->window[1] && b->window[0] < b->window[1])
        for (int n = 0; n < 2; n++)
            s->window[n] = cwi_monotone_curve(
                f->times + at, (const double[2]){a->window[n], b->window[n]}, 2, time);
    if (!boxes[0]->given || !boxes[1]->given || boxes[0]->world != boxes[1]->world)
        return;
    for (int n = 0; n < 3; n++) {
        s->args.scene.clip_box.low[n] = cwi_monotone_curve(
            f->times + at, (const double[2]){boxes[0]->low[n], boxes[1]->low[n]}, 2, time);
        s->args.scene.clip_box.high[n] = cwi_monotone_curve(
            f->times + at, (const double[2]){boxes[0]->high[n], boxes[1]->high[n]}, 2, time);
    }
}

/* Cameras of two kinds are not blended: the film cuts from one to the other. */
static cw_status blend_cameras(const view_key_frames *f, size_t at, double time,
                               cw_camera *camera, cw_error *err)
{
    cw_camera cameras[4];
    const bool is_perspective = f->keys[at].state.camera.fov_deg > 0;
    size_t first = at, last = at + 1;
    if ((f->keys[last].state.camera.fov_deg > 0) != is_perspective)
        return CW_OK;
    if (first > 0 && (f->keys[first - 1].state.camera.fov_deg > 0) == is_perspective)
        first--;
    if (last + 1 < f->count && (f->keys[last + 1].state.camera.fov_deg > 0) == is_perspective)
        last++;
    for (size_t n = first; n <= last; n++)
        cameras[n - first] = f->keys[n].state.camera;
    return cw_camera_path(cameras, f->times + first, last - first + 1, time, camera, err);
}

cw_status view_show_moment(view *v, const view_key_frames *f, double time, cw_error *err)
{
    size_t at = 0;
    while (at + 2 < f->count && f->times[at + 1] <= time)
        at++;
    const bool is_end = time >= f->times[f->count - 1];
    v->state = f->keys[is_end ? f->count - 1 : at].state;
    cw_status st = CW_OK;
    if (!is_end) {
        blend_options(v, f, at, time, &v->state);
        blend_slices_and_boxes(f, at, time, &v->state);
        st = blend_cameras(f, at, time, &v->state.camera, err);
        const double steps[2] = {(double)f->keys[at].state.step,
                                 (double)f->keys[at + 1].state.step};
        v->state.step = (size_t)lround(cwi_monotone_curve(f->times + at, steps, 2, time));
    }
    if (st == CW_OK && v->document.source.series.count > 1)
        st = view_go_to_step(v, v->state.step, err);
    v->picture.transfer_is_old = true;
    v->picture.is_measured = false;
    view_touch(v, VIEW_ALL);
    return st == CW_OK ? view_choose_mode(v, err) : st;
}

cw_status view_restore(view *v, const view_state *before, cw_error *err)
{
    v->state = *before;
    v->picture.transfer_is_old = true;
    view_touch(v, VIEW_ALL);
    cw_status st =
        v->document.source.series.count > 1 ? view_go_to_step(v, before->step, err) : CW_OK;
    return st == CW_OK ? view_choose_mode(v, err) : st;
}

void view_stop_preview(view *v)
{
    cw_error why = {0};
    if (!v->film.preview)
        return;
    if (view_restore(v, &v->film.preview->before, &why) != CW_OK)
        view_say(v, true, why.message);
    view_drop_preview(v);
}

void view_drop_preview(view *v)
{
    if (!v->film.preview)
        return;
    view_free_key_frames(&v->film.preview->film);
    free(v->film.preview);
    v->film.preview = NULL;
}

cw_status view_run_preview(view *v, cw_error *err)
{
    view_preview *p = v->film.preview;
    if (!p)
        return CW_OK;
    const double time = p->film.times[0] + v->ui->seconds(v->window) - p->start;
    if (time >= p->film.times[p->film.count - 1]) {
        view_stop_preview(v);
        return CW_OK;
    }
    v->film.is_running = true;
    cw_status st = view_show_moment(v, &p->film, time, err);
    v->film.is_running = false;
    return st;
}
