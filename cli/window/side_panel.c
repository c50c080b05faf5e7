/* The panel of settings at the right side: a widget for each, in sections. */
#include "cli/window/panels.h"

#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PANEL_WIDTH = 320, MAX_NAMES = 48, MAX_OPTIONS = 32 };
static const double MAX_PANEL = 0.4; /* of the window's width, at first */

/* A widget's label: the option's name, with blanks. */
static void label_of(const char *name, char *label, size_t size)
{
    snprintf(label, size, "%s", name);
    for (char *c = label; *c; c++)
        *c = *c == '-' ? ' ' : *c;
    if (*label >= 'a' && *label <= 'z')
        *label = (char)(*label - 'a' + 'A');
}

/* Words with blanks and semicolons stay one word. */
static void ask_setting(view *v, const char *name, const char *value)
{
    view_ask(v, "%s '%s'", name, *value && !strchr(value, '\'') ? value : "default");
}

/* Options for which a slider is shown: their ranges. */
static const struct {
    const char *name;
    double low, high, usual;
} sliders[] = {{"ambient", 0, 1, 0.25},          {"diffuse", 0, 1, 0.75},
               {"specular", 0, 1, 0.2},          {"shininess", 1, 100, 32},
               {"depth-cue", 0, 1, 0},           {"step-length", 0.1, 4, 0.5},
               {"stop-opacity", 0.5, 1, 0.9999}, {"tree-error", 0, 0.2, 0}};

static bool show_slider(view *v, const cli_option *o, const char *label)
{
    const cli_number *n = (const cli_number *)((const char *)&v->state.args + o->offset);
    for (size_t s = 0; s < sizeof sliders / sizeof *sliders; s++) {
        double value = n->given ? n->value : sliders[s].usual;
        if (strcmp(sliders[s].name, o->name) != 0)
            continue;
        if (v->ui->slider(v->window, label, &value, sliders[s].low, sliders[s].high, "%.4g"))
            view_ask(v, "%s %.6g", o->name, value);
        return true;
    }
    return false;
}

static size_t split_names(const char *choices, char *buffer, size_t size, const char **names)
{
    size_t count = 0;
    snprintf(buffer, size, "%s", choices);
    for (char *c = buffer; c && count < MAX_NAMES;) {
        names[count++] = c;
        c = strchr(c, '/');
        if (c)
            *c++ = '\0';
    }
    return count;
}

static void show_choice(view *v, const cli_option *o, const char *label)
{
    char buffer[512];
    const char *names[MAX_NAMES];
    const size_t count = split_names(o->value, buffer, sizeof buffer, names);
    size_t chosen = (size_t) * (const int *)((const char *)&v->state.args + o->offset);
    if (v->ui->choice(v->window, label, names, count, &chosen))
        view_ask(v, "%s %s", o->name, names[chosen]);
}

static void show_text(view *v, const cli_option *o, const char *label)
{
    char text[512];
    const size_t n = (size_t)(o - v->command->options);
    text[0] = '\0';
    if (v->state.args.common.given[n])
        cli_option_text(o, &v->state.args, text, sizeof text);
    if (v->ui->input(v->window, label, text, sizeof text))
        ask_setting(v, o->name, text);
}

/* The widget of an option. */
static void show_option(view *v, const char *name)
{
    char label[64];
    const cli_option *o = view_find_option(v, name);
    if (!o)
        return;
    label_of(o->name, label, sizeof label);
    if (o->kind == CLI_FLAG) {
        bool on = *(const bool *)((const char *)&v->state.args + o->offset);
        if (v->ui->check(v->window, label, &on))
            view_ask(v, "%s %s", o->name, on ? "on" : "off");
    } else if (o->kind == CLI_CHOICE) {
        show_choice(v, o, label);
    } else if (o->kind != CLI_NUMBER || !show_slider(v, o, label)) {
        show_text(v, o, label);
    }
    v->ui->tip(v->window, o->about);
}

