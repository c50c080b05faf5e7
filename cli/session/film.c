/* Makes films: key frames are moments of a session that commands lead to. */
#define _GNU_SOURCE /* strdup, strndup */
#include "cli/session/film.h"

#include "cli/framework/console.h"
#include "cli/framework/name_template.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_FRAMES = 1000000 };

/* --- key frames --------------------------------------------------------------------------- */

/* Reads a line such as "2.5 camera right; iso 300": runs the commands, keeps their state. */
static cw_status add_key(view *v, view_key_frames *f, const char *line, cw_error *err)
{
    double time;
    if (!cwi_parse_double(&line, &time) || !isfinite(time) || (*line && !strchr(" \t", *line)))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "a time in seconds and commands were expected, such as '2 camera right'");
    if (f->count && !(time > f->keys[f->count - 1].time))
        return cwi_fail(err, CW_ERR_FORMAT, "the time %g is not after the one before, %g", time,
                        f->keys[f->count - 1].time);
    if (f->count == VIEW_KEY_FRAMES)
        return cwi_fail(err, CW_ERR_LIMIT, "a film has %d key frames at most", VIEW_KEY_FRAMES);
    cw_status st = view_exec(v, line, err);
    if (st == CW_OK && !v->state.is_placed)
        st = view_place_camera(v, NULL, err);
    if (st != CW_OK)
        return st;
    f->times[f->count] = time;
    f->keys[f->count++] = (view_key_frame){time, v->state};
    return CW_OK;
}

static bool is_nothing(const char *line)
{
    const char *c = line + strspn(line, " \t\r");
    return *c == '\0' || *c == '#';
}

static cw_status parse_film(view *v, const char *text, view_key_frames *f, cw_error *err)
{
    cw_status st = CW_OK;
    f->keys = calloc(VIEW_KEY_FRAMES, sizeof *f->keys);
    f->times = calloc(VIEW_KEY_FRAMES, sizeof *f->times);
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

/* Makes a film of the bookmarks, one after another. */
static cw_status write_bookmarks(const view *v, char **text, cw_error *err)
{
    size_t size;
    FILE *out = cwi_text_open(text, &size);
    for (size_t n = 0; out && n < v->film.bookmark_count; n++) {
        fprintf(out, "%.9g go-to ", (double)n * v->film.seconds);
        cli_put_word(out, v->film.bookmarks[n].name);
        fputc('\n', out);
    }
    return out && cwi_text_close(out, text) ? CW_OK : cwi_fail_memory(err);
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

static cw_status write_frames(view *v, const view_key_frames *f, const char *pattern,
                              double fps, cw_error *err)
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
            st = view_show_moment(v, f, start + (double)n / fps, err);
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

/* Parses a film. The session then has the state of the last key frame. */
static cw_status make_keys(view *v, const char *name, view_key_frames *f, cw_error *err)
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

cw_status view_make_film(view *v, const char *name, const char *pattern, double fps,
                         cw_error *err)
{
    view_key_frames f = {0};
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
    const cw_status back = view_restore(v, before, &why);
    free(before);
    view_free_key_frames(&f);
    return st == CW_OK && back != CW_OK ? cwi_fail(err, back, "%s", why.message) : st;
}

/* --- in the window ------------------------------------------------------------------------ */

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
