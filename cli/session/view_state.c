/* Changes settings by name, undoes changes, and writes a session as a script or as a command
 * line. */
#define _GNU_SOURCE /* strdup */
#include "cli/session/view.h"
#include "cli/session/view_measure.h"

#include "cli/framework/option_rules.h"
#include "cli/inputs/level_choice.h"
#include "cli/render/compare_options.h"
#include "core/base/atomic_file.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *view_keep_text(view *v, const char *text)
{
    for (size_t n = 0; n < v->script.word_count; n++)
        if (strcmp(v->script.words[n], text) == 0)
            return v->script.words[n];
    char **words = realloc(v->script.words, (v->script.word_count + 1) * sizeof *words);
    if (!words)
        return NULL;
    v->script.words = words;
    words[v->script.word_count] = strdup(text);
    return words[v->script.word_count] ? words[v->script.word_count++] : NULL;
}

/* Changes of one kind in one go, such as a slider's, are undone in one go; so are all of a
 * drag. */
void view_remember(view *v, const char *verb)
{
    view_history *h = &v->history;
    const bool goes_on = h->count && h->gesture == v->input.gesture &&
                         (strcmp(h->verb, verb) == 0 || (h->is_drag && v->input.is_dragging));
    if (!goes_on && h->count) {
        if (h->at + 1 == VIEW_UNDO)
            memmove(h->states, h->states + 1, --h->at * sizeof *h->states);
        h->at++;
    }
    h->states[h->at] = v->state;
    h->count = h->at + 1;
    h->gesture = v->input.gesture;
    h->is_drag = v->input.is_dragging;
    snprintf(h->verb, sizeof h->verb, "%s", verb);
}

/* It is not moving about that is undone: the camera, the cross-hair, the step and such stay. */
bool view_undo(view *v, int by)
{
    view_history *h = &v->history;
    if (by < 0 ? h->at == 0 : h->at + 1 >= h->count)
        return false;
    h->at = by < 0 ? h->at - 1 : h->at + 1;
    view_state now = v->state;
    v->state = h->states[h->at];
    v->state.is_placed = now.is_placed;
    v->state.camera = now.camera;
    v->state.step = now.step;
    v->state.slice_zoom = now.slice_zoom;
    v->state.share = now.share;
    memcpy(v->state.cross, now.cross, sizeof now.cross);
    h->verb[0] = '\0';
    return true;
}

/* Movements of one kind in one go are one view, as for view_remember(). */
void view_note_camera(view *v, const char *verb)
{
    view_cameras *c = &v->cameras;
    if (!v->state.is_placed ||
        (c->count && memcmp(&c->cameras[c->at], &v->state.camera, sizeof(cw_camera)) == 0))
        return;
    const bool goes_on =
        c->count && c->at && c->gesture == v->input.gesture && strcmp(c->verb, verb) == 0;
    if (!goes_on && c->count) {
        if (c->at + 1 == VIEW_UNDO)
            memmove(c->cameras, c->cameras + 1, --c->at * sizeof *c->cameras);
        c->at++;
    }
    c->cameras[c->at] = v->state.camera;
    c->count = c->at + 1;
    c->gesture = v->input.gesture;
    snprintf(c->verb, sizeof c->verb, "%s", verb);
}

const cli_option *view_find_option(const view *v, const char *name)
{
    static const char *const fixed[] = {
        "exec",    "run",        "config",  "hidden",     "output",
        "memory",  "max-voxels", "timeout", "no-sandbox", "allow-external",
        "threads", "size",       "steps",   "step",       "recent"};
    for (size_t n = 0; n < sizeof fixed / sizeof *fixed; n++)
        if (strcmp(fixed[n], name) == 0)
            return NULL;
    for (size_t n = 0; n < v->command->option_count; n++) {
        const cli_option *o = &v->command->options[n];
        if (o->kind != CLI_HEADING && strcmp(o->name, name) == 0)
            return o;
    }
    return NULL;
}

static bool is_default(const view *v, const cli_option *o)
{
    return memcmp((const char *)&v->state.args + o->offset,
                  (const char *)v->command->defaults + o->offset, o->kind->size) == 0;
}