/* Whether a widget of another section sets it. */
static bool is_shown_elsewhere(const char *name)
{
    static const char *const names[] = {"lit", "layout", "isolines"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
        if (strcmp(name, names[n]) == 0)
            return true;
    return false;
}

/* The options under a heading of the command's table that do something now: how many. */
static size_t find_options(const view *v, const char *heading, const char *names[MAX_OPTIONS])
{
    bool is_here = false;
    size_t count = 0;
    for (size_t n = 0; n < v->command->option_count; n++) {
        const cli_option *o = &v->command->options[n];
        if (o->kind == CLI_HEADING)
            is_here = strncmp(o->name, heading, strlen(heading)) == 0;
        else if (is_here && count < MAX_OPTIONS && !is_shown_elsewhere(o->name) &&
                 cli_setting_fits(o->name, v->picture.mode, view_has_mesh(v)))
            names[count++] = o->name;
    }
    return count;
}

static void show_options(view *v, const char *heading)
{
    const char *names[MAX_OPTIONS];
    const size_t count = find_options(v, heading, names);
    if (count == 0 || !v->ui->section(v->window, heading, false))
        return;
    for (size_t n = 0; n < count; n++)
        show_option(v, names[n]);
}

/* Tells the cost of the mode, and its measured error. */
static void tell_mode(view *v)
{
    char text[256];
    const double rmse = v->picture.mode_error[v->picture.mode];
    int used = snprintf(text, sizeof text, "%s", cw_mode_about(v->picture.mode));
    if (!v->state.args.compare) /* then the time is that of two pictures */
        used += snprintf(text + used, sizeof text - (size_t)used, "; %.0f ms",
                         v->picture.parts[VIEW_SPACE].ms);
    if (rmse >= 0)
        used += snprintf(text + used, sizeof text - (size_t)used,
                         "; error %.3g of 255 (rmse, measured)", rmse);
    v->ui->text(v->window, text);
    snprintf(text, sizeof text, "%s%sAn error is known once Compare has measured it.",
             *cw_mode_source(v->picture.mode) ? cw_mode_source(v->picture.mode) : "",
             *cw_mode_source(v->picture.mode) ? "\n" : "");
    v->ui->tip(v->window, text);
}

static void show_mode(view *v)
{
    const char *names[VIEW_MODE_NAMES];
    char tip[256];
    const size_t count = view_list_modes(v, true, names);
    size_t chosen = 0;
    for (size_t n = 0; n < count; n++)
        chosen = strcmp(names[n], cw_mode_name(v->picture.mode)) == 0 ? n : chosen;
    if (v->ui->choice(v->window, "Mode", names, count, &chosen))
        view_ask(v, "mode %s", names[chosen]);
    snprintf(tip, sizeof tip, "%s%s%s", cw_mode_about(v->picture.mode),
             *cw_mode_source(v->picture.mode) ? "\n" : "", cw_mode_source(v->picture.mode));
    v->ui->tip(v->window, tip);
    tell_mode(v);
}

static void show_preset(view *v)
{
    const char *names[MAX_NAMES] = {"by mode"};
    const char *now = v->state.args.scene.transfer;
    size_t count = 1, chosen = 0;
    for (const char *name;
         count < MAX_NAMES - 1 && (name = cw_transfer_preset_name(count - 1));)
        names[count++] = name;
    for (size_t n = 1; n < count; n++)
        chosen = now && strcmp(names[n], now) == 0 ? n : chosen;
    if (v->state.is_edited || (now && !chosen)) {
        chosen = count;
        names[count++] = v->state.is_edited ? "edited" : "a file";
    }
    if (v->ui->choice(v->window, "Preset", names, count, &chosen) && chosen < MAX_NAMES &&
        (chosen == 0 || cw_transfer_preset_name(chosen - 1)))
        view_ask(v, "tf %s", chosen ? names[chosen] : "default");
    if (chosen && cw_transfer_preset_name(chosen - 1))
        v->ui->tip(v->window, cw_transfer_preset_about(chosen - 1));
    if (v->ui->button(v->window, "Presets as pictures..."))
        view_ask(v, "toggle gallery");
    v->ui->tip(v->window, "Choose colours and opacities by small pictures of this volume");
}

static void show_shift(view *v)
{
    const cli_scene *s = &v->state.args.scene;
    const double range = v->document.statistics.max - v->document.statistics.min;
    double shift = s->shift.value, opacity = s->opacity.given ? s->opacity.value : 1;
    if (v->ui->slider(v->window, "Shift", &shift, -0.5 * range, 0.5 * range, "%.4g"))
        view_ask(v, "shift %.9g", shift);
    v->ui->tip(v->window, "Number to add to all values of the transfer function");
    if (v->ui->log_slider(v->window, "Opacity", &opacity, 0.01, 100, "x %.3g"))
        view_ask(v, "opacity %.6g", opacity);
    v->ui->tip(v->window, "Factor for all opacities");
}

static void show_scene(view *v)
{
    if (!v->ui->section(v->window, "Scene", true))
        return;
    show_mode(v);
    if (view_draws_volume(v))
        show_preset(v);
    if (!v->document.source.is_mesh)
        view_curve(v);
    if (view_draws_volume(v)) {
        show_shift(v);
        show_option(v, "lit");
    }
}

static void show_surface(view *v)
{
    const cw_statistics *s = &v->document.statistics;
    const cli_number *iso = &v->state.args.iso;
    bool on = iso->given;
    double value = on ? iso->value : view_suggest_iso(v);
    char text[64];
    if (v->document.source.is_mesh || !v->ui->section(v->window, "Surface", true))
        return;
    if (v->ui->check(v->window, "Show the surface", &on) && on)
        view_ask(v, "iso %.9g", value);
    else if (on != iso->given)
        view_ask(v, "iso off");
    if (v->ui->slider(v->window, "Isovalue", &value, s->min, s->max, "%.5g"))
        view_ask(v, "iso %.9g", value);
    if (v->document.surface.is_live)
        snprintf(text, sizeof text, "extracted by the GPU");
    else
        snprintf(text, sizeof text, "%zu triangles%s", v->document.source.mesh.triangle_count,
                 v->document.surface.level == 1 ? ", coarse" : "");
    if (on)
        v->ui->text(v->window, text);
}

static void show_faces(view *v)
{
    static const char *const labels[6] = {"x from", "x to", "y from", "y to", "z from", "z to"};
    double box[2][3];
    view_clip_box(v, box);
    for (int f = 0; f < 6; f++) {
        const int a = f / 2;
        double value = box[f % 2][a];
        if (v->ui->slider(v->window, labels[f], &value, v->document.box[0][a],
                          v->document.box[1][a], "%.1f mm"))
            view_ask(v, "clip-face %d %.9g", f, value);
    }
}

static void show_cut(view *v)
{
    bool on = v->shown.handles;
    if (!v->ui->section(v->window, "Cut", false))
        return;
    if (v->ui->check(v->window, "Handles", &on))
        view_ask(v, "toggle handles %s", on ? "on" : "off");
    v->ui->same_line(v->window);
    if (v->ui->button(v->window, "Remove all cuts"))
        view_ask(v, "clip-box off; cut-away off; clip off");
    show_faces(v);
    if (v->state.args.scene.clip_box.given || v->state.args.scene.clips)
        show_option(v, "cut-away");
    show_option(v, "clip");
    if (view_has_mesh(v))
        show_option(v, "cap");
}

/* The windows of radiology, where values are in their unit. */
static void show_windows(view *v, const double now[2])
{
    const char *names[MAX_NAMES] = {"by the values"};
    double range[2];
    size_t count = 1, chosen = 0;
    for (const char *name; (name = view_window_name(count - 1, range)); names[count++] = name)
        if (range[0] == now[0] && range[1] == now[1])
            chosen = count;
    const double *set = v->state.window;
    if (!chosen && (set[0] != 0 || set[1] != 0))
        names[chosen = count++] = "by hand";
    if (!v->ui->choice(v->window, "Greys", names, count, &chosen))
        return;
    if (view_window_name(chosen - 1, range) || chosen == 0)
        view_ask(v, "window %s", chosen ? names[chosen] : "auto");
}

/* Shows the values drawn black and white, and the same as a window and its level. */
static void show_greys(view *v)
{
    const cw_statistics *s = &v->document.statistics;
    const double range = s->max - s->min;
    double w[2];
    view_grey_range(v, w);
    double width = w[1] - w[0], level = 0.5 * (w[0] + w[1]);
    if (view_is_hounsfield(v))
        show_windows(v, w);
    const bool black = v->ui->slider(v->window, "Black", &w[0], s->min, s->max, "%.5g");
    if (v->ui->slider(v->window, "White", &w[1], s->min, s->max, "%.5g") || black)
        view_ask(v, "window %.9g %.9g", fmin(w[0], w[1] - 1e-6 * range), w[1]);
    const bool wider = v->ui->number(v->window, "Window", &width, range / 1000, "%.5g");
    v->ui->tip(v->window, "From black to white");
    if (v->ui->number(v->window, "Level", &level, range / 1000, "%.5g") || wider) {
        width = fmax(width, 1e-6 * range);
        view_ask(v, "window %.9g %.9g", level - 0.5 * width, level + 0.5 * width);
    }
    v->ui->tip(v->window, "In the middle of black and white");
}

static void show_slices(view *v)
{
    static const char *const names[3] = {"Sagittal x", "Coronal y", "Axial z"};
    bool quad = v->state.args.marks.layout == CLI_LAYOUT_QUAD;
    double cross[3];
    if (!v->document.has_volume || !view_fits_mode(v, CW_MODE_SLICES) ||
        !v->ui->section(v->window, "Slices", quad))
        return;
    if (v->ui->check(v->window, "Beside the scene", &quad))
        view_ask(v, "toggle quad");
    for (int a = 0; a < 3; a++) {
        memcpy(cross, v->state.cross, sizeof cross);
        if (v->ui->slider(v->window, names[a], &cross[a], v->document.box[0][a],
                          v->document.box[1][a], "%.1f mm"))
            view_ask(v, "cross %.9g %.9g %.9g", cross[0], cross[1], cross[2]);
    }
    show_greys(v);
    show_option(v, "isolines");
    v->ui->text(v->window, v->input.probe);
}

static void show_time(view *v)
{
    const size_t count = v->document.source.series.count;
    double step = (double)v->state.step;
    bool playing = v->shown.playing;
    if (count < 2 || !v->ui->section(v->window, "Time", true))
        return;
    if (v->ui->slider(v->window, "Step", &step, 0, (double)count - 1, "%.0f") &&
        (size_t)lround(step) != v->state.step)
        view_ask(v, "step %ld", lround(step));
    if (v->ui->check(v->window, "Play", &playing))
        view_ask(v, "toggle playing %s", playing ? "on" : "off");
}

void view_show_side(view *v)
{
    const double scale = v->ui->scale(v->window), all = (double)v->layout.width;
    const double width = fmax(fmin(PANEL_WIDTH * scale, MAX_PANEL * all),
                              fmin(CWI_UI_DOCKED_MIN * scale, CWI_UI_DOCKED_MAX * all));
    const cwi_ui_rect rect = {(double)v->layout.width - width, v->layout.bar_height, width,
                              (double)v->layout.height - v->layout.bar_height};
    cwi_ui_rect now = rect; /* somebody may have made it wider */
    (void)v->ui->find(v->window, "Settings", &now);
    v->layout.panel_width = now.width;
    if (v->ui->panel_begin(v->window, "Settings", &rect, CWI_UI_DOCKED, NULL) &&
        v->document.path) {
        show_scene(v);
        view_show_point(v);
        show_surface(v);
        show_slices(v);
        view_show_measure_section(v);
        show_cut(v);
        view_show_pieces_section(v);
        show_time(v);
        view_show_compare(v);
        view_show_views(v);
        if (v->document.labels.look.labels && !v->document.overlay.values.volume)
            show_options(v, "Label maps");
        if (v->document.has_volume)
            show_options(v, "Overlay of another volume");
        show_options(v, "Light");
        show_options(v, "Sampling");
        show_options(v, "Meshes");
        show_options(v, "Marks on the picture");
    }
    v->ui->panel_end(v->window);
}
