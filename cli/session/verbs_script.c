/* Commands of scripts: printing of settings and facts, waiting for frames, and simulated input. */
#include "cli/render/slice_caption.h"
#include "cli/session/verbs.h"
#include "cli/session/view_measure.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void print_setting(const view *v, const char *name)
{
    char text[CW_TRANSFER_TEXT];
    bool on;
    const cli_option *o = view_find_option(v, name);
    if (view_find_flag(v, name, &on))
        printf("%s %s\n", name, on ? "on" : "off");
    else if (o)
        printf("%s %s\n", name,
               cli_option_text(o, &v->state.args, text, sizeof text) ? text : "default");
}

/* Prints what is written on the slices. */
static void print_slices(const view *v)
{
    char text[96];
    for (int a = 2; a >= 0 && v->document.has_volume; a--) {
        cli_caption_slice(cli_drawn(&v->document.source), a, v->state.cross[a], ", ", text,
                          sizeof text);
        printf("%s\n", text);
    }
}

static cw_status run_print(view *v, int count, char **args, cw_error *err)
{
    char text[CW_TRANSFER_TEXT];
    const view_state *s = &v->state;
    const char *what = args[0];
    bool on;
    (void)count;
    if (strcmp(what, "mode") == 0)
        printf("mode %s\n", cw_mode_name(v->picture.mode));
    else if (strcmp(what, "open") == 0)
        printf("open %s\n", v->document.path ? cli_shown_path(v->document.path) : "nothing");
    else if (strcmp(what, "cross") == 0)
        printf("cross %.6g %.6g %.6g\n", s->cross[0], s->cross[1], s->cross[2]);
    else if (strcmp(what, "probe") == 0)
        printf("probe %s\n", v->input.probe);
    else if (strcmp(what, "window") == 0)
        printf("window %.6g %.6g\n", s->window[0], s->window[1]);
    else if (strcmp(what, "split") == 0)
        printf("split %.6g\n", s->left_fraction);
    else if (strcmp(what, "step") == 0)
        printf("step %zu of %zu\n", s->step, v->document.source.series.count);
    else if (strcmp(what, "surface") == 0)
        printf("surface %s\n", view_name_surface(v));
    else if (strcmp(what, "triangles") == 0)
        printf("triangles %zu\n", v->document.source.mesh.triangle_count);
    else if (strcmp(what, "time") == 0)
        printf("time %.1f ms, %zu x %zu\n", v->picture.parts[VIEW_SPACE].ms,
               v->picture.parts[VIEW_SPACE].scene.width,
               v->picture.parts[VIEW_SPACE].scene.height);
    else if (strcmp(what, "measurements") == 0)
        view_print_measures(v, stdout);
    else if (strcmp(what, "captions") == 0)
        print_slices(v);
    else if (strcmp(what, "message") == 0)
        printf("message %s\n", v->message.text);
    else if (strcmp(what, "compare") == 0 && s->args.compare && v->picture.is_measured)
        printf("compare %s: rmse %.3g%s%s\n", s->args.compare, v->picture.measured.rmse,
               v->picture.is_preliminary ? ", preliminary" : "",
               v->picture.is_alike ? "" : ", of different modes");
    else if (strcmp(what, "command") == 0) {
        char *line = view_command_line(v);
        if (!line)
            return cwi_fail_memory(err);
        puts(line);
        free(line);
    } else if (strcmp(what, "camera") == 0 && s->is_placed &&
               cw_camera_format(&s->camera, text, err) == CW_OK)
        printf("%s\n", text);
    else if (strcmp(what, "tf") == 0 && v->document.has_volume &&
             view_need_transfer(v, err) == CW_OK &&
             cw_transfer_format(&v->picture.transfer, text, err) == CW_OK)
        printf("%s\n", text);
    else if (view_find_option(v, what) || view_find_flag(v, what, &on))
        print_setting(v, what);
    else
        return cwi_fail(err, CW_ERR_ARGUMENT, "print: unknown name '%s'", what);
    return CW_OK;
}

static cw_status run_wait(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    return view_settle(v, err);
}

static unsigned modifiers_of(const char *word)
{
    return (strstr(word, "shift") ? CWI_UI_SHIFT : 0u) |
           (strstr(word, "ctrl") ? CWI_UI_CTRL : 0u) | (strstr(word, "alt") ? CWI_UI_ALT : 0u);
}

