/* Commands that move the camera, keep views of the scene by name, and make films of them. */
#define _GNU_SOURCE /* strdup */
#include "cli/framework/console.h"
#include "cli/session/verbs.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/files/atomic_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static cw_status run_orbit(view *v, int count, char **args, cw_error *err)
{
    double n[2] = {0};
    cw_status st = view_take("orbit", args, count, n, err);
    if (st == CW_OK)
        st = view_need_camera(v, err);
    return st == CW_OK ? cw_camera_orbit(&v->state.camera, n[0], n[1], err) : st;
}

static cw_status run_pan(view *v, int count, char **args, cw_error *err)
{
    double n[2];
    cw_status st = view_take("pan", args, count, n, err);
    if (st == CW_OK)
        st = view_need_camera(v, err);
    const size_t height = (size_t)fmax(1, v->picture.parts[VIEW_SPACE].rect.height);
    return st == CW_OK ? cw_camera_pan(&v->state.camera, height, n[0], n[1], err) : st;
}

static cw_status run_dolly(view *v, int count, char **args, cw_error *err)
{
    double n;
    cw_status st = view_take("dolly", args, count, &n, err);
    if (st == CW_OK)
        st = view_need_camera(v, err);
    return st == CW_OK ? cw_camera_dolly(&v->state.camera, n, err) : st;
}

static cw_status run_roll(view *v, int count, char **args, cw_error *err)
{
    double n;
    cw_status st = view_take("roll", args, count, &n, err);
    if (st == CW_OK)
        st = view_need_camera(v, err);
    return st == CW_OK ? cw_camera_roll(&v->state.camera, n, err) : st;
}

static cw_status run_reset(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    v->state.slice_zoom = 1;
    view_touch(v, VIEW_ALL);
    cw_status st = view_set(v, "zoom", "default", err);
    return st == CW_OK ? view_set(v, "camera", "default", err) : st;
}

/* Commands that go back and forth through the views seen before. */

static cw_status go_to_camera(view *v, int by, cw_error *err)
{
    view_cameras *c = &v->cameras;
    cw_status st = view_need_camera(v, err);
    if (st != CW_OK)
        return st;
    const bool is_there = by < 0 ? c->at > 0 : c->at + 1 < c->count;
    if (!is_there && v->script.is_queued) {
        view_say(v, false, by < 0 ? "no earlier view" : "no later view");
        return CW_OK;
    }
    if (!is_there)
        return cwi_fail(err, CW_ERR_ARGUMENT, by < 0 ? "no earlier view" : "no later view");
    c->at = by < 0 ? c->at - 1 : c->at + 1;
    v->state.camera = c->cameras[c->at];
    view_touch(v, 1 << VIEW_SPACE);
    return CW_OK;
}

static cw_status run_camera_back(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    return go_to_camera(v, -1, err);
}

static cw_status run_camera_forward(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    return go_to_camera(v, 1, err);
}

/* Commands that keep views by name. */

static size_t find_bookmark(const view *v, const char *name)
{
    size_t n = 0;
    while (n < v->film.bookmark_count && strcmp(v->film.bookmarks[n].name, name) != 0)
        n++;
    return n;
}

/* Describes level, cut, opacity and mode as commands. */
static void describe_look(const view *v, char *text, size_t size)
{
    static const char *const names[] = {"iso", "mode", "clip-box", "opacity", "shift"};
    size_t used = 0;
    text[0] = '\0';
    for (size_t n = 0; n < sizeof names / sizeof *names && used < size; n++) {
        char value[256];
        const cli_option *o = view_find_option(v, names[n]);
        const bool is_level = n == 0;
        const bool is_set = o && cli_option_text(o, &v->state.args, value, sizeof value) &&
                            !(is_level && v->state.iso_is_ours);
        if (!is_level || !v->document.source.is_mesh)
            used += (size_t)snprintf(text + used, size - used, "%s%s %s", used ? "; " : "",
                                     names[n], is_set ? value : "default");
    }
}

static cw_status run_bookmark(view *v, int count, char **args, cw_error *err)
{
    view_bookmark b = {0};
    if (count)
        snprintf(b.name, sizeof b.name, "%s", args[0]);
    for (size_t n = v->film.bookmark_count + 1; !count; n++) { /* the first name that is free */
        snprintf(b.name, sizeof b.name, "view %zu", n);
        if (find_bookmark(v, b.name) == v->film.bookmark_count)
            break;
    }
    if (!*b.name || (count && strlen(args[0]) >= sizeof b.name))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "bookmark '%s': a name of 1 to %zu bytes was "
                        "expected",
                        args[0], sizeof b.name - 1);
    cw_status st =
        count > 1 ? cw_camera_parse(args[1], &b.camera, err) : view_need_camera(v, err);
    if (st != CW_OK)
        return st;
    if (count > 2)
        snprintf(b.look, sizeof b.look, "%s", args[2]);
    else if (count < 2)
        describe_look(v, b.look, sizeof b.look);
    if (count < 2)
        b.camera = v->state.camera;
    const size_t at = find_bookmark(v, b.name);
    if (at == VIEW_BOOKMARKS)
        return cwi_fail(err, CW_ERR_LIMIT, "bookmark '%s': there are %d already", b.name,
                        VIEW_BOOKMARKS);
    v->film.bookmarks[at] = b;
    v->film.bookmark_count += at == v->film.bookmark_count;
    return CW_OK;
}

static cw_status need_bookmark(const view *v, const char *verb, const char *name, size_t *at,
                               cw_error *err)
{
    *at = find_bookmark(v, name);
    return *at < v->film.bookmark_count
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT, "%s '%s': no bookmark has that name", verb,
                          name);
}

