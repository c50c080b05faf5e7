/* Makes films: key frames are moments of a session, and what has numbers changes smoothly
 * between them. */
#define _GNU_SOURCE /* strdup, strndup */
#include "cli/session/view.h"

#include "cli/framework/console.h"
#include "cli/framework/name_template.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/monotone_curve.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_KEYS = 1000, MAX_FRAMES = 1000000 };

typedef struct key {
    double time;
    view_state state;
} key;

typedef struct film {
    key *keys;
    double *times; /* those of the keys */
    size_t count;
} film;

static void free_film(film *f)
{
    free(f->keys);
    free(f->times);
    *f = (film){0};
}

/* --- key frames --------------------------------------------------------------------------- */

/* "2.5 camera right; iso 300": runs the commands and keeps the state they lead to. */
static cw_status add_key(view *v, film *f, const char *line, cw_error *err)
{
    double time;
    if (!cwi_parse_double(&line, &time) || !isfinite(time) || (*line && !strchr(" \t", *line)))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "a time in seconds and commands were expected, such as '2 camera right'");
    if (f->count && !(time > f->keys[f->count - 1].time))
        return cwi_fail(err, CW_ERR_FORMAT, "the time %g is not after the one before, %g", time,
                        f->keys[f->count - 1].time);
    if (f->count == MAX_KEYS)
        return cwi_fail(err, CW_ERR_LIMIT, "a film has %d key frames at most", MAX_KEYS);
    cw_status st = view_exec(v, line, err);
    if (st == CW_OK && !v->state.is_placed)
        st = view_place_camera(v, NULL, err);
    if (st != CW_OK)
        return st;
    f->times[f->count] = time;
    f->keys[f->count++] = (key){time, v->state};
    return CW_OK;
}

static bool is_nothing(const char *line)
{
    const char *c = line + strspn(line, " \t\r");
    return *c == '\0' || *c == '#';
}

static cw_status parse_film(view *v, const char *text, film *f, cw_error *err)
{
    cw_status st = CW_OK;
    f->keys = calloc(MAX_KEYS, sizeof *f->keys);
    f->times = calloc(MAX_KEYS, sizeof *f->times);
    if (!f->keys || !f->times)
        return cwi_fail_memory(err);
    for (size_t number = 1; *text && st == CW_OK; number++) {
        const size_t length = strcspn(text, "\n");
        char *line = strndup(text, length);
        char where[32];
        st = line ? CW_OK : cwi_fail_memory(err);
        if (st == CW_OK && !is_nothing(line))
            st = add_key(v, f, line + strspn(line, " \t"), err);
        snprintf(where, sizeof where, "line %zu", number);
        st = st == CW_OK ? st : cwi_fail_in(err, st, where);
        free(line);
        text += length + (text[length] != '\0');
    }
    if (st == CW_OK && f->count < 2)
        st = cwi_fail(err, CW_ERR_FORMAT, "a film needs at least two key frames");
    return st;
}

/* The bookmarks as a film, one after another. */
static cw_status write_bookmarks(const view *v, char **text, cw_error *err)
{
    size_t size;
    FILE *out = cwi_text_open(text, &size);
    for (size_t n = 0; out && n < v->film.bookmark_count; n++) {
        fprintf(out, "%.9g go-to ", (double)n * v->film.seconds);
        view_put_word(out, v->film.bookmarks[n].name);
        fputc('\n', out);
    }
    return out && cwi_text_close(out, text) ? CW_OK : cwi_fail_memory(err);
}

/* --- moments ------------------------------------------------------------------------------ */

/* Blends the double at an offset of the keys' states, over count keys from the first on. */
static double blend_double(const film *f, size_t first, size_t count, double time,
                           size_t offset)
{
    double values[MAX_KEYS];
    for (size_t n = 0; n < count; n++)
        values[n] = *(const double *)((const char *)&f->keys[first + n].state + offset);
    return cwi_monotone_curve(f->times + first, values, count, time);
}

static const cli_number *number_of(const key *k, size_t offset)
{
    return (const cli_number *)((const char *)&k->state + offset);
}

/* Blends a number of all keys; where some keys lack it, of the two keys around. */
static double blend_number(const film *f, size_t at, double time, size_t offset)
{
    const size_t value = offset + offsetof(cli_number, value);
    bool is_everywhere = true;
    for (size_t n = 0; n < f->count; n++)
        is_everywhere = is_everywhere && number_of(&f->keys[n], offset)->given;
    return is_everywhere ? blend_double(f, 0, f->count, time, value)
                         : blend_double(f, at, 2, time, value);
}

