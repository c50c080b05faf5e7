/* The command view: its options, and the window or script that it runs from the first file
 * to the end of the session. */
#define _GNU_SOURCE /* open_memstream */
#include "cli/framework/commands.h"
#include "cli/framework/console.h"
#include "cli/window/panels.h"
#include "core/base/memory.h"
#include "core/base/module.h"
#include "core/base/status.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const render_args defaults = {.scene = CLI_SCENE_DEFAULTS,
                                     .size = {.count = 2, .n = {1280, 800, 0}}};

static const cli_option options[] = {
    {"exec", 'e', CLI_TEXT, "COMMANDS",
     "Commands to run first, such as 'mode mip; orbit 30; screenshot a.png'",
     offsetof(render_args, exec)},
    {"run", 0, CLI_TEXT, "FILE", "File of commands to run first, such as a saved session",
     offsetof(render_args, run), CLI_VALUES_FILE},
    {"config", 0, CLI_TEXT, "FILE|none",
     "File of default settings (~/.config/cubewright/view; with --hidden none)",
     offsetof(render_args, config), CLI_VALUES_FILE},
    {"recent", 0, CLI_TEXT, "FILE|none",
     "File with the list of recent files (~/.local/state/cubewright/recent; with --hidden none)",
     offsetof(render_args, recent), CLI_VALUES_FILE},
    {"light-theme", 0, CLI_FLAG, NULL, "Show light panels (off: dark ones)",
     offsetof(render_args, light_theme)},
    {"hidden", 0, CLI_FLAG, NULL, "Run the commands and end, without window and display (off)",
     offsetof(render_args, hidden)},
    {"output", 'o', CLI_TEXT, "FILE",
     "Run as --hidden, and write the last picture as a .png file",
     offsetof(render_args, output), CLI_VALUES_PNG},
    {"film", 0, CLI_TEXT, "FILE",
     "Save a film of key frames as pictures; -o holds {frame}: 'film-{frame:04d}.png'",
     offsetof(render_args, film), CLI_VALUES_FILE},
    {"fps", 0, CLI_NUMBER, "N", "Pictures a second of --film (25)", offsetof(render_args, fps)},
    {"size", 0, CLI_SIZES, "WxH", "Size of the window in pixels (1280x800)",
     offsetof(render_args, size)},
    {"live-surface", 0, CLI_CHOICE, "auto/cpu/gpu",
     "What extracts the surface while the isovalue moves (auto: the GPU where OpenGL 4.3 is one)",
     offsetof(render_args, live_surface)},
#include "cli/render/options_what.inc"
    CLI_HEADED("Camera"),
#include "cli/render/options_camera.inc"
#include "cli/render/options_labels.inc"
#include "cli/render/options_look.inc"
    CLI_INPUT_OPTIONS(render_args),
};

static const cli_rule rules[] = {
    {"film", CLI_NEEDS, "output"},
    {"fps", CLI_NEEDS, "film"},
    CLI_SCENE_RULES,
};

_Static_assert(sizeof options / sizeof *options <= CLI_MAX_OPTIONS, "rows of options");

/* Frames while something takes long: a bar, and a way to stop it. */
static bool show_progress(void *user, const char *step, double done)
{
    view *v = user;
    const double now = v->ui->seconds(v->window);
    if (now - v->widgets->clock.progress_shown < 0.1)
        return !v->quits;
    v->widgets->clock.progress_shown = now;
    const cwi_ui_input *in = v->ui->begin(v->window, 0);
    const double scale = v->ui->scale(v->window);
    const cwi_ui_rect rect = {0.5 * ((double)in->width - 320 * scale), 0.5 * (double)in->height,
                              320 * scale, 0};
    v->quits |= in->close;
    bool is_cancelled = v->quits;
    for (size_t k = 0; k < in->key_count; k++)
        is_cancelled |= strcmp(in->keys[k], "Escape") == 0;
    v->ui->panel_begin(v->window, "Working", &rect, CWI_UI_FIXED, NULL);
    v->ui->progress(v->window, done, step);
    is_cancelled |= v->ui->button(v->window, "Cancel");
    v->ui->panel_end(v->window);
    v->ui->end(v->window, NULL);
    return !is_cancelled;
}

static void hear_line(void *user, const char *line)
{
    view *v = user; /* what a file is stands in the status line as well */
    if (!v->document.opening ||
        strncmp(line, v->document.opening, strlen(v->document.opening)) != 0)
        view_say(v, false, line);
}