/* An option as on the command line; "off" and "none" take back what was set. */
static cw_status parse_setting(view *v, const cli_option *o, const char *value, cw_error *err)
{
    char *words[1];
    const char *inputs[2] = {0};
    cli_command bare = *v->command;
    render_args *args = &v->state.args;
    const bool flag = o->kind == CLI_FLAG;
    const bool off = value && (strcmp(value, "off") == 0 || strcmp(value, "default") == 0);
    bare.min_inputs = 0;
    if (off && !flag) {
        memcpy((char *)args + o->offset, (const char *)v->command->defaults + o->offset,
               o->kind->size);
        args->common.given[o - v->command->options] = false;
        return CW_OK;
    }
    if (flag && value && !off && strcmp(value, "on") != 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s '%s': on or off was expected", o->name,
                        value);
    if (!flag && !value)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s needs a value: %s", o->name,
                        o->value ? o->value : "a text");
    char *word = malloc(strlen(o->name) + (value ? strlen(value) : 0) + 8);
    if (!word)
        return cwi_fail_memory(err);
    if (flag)
        sprintf(word, off ? "--no-%s" : "--%s", o->name);
    else
        sprintf(word, "--%s=%s", o->name, value);
    words[0] = (char *)view_keep_text(v, word);
    free(word);
    if (!words[0])
        return cwi_fail_memory(err);
    const size_t count = args->common.input_count;
    const char **before = args->common.inputs;
    args->common.input_count = 0;
    cw_status st = cli_parse(&bare, 1, words, args, inputs, err);
    args->common.inputs = before;
    args->common.input_count = count;
    return st;
}

/* Applies the effects of a setting on other parts of the state. */
static cw_status follow_name(view *v, const char *name, cw_error *err)
{
    view_state *s = &v->state;
    if (strcmp(name, "tf") == 0)
        s->is_edited = false;
    if (strcmp(name, "camera") == 0 || strcmp(name, "ortho") == 0 || strcmp(name, "fov") == 0)
        s->is_placed = false;
    if (strcmp(name, "iso") == 0)
        s->iso_is_ours = false;
    if (strcmp(name, "layout") == 0) /* as at the start */
        v->shown.cross = s->args.marks.layout == CLI_LAYOUT_QUAD;
    if (strcmp(name, "iso") == 0 && !s->args.iso.given &&
        s->args.scene.mode == 1 + CW_MODE_MESH && v->document.has_volume)
        s->args.scene.mode = 0;
    if (strcmp(name, "labels") == 0 && s->args.look.labels &&
        !s->args.overlay) { /* they are drawn by themselves */
        s->args.iso = (cli_number){0};
        if (s->args.scene.mode != 1 + CW_MODE_SLICES)
            s->args.scene.mode = 0;
    }
    if (strcmp(name, "iso") == 0 && s->args.iso.given && !s->args.overlay)
        s->args.look.labels = NULL;
    if (strcmp(name, "iso") == 0 && v->document.path &&
        !v->document.source.is_mesh) { /* it may be a name */
        cw_status found =
            cli_choose_level(&v->document.source.volume, &s->args.input, &s->args.iso, err);
        if (found != CW_OK)
            return found;
    }
    v->picture.transfer_is_old = true;
    v->picture.is_measured = false;
    const bool had_labels = v->document.labels.look.labels;
    cw_status st = view_choose_mode(v, err);
    view_touch(v, had_labels || v->document.labels.look.labels || s->args.marks.isolines ||
                          strcmp(name, "isolines") == 0
                      ? VIEW_ALL
                      : 1 << VIEW_SPACE);
    return st == CW_OK ? view_need_labels(v, err) : st;
}

/* Parses --compare of a session. Settings for other modes stay set in a session; only the
 * settings of a side must have an effect. */
cw_status view_parse_split(const view *v, cli_split *split, cw_error *err)
{
    render_args args = v->state.args;
    memset(args.common.given, 0, sizeof args.common.given);
    return cli_parse_split(v->command, &args, split, err);
}