/* Options that are numbers in both keys around. */
static void blend_options(const view *v, const film *f, size_t at, double time, view_state *s)
{
    const key *a = &f->keys[at], *b = a + 1;
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

static void blend_doubles(const film *f, double time, size_t offset, size_t count,
                          view_state *s)
{
    for (size_t n = 0; n < count; n++)
        ((double *)((char *)s + offset))[n] =
            blend_double(f, 0, f->count, time, offset + n * sizeof(double));
}

static void blend_places(const film *f, size_t at, double time, view_state *s)
{
    const view_state *a = &f->keys[at].state, *b = &f->keys[at + 1].state;
    const cli_ranges *boxes[2] = {&a->args.scene.clip_box, &b->args.scene.clip_box};
    blend_doubles(f, time, offsetof(view_state, cross), 3, s);
    blend_doubles(f, time, offsetof(view_state, slice_zoom), 1, s);
    blend_doubles(f, time, offsetof(view_state, share), 1, s);
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
static cw_status blend_cameras(const film *f, size_t at, double time, cw_camera *camera,
                               cw_error *err)
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

/* Sets the session to a moment. Settings without numbers are those of the key before. */
static cw_status show_moment(view *v, const film *f, double time, cw_error *err)
{
    size_t at = 0;
    while (at + 2 < f->count && f->times[at + 1] <= time)
        at++;
    const bool is_end = time >= f->times[f->count - 1];
    v->state = f->keys[is_end ? f->count - 1 : at].state;
    cw_status st = CW_OK;
    if (!is_end) {
        blend_options(v, f, at, time, &v->state);
        blend_places(f, at, time, &v->state);
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

/* --- the film ----------------------------------------------------------------------------- */

static cw_status name_frame(const char *pattern, size_t n, char **path, cw_error *err)
{
    char number[24];
    const char *dot = strrchr(pattern, '.');
    cli_part part = {"frame", number, true, false};
    snprintf(number, sizeof number, "%zu", n);
    if (!dot || strcmp(dot, ".png") != 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s: pictures are written as .png", pattern);
    cw_status st = cli_fill_template(pattern, &part, 1, path, err);
    if (st == CW_OK && !part.used) {
        free(*path);
        *path = NULL;
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "film '%s': the name must hold {frame}, as in 'film-{frame:04d}.png'",
                        pattern);
    }
    return st;
}

static cw_status write_frames(view *v, const film *f, const char *pattern, double fps,
                              cw_error *err)
{
    const double start = f->times[0], length = f->times[f->count - 1] - start;
    if (!(length * fps < MAX_FRAMES))
        return cwi_fail(err, CW_ERR_LIMIT, "the film has %.3g frames; %d at most", length * fps,
                        MAX_FRAMES);
    const size_t count = (size_t)floor(length * fps + 1e-9) + 1;
    const cw_progress progress = cli_progress((double)count, "frame");
    cw_status st = CW_OK;
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        char *path = NULL;
        st = name_frame(pattern, n, &path, err);
        if (st == CW_OK)
            st = show_moment(v, f, start + (double)n / fps, err);
        if (st == CW_OK)
            st = view_write_picture(v, &(view_sheet){0}, path, err);
        free(path);
        if (st == CW_OK && progress.report &&
            !progress.report(progress.user, "film", (double)(n + 1) / (double)count))
            st = cwi_fail(err, CW_ERR_CANCELLED, "the film was cancelled after %zu frames",
                          n + 1);
    }
    return st;
}

/* Parses a film, with the session as it is afterwards. */
static cw_status make_keys(view *v, const char *name, film *f, cw_error *err)
{
    const bool of_bookmarks = strcmp(name, "bookmarks") == 0;
    char *text = NULL;
    v->film.is_running = true;
    cw_status st =
        of_bookmarks ? write_bookmarks(v, &text, err) : view_read_text(name, &text, err);
    if (st == CW_OK) {
        st = parse_film(v, text, f, err);
        st = st == CW_OK ? st : cwi_fail_in(err, st, of_bookmarks ? "the bookmarks" : name);
    }
    v->film.is_running = false;
    free(text);
    return st;
}

/* Brings the session back to what it was before a film. */
static cw_status restore_session(view *v, const view_state *before, cw_error *err)
{
    v->state = *before;
    v->picture.transfer_is_old = true;
    view_touch(v, VIEW_ALL);
    cw_status st =
        v->document.source.series.count > 1 ? view_go_to_step(v, before->step, err) : CW_OK;
    return st == CW_OK ? view_choose_mode(v, err) : st;
}

cw_status view_make_film(view *v, const char *name, const char *pattern, double fps,
                         cw_error *err)
{
    film f = {0};
    cw_error why = {0};
    if (!v->document.path)
        return cwi_fail(err, CW_ERR_ARGUMENT, "no file is open to make a film of");
    view_state *before = malloc(sizeof *before);
    if (!before)
        return cwi_fail_memory(err);
    *before = v->state;
    cw_status st = make_keys(v, name, &f, err);
    v->film.is_running = true;
    if (st == CW_OK)
        st = write_frames(v, &f, pattern, fps, err);
    v->film.is_running = false;
    const cw_status back = restore_session(v, before, &why);
    free(before);
    free_film(&f);
    return st == CW_OK && back != CW_OK ? cwi_fail(err, back, "%s", why.message) : st;
}

/* --- in the window ------------------------------------------------------------------------ */

struct view_preview {
    film film;
    view_state before;
    double start; /* in ui seconds */
};

cw_status view_start_preview(view *v, cw_error *err)
{
    if (!v->document.path)
        return cwi_fail(err, CW_ERR_ARGUMENT, "no file is open to make a film of");
    view_preview *p = calloc(1, sizeof *p);
    if (!p)
        return cwi_fail_memory(err);
    p->before = v->state;
    cw_status st = make_keys(v, "bookmarks", &p->film, err);
    p->start = v->ui->seconds(v->window);
    v->film.preview = p;
    if (st != CW_OK)
        view_stop_preview(v);
    return st;
}

void view_stop_preview(view *v)
{
    cw_error why = {0};
    if (!v->film.preview)
        return;
    if (restore_session(v, &v->film.preview->before, &why) != CW_OK)
        view_say(v, true, why.message);
    view_drop_preview(v);
}

void view_drop_preview(view *v)
{
    if (!v->film.preview)
        return;
    free_film(&v->film.preview->film);
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
    cw_status st = show_moment(v, &p->film, time, err);
    v->film.is_running = false;
    return st;
}
