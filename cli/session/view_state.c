/* Writes a session as a script or as a command line. */
#include "cli/framework/console.h"
#include "cli/session/view.h"
#include "cli/session/view_measure.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/files/atomic_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_default(const view *v, const cli_option *o)
{
    return memcmp((const char *)&v->state.args + o->offset,
                  (const char *)v->command->defaults + o->offset, o->kind->size) == 0;
}

static void put_setting(FILE *out, bool shell, const char *name, const char *value)
{
    fprintf(out, shell ? " --%s%s" : "%s%s", name, value ? " " : "");
    if (value)
        cli_put_word(out, value);
    if (!shell)
        fputc('\n', out);
}

/* Returns true for options that other commands state: camera and transfer function. */
static bool is_overridden(const view_state *s, const char *name)
{
    static const char *const of_camera[] = {"camera", "ortho", "fov", "zoom"};
    for (size_t n = 0; n < sizeof of_camera / sizeof *of_camera; n++)
        if (s->is_placed && strcmp(name, of_camera[n]) == 0)
            return true;
    return s->is_edited && strcmp(name, "tf") == 0;
}

static void put_option(const view *v, FILE *out, bool shell, const cli_option *o)
{
    char text[1024];
    const render_args *args = &v->state.args;
    const bool flag = o->kind == CLI_FLAG;
    const bool off = flag && !*((const bool *)((const char *)args + o->offset));
    snprintf(text, sizeof text, "no-%s", o->name);
    if (flag && shell)
        put_setting(out, shell, off ? text : o->name, NULL);
    else if (flag)
        put_setting(out, shell, o->name, off ? "off" : "on");
    else if (cli_option_text(o, args, text, sizeof text))
        put_setting(out, shell, o->name, text);
}

/* Writes the options of reading, which come before a file is opened, or the others. */
static void put_options(const view *v, FILE *out, bool shell, bool of_reading)
{
    bool is_reading = false;
    for (size_t n = 0; n < v->command->option_count; n++) {
        const cli_option *o = &v->command->options[n];
        if (o->kind == CLI_HEADING)
            is_reading = strcmp(o->name, CLI_READING) == 0 || strcmp(o->name, CLI_LIMITS) == 0;
        else if (is_reading == of_reading && view_find_option(v, o->name) &&
                 !is_default(v, o) && !is_overridden(&v->state, o->name))
            put_option(v, out, shell, o);
    }
}

static void put_settings(const view *v, FILE *out, bool shell)
{
    char text[CW_TRANSFER_TEXT];
    const view_state *s = &v->state;
    put_options(v, out, shell, false);
    if (s->is_edited && cw_transfer_format(&s->curve, text, NULL) == CW_OK) {
        view_join_lines(text);
        put_setting(out, shell, "tf", text);
    }
    char *words = s->is_placed && shell ? cli_write_camera(&s->camera) : NULL;
    if (words) {
        put_setting(out, shell, "camera", words);
        free(words);
    } else if (s->is_placed && cw_camera_format(&s->camera, text, NULL) == CW_OK) {
        view_join_lines(text);
        put_setting(out, shell, "camera", text);
    }
}

static bool is_in_middle(const view *v)
{
    for (int a = 0; a < 3; a++)
        if (v->state.cross[a] != 0.5 * (v->document.box[0][a] + v->document.box[1][a]))
            return false;
    return true;
}

/* Writes the parts of the state that are no options. */
static void put_rest(const view *v, FILE *out, const char *end)
{
    const view_state *s = &v->state;
    if (s->step)
        fprintf(out, "step %zu%s", s->step, end);
    if (!is_in_middle(v))
        fprintf(out, "cross %.9g %.9g %.9g%s", s->cross[0], s->cross[1], s->cross[2], end);
    if (s->window[0] != 0 || s->window[1] != 0)
        fprintf(out, "window %.9g %.9g%s", s->window[0], s->window[1], end);
    if (s->slice_zoom != 1)
        fprintf(out, "zoom-slices %.9g%s", s->slice_zoom, end);
    if (s->args.compare)
        fprintf(out, "split %.6g%s", s->left_fraction, end);
    view_put_measures(v, out, end);
    if (v->document.pieces.are_shown)
        fprintf(out, "pieces %s%s", v->document.pieces.settings, end);
}

static void put_files(const view *v, FILE *out)
{
    for (size_t n = 0; n < v->document.file_count; n++) {
        fputc(' ', out);
        cli_put_word(out, v->document.files[n]);
    }
}

cw_status view_write_state(const view *v, const char *path, cw_error *err)
{
    char *text;
    size_t size;
    FILE *out = cwi_text_open(&text, &size);
    if (!out)
        return cwi_fail_memory(err);
    fputs("# cubewright view: a state; 'cubewright view --run' this file\n", out);
    put_options(v, out, false, true);
    if (v->document.path) {
        fputs("open", out);
        put_files(v, out);
        fputc('\n', out);
    }
    put_settings(v, out, false);
    put_rest(v, out, "\n");
    view_put_bookmarks(v, out, "\n");
    if (!cwi_text_close(out, &text))
        return cwi_fail_memory(err);
    cw_status st = cwi_outfile_save(path, text, size, err);
    free(text);
    return st;
}

char *view_command_line(const view *v)
{
    char *text, *rest;
    size_t size, rest_size;
    FILE *out = cwi_text_open(&text, &size);
    if (!out)
        return NULL;
    fputs("cubewright view", out);
    put_files(v, out);
    put_options(v, out, true, true);
    put_settings(v, out, true);
    FILE *commands = cwi_text_open(&rest, &rest_size);
    if (commands)
        put_rest(v, commands, "; ");
    if (commands && cwi_text_close(commands, &rest)) {
        if (*rest)
            fprintf(out, " --exec '%s'", rest);
        free(rest);
    }
    return cwi_text_close(out, &text) ? text : NULL;
}