/* Draws nothing yet: only whether it could be. */
static cw_status try_scene(view *v, cw_error *err)
{
    static const cli_turns one = {0};
    const render_args *args = &v->state.args;
    uint8_t background[2][4];
    cw_scene scene = {.width = 64, .height = 64, .camera = v->state.camera};
    const cli_subject subject = {.volume = view_draws_volume(v) ? cli_drawn(&v->document.source)
                                                                : NULL,
                                 .whole = v->document.source.is_mesh || !v->document.path
                                              ? NULL
                                              : &v->document.source.volume.whole};
    cli_split split = {0};
    if (args->samples > 4)
        return cwi_fail(err, CW_ERR_ARGUMENT, "samples %zu: expected 1 to 4", args->samples);
    if (args->difference.given && !(args->difference.value > 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "difference %g: above 0 was expected",
                        args->difference.value);
    cw_status st = cli_check_camera(&args->scene, &one, err);
    if (st == CW_OK)
        st = cli_background(&args->scene, background, err);
    if (st == CW_OK && v->document.path)
        st = view_need_transfer(v, err);
    if (st == CW_OK && v->document.path)
        st = cli_check_rules(v->command, args, err);
    if (st == CW_OK && v->document.path && (v->state.is_placed || !subject.volume))
        st = cli_make_scene(&args->scene, &subject, v->picture.mode, &v->picture.transfer,
                            &scene, err);
    if (st == CW_OK && args->compare) {
        st = view_parse_split(v, &split, err);
        cli_free_split(&split);
    }
    return st;
}

cw_status view_set(view *v, const char *name, const char *value, cw_error *err)
{
    const cli_option *o = view_find_option(v, name);
    const view_state before = v->state;
    const cw_mode mode = v->picture.mode;
    if (!o)
        return cwi_fail(err, CW_ERR_ARGUMENT, "'%s' is not a setting", name);
    if (v->script.is_configuring && v->state.args.common.given[o - v->command->options])
        return CW_OK; /* the command line takes precedence */
    cw_status st = parse_setting(v, o, value, err);
    if (st == CW_OK)
        st = follow_name(v, name, err);
    if (st == CW_OK)
        st = try_scene(v, err);
    if (st == CW_OK)
        return CW_OK;
    v->state = before;
    v->picture.mode = mode;
    v->picture.transfer_is_old = true;
    return st;
}

/* In quotes where a shell, or a script of ours, would part or read it otherwise. */
void view_put_word(FILE *out, const char *word)
{
    if (*word && strspn(word, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                              "-_=+:,./@%") == strlen(word)) {
        fputs(word, out);
        return;
    }
    fputc('\'', out);
    for (const char *c = word; *c; c++)
        if (*c == '\'')
            fputs("'\\''", out);
        else
            fputc(*c, out);
    fputc('\'', out);
}

/* JSON has its lines for people; here it is one word of one line. */
void view_join_lines(char *text)
{
    for (size_t n = strlen(text); n > 0 && text[n - 1] == '\n'; n--)
        text[n - 1] = '\0';
    for (char *c = text; *c; c++)
        *c = *c == '\n' ? ' ' : *c;
}

static void put_setting(FILE *out, bool shell, const char *name, const char *value)
{
    fprintf(out, shell ? " --%s%s" : "%s%s", name, value ? " " : "");
    if (value)
        view_put_word(out, value);
    if (!shell)
        fputc('\n', out);
}

/* Whether something else says it: the camera and the transfer function as they are now. */
static bool is_outdone(const view_state *s, const char *name)
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

/* Those of reading, which have to be said before a file is opened, or the others. */
static void put_options(const view *v, FILE *out, bool shell, bool of_reading)
{
    bool is_reading = false;
    for (size_t n = 0; n < v->command->option_count; n++) {
        const cli_option *o = &v->command->options[n];
        if (o->kind == CLI_HEADING)
            is_reading = strcmp(o->name, CLI_READING) == 0 || strcmp(o->name, CLI_LIMITS) == 0;
        else if (is_reading == of_reading && view_find_option(v, o->name) &&
                 !is_default(v, o) && !is_outdone(&v->state, o->name))
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
        fprintf(out, "split %.6g%s", s->share, end);
    view_put_measures(v, out, end);
}

static void put_files(const view *v, FILE *out)
{
    for (size_t n = 0; n < v->document.file_count; n++) {
        fputc(' ', out);
        view_put_word(out, v->document.files[n]);
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