static cw_status check_arguments(const render_args *args, cw_error *err)
{
    const char *dot = args->output ? strrchr(args->output, '.') : NULL;
    if (args->size.count != 2 || args->size.n[0] > 8192 || args->size.n[1] > 8192)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--size takes two numbers up to 8192, such as 1280x800");
    if (args->output && (!dot || strcmp(dot, ".png") != 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s: view writes .png", args->output);
    if (args->fps.given && !(args->fps.value > 0 && args->fps.value <= 1000))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--fps %g: above 0, up to 1000, was expected",
                        args->fps.value);
    if (args->common.input_count == 0 && args->output && !args->exec && !args->run)
        return cwi_fail(err, CW_ERR_ARGUMENT, "view -o needs a file to draw");
    return CW_OK;
}

static cw_status open_window(view *v, const render_args *args, cw_error *err)
{
    const void *functions;
    const cwi_ui_desc desc = {.title = "cubewright",
                              .width = args->size.n[0],
                              .height = args->size.n[1],
                              .hidden = args->hidden || args->output};
    cw_status st = cwi_module_load("window", &functions, err);
    if (st != CW_OK)
        return st;
    v->ui = functions;
    v->is_hidden = desc.hidden;
    return v->ui->open(&desc, &v->window, err);
}

/* Opens the first file. A visible window shows the error of a file, and stays open. */
static cw_status open_first(view *v, const render_args *args, cw_error *err)
{
    cw_error why = {0};
    if (args->common.input_count == 0)
        return CW_OK;
    cw_status st = view_open(v, args->common.inputs, args->common.input_count, &why);
    if (st == CW_OK)
        return CW_OK;
    if (v->is_hidden)
        return cwi_fail(err, st, "%s", why.message);
    cli_say_error(why.message);
    view_say(v, true, why.message);
    return CW_OK;
}

/* A file that was named has to be there, the usual one need not. */
static cw_status read_settings(view *v, const char *named, cw_error *err)
{
    char path[4096];
    const char *home = getenv("HOME"), *folder = getenv("XDG_CONFIG_HOME");
    if (named && strcmp(named, "none") != 0)
        return view_exec_file(v, named, err);
    if (named || v->is_hidden || (!home && !folder))
        return CW_OK;
    if (folder && *folder)
        snprintf(path, sizeof path, "%s/cubewright/view", folder);
    else
        snprintf(path, sizeof path, "%s/.config/cubewright/view", home ? home : "");
    return access(path, R_OK) == 0 ? view_exec_file(v, path, err) : CW_OK;
}

static cw_status do_asked(view *v, const render_args *args, cw_error *err)
{
    cw_status st = view_take_in(v, err);
    if (st == CW_OK && args->run)
        st = view_exec_file(v, args->run, err);
    if (st == CW_OK && args->exec) {
        st = view_exec(v, args->exec, err);
        st = st == CW_OK ? st : cwi_fail_in(err, st, "--exec");
    }
    if (st == CW_OK && args->output)
        st = view_frame(v, 0, err); /* lays out what came before */
    if (st == CW_OK && args->film && !v->quits)
        return view_make_film(v, args->film, args->output,
                              args->fps.given ? args->fps.value : 25, err);
    if (st == CW_OK && args->output && !v->quits)
        st = view_write_picture(v, &(view_sheet){0}, args->output, err);
    return st;
}

static cw_status run_session(view *v, const render_args *args, cw_error *err)
{
    const cli_listener listener = {v, hear_line, show_progress};
    const view_shown shown = {.panels = !args->output,
                              .cross = args->marks.layout == CLI_LAYOUT_QUAD};
    v->command = &cli_view;
    v->show_frame = view_show_frame;
    v->state.args = *args;
    v->state.slice_zoom = 1;
    v->state.left_fraction = 0.5;
    v->film.seconds = 2;
    v->shown = shown;
    v->layout.width = args->size.n[0];
    v->layout.height = args->size.n[1];
    for (int p = 0; p < VIEW_PARTS; p++)
        v->picture.parts[p].scale = 0.5;
    view_lay_out(v);
    cli_console_listen(&listener);
    view_start_recent(v, args->recent);
    v->script.is_configuring = true;
    cw_status st = read_settings(v, args->config, err);
    v->script.is_configuring = false;
    if (st == CW_OK)
        st = open_first(v, args, err);
    if (st == CW_OK)
        st = do_asked(v, args, err);
    if (st == CW_OK && !v->is_hidden)
        st = view_loop(v, err);
    cli_console_listen(NULL);
    return st;
}

static void end_session(view *v)
{
    view_drop_preview(v);
    view_close(v);
    view_close_browser(v);
    view_end_recent(v);
    cw_renderer_free(v->picture.renderer);
    if (v->window)
        v->ui->close(v->window);
    for (size_t n = 0; n < v->script.word_count; n++)
        free(v->script.words[n]);
    for (size_t n = 0; n < v->script.queued_count; n++)
        free(v->script.queued[n]);
    free(v->measuring.points);
    free(v->script.words);
    free(v->script.queued);
    free(v->widgets);
    free(v);
}

static cw_status run_view(void *p, cw_error *err)
{
    const render_args *args = p;
    const double start = cli_seconds();
    cw_status st = check_arguments(args, err);
    if (st != CW_OK)
        return st;
    view *v = calloc(1, sizeof *v);
    view_widgets *widgets = calloc(1, sizeof *widgets);
    if (!v || !widgets) {
        free(widgets);
        free(v);
        return cwi_fail_memory(err);
    }
    v->widgets = widgets;
    widgets->clock.start = start;
    st = open_window(v, args, err);
    if (st == CW_OK)
        st = run_session(v, args, err);
    end_session(v);
    if (st == CW_OK)
        cli_say_v("peak memory: %.0f MB", (double)cli_peak_bytes() / 1e6);
    return st;
}

/* Prints keys and commands from their tables, for the help. */
static void print_more(FILE *out)
{
    fputs("\nKeys\n", out);
    view_print_keys(out);
    fputs("\nCommands for --exec and --run\n"
          "Every option above is a command, too, without its dashes: 'iso 300', 'lit off',\n"
          "'clip-box default'. A ';' or the end of a line separates commands.\n",
          out);
    const view_verb *verb;
    for (size_t n = 0; (verb = view_verb_at(n)); n++) {
        char head[64];
        snprintf(head, sizeof head, "%s %s", verb->name, verb->takes);
        fprintf(out, "  %-28s", head);
        cli_print_wrapped(out, verb->about, 30);
    }
}

const cli_command cli_view = {
    .name = "view",
    .usage = "[VOLUME...|MESH|FOLDER] [options]",
    .about = "Open a window with everything that render draws",
    .page = cli_page_view,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .max_inputs = SIZE_MAX,
    .inputs = CLI_VALUES_SCENE,
    .size = sizeof(render_args),
    .defaults = &defaults,
    .print_more = print_more,
    .run = run_view,
};