static int button_of(int count, char **args)
{
    for (int n = 0; n < count; n++)
        if (strcmp(args[n], "right") == 0 || strcmp(args[n], "middle") == 0)
            return args[n][0] == 'r' ? CWI_UI_RIGHT : CWI_UI_MIDDLE;
    return CWI_UI_LEFT;
}

static cw_status feed_event(view *v, const cwi_ui_event *event, cw_error *err)
{
    cw_status st = v->ui->feed(v->window, event, err);
    return st == CW_OK ? view_take_in(v, err) : st;
}

/* Feeds input as if it came from outside. Further words name keys that are held down. */
static cw_status feed_words(view *v, cwi_ui_kind kind, int needed, int count, char **args,
                            cw_error *err)
{
    double n[2] = {0};
    cwi_ui_event event = {.kind = kind, .button = button_of(count, args)};
    cw_status st = view_take("input", args, needed, n, err);
    for (int i = needed; i < count; i++)
        event.modifiers |= modifiers_of(args[i]);
    event.x = kind == CWI_UI_WHEEL ? 0 : n[0];
    event.y = kind == CWI_UI_WHEEL ? n[0] : n[1];
    return st == CW_OK ? feed_event(v, &event, err) : st;
}

static cw_status run_mouse(view *v, int count, char **args, cw_error *err)
{
    return feed_words(v, CWI_UI_MOVE, 2, count, args, err);
}

static cw_status run_press(view *v, int count, char **args, cw_error *err)
{
    return feed_words(v, CWI_UI_PRESS, 0, count, args, err);
}

static cw_status run_lift(view *v, int count, char **args, cw_error *err)
{
    return feed_words(v, CWI_UI_LIFT, 0, count, args, err);
}

/* Feeds a double click at once: with frames in between it could take too long. */
static cw_status run_twice(view *v, int count, char **args, cw_error *err)
{
    cw_status st = CW_OK;
    (void)count, (void)args;
    for (int n = 0; n < 4 && st == CW_OK; n++)
        st = v->ui->feed(v->window, &(cwi_ui_event){.kind = n % 2 ? CWI_UI_LIFT : CWI_UI_PRESS},
                         err);
    return st == CW_OK ? view_take_in(v, err) : st;
}

static cw_status run_wheel(view *v, int count, char **args, cw_error *err)
{
    return feed_words(v, CWI_UI_WHEEL, 1, count, args, err);
}

static cw_status run_resize(view *v, int count, char **args, cw_error *err)
{
    double n[2];
    cw_status st = view_take("resize", args, count, n, err);
    if (st == CW_OK && !(n[0] >= 1 && n[1] >= 1 && n[0] <= 8192 && n[1] <= 8192))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "resize %s %s: 1 to 8192 was expected", args[0],
                      args[1]);
    return st == CW_OK
               ? feed_event(v, &(cwi_ui_event){.kind = CWI_UI_RESIZE, .x = n[0], .y = n[1]},
                            err)
               : st;
}

static cw_status run_key(view *v, int count, char **args, cw_error *err)
{
    (void)count;
    return feed_event(v, &(cwi_ui_event){.kind = CWI_UI_KEY, .text = args[0]}, err);
}

static cw_status run_write(view *v, int count, char **args, cw_error *err)
{
    (void)count;
    return feed_event(v, &(cwi_ui_event){.kind = CWI_UI_WRITE, .text = args[0]}, err);
}

static cw_status run_drop(view *v, int count, char **args, cw_error *err)
{
    (void)count;
    return feed_event(v, &(cwi_ui_event){.kind = CWI_UI_DROP, .text = args[0]}, err);
}

/* Where a widget is once it moves no more: what came just now may still be laid out. */
static cw_status find_widget(view *v, const char *label, cwi_ui_rect *r, cw_error *err)
{
    enum { MAX_FRAMES = 8 };
    cwi_ui_rect before = {0};
    bool is_there = false;
    for (int n = 0; n < MAX_FRAMES; n++) {
        cw_status st = view_frame(v, 0, err);
        if (st != CW_OK)
            return st;
        is_there = v->ui->find(v->window, label, r);
        if (is_there && memcmp(&before, r, sizeof before) == 0)
            return CW_OK;
        before = *r;
    }
    return is_there ? CW_OK : cwi_fail(err, CW_ERR_ARGUMENT, "nothing is labelled '%s'", label);
}