static cw_status run_go_to(view *v, int count, char **args, cw_error *err)
{
    size_t n;
    (void)count;
    cw_status st = need_bookmark(v, "go-to", args[0], &n, err);
    if (st == CW_OK)
        st = view_need_camera(v, err);
    if (st == CW_OK)
        st = view_exec(v, v->film.bookmarks[n].look, err);
    if (st != CW_OK)
        return st;
    v->state.camera = v->film.bookmarks[n].camera;
    view_touch(v, 1 << VIEW_SPACE);
    return CW_OK;
}

static cw_status run_remove_bookmark(view *v, int count, char **args, cw_error *err)
{
    size_t n;
    (void)count;
    cw_status st = need_bookmark(v, "remove-bookmark", args[0], &n, err);
    if (st != CW_OK)
        return st;
    memmove(v->film.bookmarks + n, v->film.bookmarks + n + 1,
            (--v->film.bookmark_count - n) * sizeof *v->film.bookmarks);
    return CW_OK;
}

void view_put_bookmarks(const view *v, FILE *out, const char *end)
{
    char text[CW_CAMERA_TEXT];
    for (size_t n = 0; n < v->film.bookmark_count; n++) {
        const view_bookmark *b = &v->film.bookmarks[n];
        if (cw_camera_format(&b->camera, text, NULL) != CW_OK)
            continue;
        view_join_lines(text);
        fputs("bookmark ", out);
        cli_put_word(out, b->name);
        fputc(' ', out);
        cli_put_word(out, text);
        fputc(' ', out);
        cli_put_word(out, b->look);
        fputs(end, out);
    }
}

/* Commands that make films. */

static cw_status run_film(view *v, int count, char **args, cw_error *err)
{
    double fps = 25;
    cw_status st = count > 2 ? view_take("film", args + 2, 1, &fps, err) : CW_OK;
    if (st == CW_OK && !(fps > 0 && fps <= 1000))
        st = cwi_fail(err, CW_ERR_ARGUMENT,
                      "film: %g frames a second; above 0, up to 1000, "
                      "was expected",
                      fps);
    if (st == CW_OK)
        st = view_frame(v, 0, err); /* lays out what came before */
    return st == CW_OK ? view_make_film(v, args[0], args[1], fps, err) : st;
}

/* Writes the bookmarks as a film that can be edited. */
static cw_status run_save_film(view *v, int count, char **args, cw_error *err)
{
    char *text, camera[CW_CAMERA_TEXT];
    size_t size;
    (void)count;
    if (v->film.bookmark_count < 2)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a film needs at least two bookmarks");
    FILE *out = cwi_text_open(&text, &size);
    if (!out)
        return cwi_fail_memory(err);
    fputs("# cubewright view: a film; seconds, and the commands of that moment\n", out);
    for (size_t n = 0; n < v->film.bookmark_count; n++) {
        const view_bookmark *b = &v->film.bookmarks[n];
        if (cw_camera_format(&b->camera, camera, NULL) != CW_OK)
            continue;
        view_join_lines(camera);
        fprintf(out, "%.6g camera ", (double)n * v->film.seconds);
        cli_put_word(out, camera);
        fprintf(out, "%s%s\n", *b->look ? "; " : "", b->look);
    }
    if (!cwi_text_close(out, &text))
        return cwi_fail_memory(err);
    cw_status st = cwi_outfile_save(args[0], text, size, err);
    free(text);
    if (st == CW_OK)
        view_say(v, false, args[0]);
    return st;
}

static cw_status run_play_film(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    if (!v->film.preview)
        return view_start_preview(v, err);
    view_stop_preview(v);
    return CW_OK;
}

static cw_status run_film_seconds(view *v, int count, char **args, cw_error *err)
{
    double seconds;
    (void)count;
    cw_status st = view_take("film-seconds", args, 1, &seconds, err);
    if (st == CW_OK && !(seconds >= 0.01 && seconds <= 3600))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "film-seconds %s: 0.01 to 3600 was expected",
                      args[0]);
    if (st == CW_OK)
        v->film.seconds = seconds;
    return st;
}

static const view_verb rows[] = {
    VERB("orbit", "RIGHT [UP]", "Orbit the camera, in degrees", 1, 2, run_orbit),
    VERB("pan", "RIGHT DOWN", "Move the picture, in pixels", 2, 2, run_pan),
    VERB("dolly", "F", "Move the camera nearer, to magnify the scene by this factor", 1, 1,
         run_dolly),
    VERB("roll", "DEG", "Rotate the picture clockwise", 1, 1, run_roll),
    VERB("reset", "", "Show the whole scene again", 0, 0, run_reset),
    VERB("camera-back", "", "Go back to the view before the last movement", 0, 0,
         run_camera_back),
    VERB("camera-forward", "", "Go forward again", 0, 0, run_camera_forward),
    VERB("bookmark", "[NAME [CAMERA [COMMANDS]]]",
         "Keep the view, with isovalue, cut and opacity, under a name", 0, 3, run_bookmark),
    EDIT("go-to", "NAME", "Go to a bookmark", 1, 1, run_go_to),
    VERB("remove-bookmark", "NAME", "Forget a bookmark", 1, 1, run_remove_bookmark),
    VERB("film", "FILE|bookmarks OUT [FPS]",
         "Save a film as pictures: OUT holds {frame}, as in 'film-{frame:04d}.png'", 2, 3,
         run_film),
    VERB("play-film", "", "Play the bookmarks as a film, or stop", 0, 0, run_play_film),
    VERB("film-seconds", "S", "Set the time from bookmark to bookmark in films", 1, 1,
         run_film_seconds),
    VERB("save-film", "FILE", "Write the bookmarks as a film that can be edited", 1, 1,
         run_save_film),
};
const view_verbs view_camera_verbs = {rows, sizeof rows / sizeof *rows};