static cw_status run_place(view *v, int count, char **args, cw_error *err)
{
    cwi_ui_rect r = {0};
    (void)count;
    cw_status st = find_widget(v, args[0], &r, err);
    if (st == CW_OK)
        printf("place %g %g %g %g\n", r.x, r.y, r.width, r.height);
    return st;
}

/* Moves the mouse to a point of a widget, stated in fractions of its size. */
static cw_status go_to(view *v, const char *label, double x, double y, cw_error *err)
{
    cwi_ui_rect r = {0};
    cw_status st = find_widget(v, label, &r, err);
    if (st != CW_OK)
        return st;
    return feed_event(
        v,
        &(cwi_ui_event){.kind = CWI_UI_MOVE, .x = r.x + x * r.width, .y = r.y + y * r.height},
        err);
}

static cw_status run_point_at(view *v, int count, char **args, cw_error *err)
{
    double n[2] = {0.5, 0.5};
    cw_status st = view_take("point-at", args + 1, count - 1, n, err);
    return st == CW_OK ? go_to(v, args[0], n[0], n[1], err) : st;
}

static cw_status run_click(view *v, int count, char **args, cw_error *err)
{
    cw_status st = run_point_at(v, count, args, err);
    if (st == CW_OK)
        st = run_press(v, 0, NULL, err);
    return st == CW_OK ? run_lift(v, 0, NULL, err) : st;
}

static double draw_random(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

static cw_status feed_random(view *v, uint64_t *seed, cw_error *err)
{
    const double what = draw_random(seed), x = draw_random(seed), y = draw_random(seed);
    cwi_ui_event e = {.kind = CWI_UI_MOVE,
                      .x = x * (double)v->layout.width,
                      .y = y * (double)v->layout.height};
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

/* Feeds random input, to find what breaks. */
static cw_status run_monkey(view *v, int count, char **args, cw_error *err)
{
    double n[2] = {0};
    cw_status st = view_take("monkey", args, count, n, err);
    if (st == CW_OK && !(n[0] >= 0 && n[0] <= 1e15 && n[1] >= 0 && n[1] <= 1e9))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "monkey %s %s: a seed and a number were expected",
                      args[0], args[1]);
    uint64_t seed = st == CW_OK ? (uint64_t)n[0] : 0;
    v->input.is_monkey = true;
    for (size_t k = 0; st == CW_OK && k < (size_t)n[1] && !v->quits; k++)
        st = feed_random(v, &seed, err);
    v->input.is_monkey = false;
    return st;
}

static const view_verb rows[] = {
    VERB("wait", "", "Wait until the picture is finished", 0, 0, run_wait),
    VERB(
        "print", "NAME",
        "Print a setting, or: mode, open, cross, captions, probe, surface, measurements, command, ...",
        1, 1, run_print),
    VERB("mouse", "X Y [KEYS]", "Move the mouse, while KEYS such as ctrl are held", 2, 3,
         run_mouse),
    VERB("press", "[BUTTON] [KEYS]", "Press a mouse button: left, right or middle", 0, 2,
         run_press),
    VERB("lift", "[BUTTON] [KEYS]", "Release a mouse button", 0, 2, run_lift),
    VERB("twice", "", "Double-click the left button", 0, 0, run_twice),
    VERB("wheel", "LINES [KEYS]", "Turn the wheel", 1, 2, run_wheel),
    VERB("key", "NAME", "Press a key, such as M, F12 or Ctrl+Z", 1, 1, run_key),
    VERB("write", "TEXT", "Type into a widget", 1, 1, run_write),
    VERB("drop", "PATH", "Drop a file on the window", 1, 1, run_drop),
    VERB("resize", "W H", "Resize the window", 2, 2, run_resize),
    VERB("place", "LABEL", "Print the place of a widget: x, y, width, height", 1, 1, run_place),
    VERB("point-at", "LABEL [X Y]",
         "Move the mouse to a widget; X and Y are fractions of its size", 1, 3, run_point_at),
    VERB("click", "LABEL [X Y]", "Click on a widget", 1, 3, run_click),
    VERB("monkey", "SEED N", "Make N random inputs", 2, 2, run_monkey),
};
const view_verbs view_script_verbs = {rows, sizeof rows / sizeof *rows};
