/* Menus, panels and what is written on the window. Widgets ask for commands. */
#include "cli/view/view.h"

#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PANEL_WIDTH = 320, STRIP_HEIGHT = 30, MAX_NAMES = 32, MAX_OPTIONS = 32 };

/* The menu of a row, "View/Front": whether it is of that menu, and the item's name. */
static const char *item_of(const view_key *k, const char *menu)
{
    const size_t length = strlen(menu);
    return k->menu && strncmp(k->menu, menu, length) == 0 && k->menu[length] == '/'
               ? k->menu + length + 1
               : NULL;
}

static bool is_checked(const view *v, const view_key *k)
{
    bool on = false;
    return strncmp(k->command, "toggle ", 7) == 0 && view_find_flag(v, k->command + 7, &on) &&
           on;
}

static void show_menu(view *v, const char *menu)
{
    if (!v->ui->menu_begin(v->window, menu))
        return;
    for (size_t n = 0; n < view_key_count; n++) {
        const view_key *k = &view_keys[n];
        const char *item = item_of(k, menu);
        if (item && v->ui->item(v->window, item, k->key, is_checked(v, k), true))
            view_ask(v, "%s", k->command);
    }
    v->ui->menu_end(v->window);
}

static void show_bar(view *v)
{
    static const char *const menus[] = {"File", "Edit", "View", "Scene", "Time", "Help"};
    v->bar_height = v->ui->bar_begin(v->window);
    for (size_t n = 0; n < sizeof menus / sizeof *menus; n++)
        show_menu(v, menus[n]);
    v->ui->bar_end(v->window);
}

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

/* Numbers that a slider suits. */
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

static size_t split_names(const char *choices, char *room, size_t size, const char **names)
{
    size_t count = 0;
    snprintf(room, size, "%s", choices);
    for (char *c = room; c && count < MAX_NAMES;) {
        names[count++] = c;
        c = strchr(c, '/');
        if (c)
            *c++ = '\0';
    }
    return count;
}

static void show_choice(view *v, const cli_option *o, const char *label)
{
    char room[512];
    const char *names[MAX_NAMES];
    const size_t count = split_names(o->value, room, sizeof room, names);
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

/* The options under a heading of the command's table that do something now: how many. */
static size_t find_options(const view *v, const char *heading, const char *names[MAX_OPTIONS])
{
    bool is_here = false;
    size_t count = 0;
    for (size_t n = 0; n < v->command->option_count; n++) {
        const cli_option *o = &v->command->options[n];
        if (o->kind == CLI_HEADING)
            is_here = strncmp(o->name, heading, strlen(heading)) == 0;
        else if (is_here && count < MAX_OPTIONS &&
                 cli_setting_fits(o->name, v->mode, view_has_mesh(v)))
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

static void show_mode(view *v)
{
    const char *names[CW_MODE_COUNT];
    char tip[256];
    size_t chosen = 0, count = 0;
    for (int m = 0; m < CW_MODE_COUNT; m++) {
        if (!view_fits_mode(v, (cw_mode)m))
            continue;
        chosen = (cw_mode)m == v->mode ? count : chosen;
        names[count++] = cw_mode_name((cw_mode)m);
    }
    if (v->ui->choice(v->window, "Mode", names, count, &chosen))
        view_ask(v, "mode %s", names[chosen]);
    snprintf(tip, sizeof tip, "%s%s%s", cw_mode_about(v->mode),
             *cw_mode_source(v->mode) ? "\n" : "", cw_mode_source(v->mode));
    v->ui->tip(v->window, tip);
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
}

static void show_shift(view *v)
{
    const cli_scene *s = &v->state.args.scene;
    const double range = v->statistics.max - v->statistics.min;
    double shift = s->shift.value, opacity = log10(s->opacity.given ? s->opacity.value : 1);
    if (v->ui->slider(v->window, "Shift", &shift, -0.5 * range, 0.5 * range, "%.4g"))
        view_ask(v, "shift %.9g", shift);
    v->ui->tip(v->window, "Number to add to all values of the transfer function");
    if (v->ui->slider(v->window, "Opacity", &opacity, -2, 2, "10^%.2f"))
        view_ask(v, "opacity %.6g", pow(10, opacity));
    v->ui->tip(v->window, "Factor for all opacities");
}

static void show_scene(view *v)
{
    if (!v->ui->section(v->window, "Scene", true))
        return;
    show_mode(v);
    if (view_draws_volume(v))
        show_preset(v);
    if (!v->source.is_mesh)
        view_curve(v);
    if (view_draws_volume(v)) {
        show_shift(v);
        show_option(v, "lit");
    }
}

static void show_surface(view *v)
{
    const cw_statistics *s = &v->statistics;
    const cli_number *iso = &v->state.args.iso;
    bool on = iso->given;
    double value = on ? iso->value : view_suggest_iso(v);
    char text[64];
    if (v->source.is_mesh || !v->ui->section(v->window, "Surface", true))
        return;
    if (v->ui->check(v->window, "Show the surface", &on) && on)
        view_ask(v, "iso %.9g", value);
    else if (on != iso->given)
        view_ask(v, "iso off");
    if (v->ui->slider(v->window, "Isovalue", &value, s->min, s->max, "%.5g"))
        view_ask(v, "iso %.9g", value);
    if (v->is_live)
        snprintf(text, sizeof text, "extracted by the GPU");
    else
        snprintf(text, sizeof text, "%zu triangles%s", v->source.mesh.triangle_count,
                 v->mesh_level == 1 ? ", coarse" : "");
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
        if (v->ui->slider(v->window, labels[f], &value, v->box[0][a], v->box[1][a], "%.1f mm"))
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

static void show_slices(view *v)
{
    static const char *const names[3] = {"Sagittal x", "Coronal y", "Axial z"};
    const cw_statistics *s = &v->statistics;
    double w[2];
    bool quad = v->state.args.marks.layout == CLI_LAYOUT_QUAD;
    double cross[3];
    if (!v->has_volume || !view_fits_mode(v, CW_MODE_SLICES) ||
        !v->ui->section(v->window, "Slices", quad))
        return;
    if (v->ui->check(v->window, "Beside the scene", &quad))
        view_ask(v, "toggle quad");
    for (int a = 0; a < 3; a++) {
        memcpy(cross, v->state.cross, sizeof cross);
        if (v->ui->slider(v->window, names[a], &cross[a], v->box[0][a], v->box[1][a],
                          "%.1f mm"))
            view_ask(v, "cross %.9g %.9g %.9g", cross[0], cross[1], cross[2]);
    }
    view_grey_range(v, w);
    const bool black = v->ui->slider(v->window, "Black", &w[0], s->min, s->max, "%.5g");
    if (v->ui->slider(v->window, "White", &w[1], s->min, s->max, "%.5g") || black)
        view_ask(v, "window %.9g %.9g", fmin(w[0], w[1] - 1e-6 * (s->max - s->min)), w[1]);
    v->ui->text(v->window, v->probe);
}

static void show_time(view *v)
{
    const size_t count = v->source.series.count;
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

static void show_compare(view *v)
{
    char text[512], said[256];
    const cw_comparison *m = &v->measured;
    const char *now = v->state.args.compare;
    bool difference = v->state.args.difference.given;
    if (!view_draws_volume(v) || !v->ui->section(v->window, "Compare", now != NULL))
        return;
    snprintf(text, sizeof text, "%s", now ? now : "");
    if (v->ui->input(v->window, "Left | right", text, sizeof text))
        ask_setting(v, "compare", text);
    v->ui->tip(v->window,
               "Two sets of options, such as texture,step-length=2 | reference; press Enter");
    if (!now && v->ui->button(v->window, "With the reference"))
        view_ask(v, "compare '%s|reference'", cw_mode_name(v->mode));
    if (!now)
        return;
    if (v->ui->button(v->window, "No comparison"))
        view_ask(v, "compare off; difference off");
    if (v->ui->check(v->window, "Difference, 20 times", &difference))
        view_ask(v, "difference %s", difference ? "20" : "off");
    snprintf(said, sizeof said,
             "%s%srmse %.3g, max %.3g of 255\ndelta-E %.3g, 99 %% below %.3g\nSSIM %.5f",
             v->is_preliminary ? "preliminary: the pictures are not finished\n" : "",
             v->is_alike ? "" : "Different modes: this is not an error\n", m->rmse, m->max,
             m->delta_e_mean, m->delta_e_p99, m->ssim);
    v->ui->text(v->window, v->is_measured ? said : "The difference is measured soon ...");
}

static void show_side(view *v)
{
    const double width = PANEL_WIDTH * v->ui->scale(v->window);
    const cwi_ui_rect rect = {(double)v->width - width, v->bar_height, width,
                              (double)v->height - v->bar_height};
    v->panel_width = width;
    if (v->ui->panel_begin(v->window, "Settings", &rect, CWI_UI_FIXED, NULL) && v->path) {
        show_scene(v);
        show_surface(v);
        show_slices(v);
        show_cut(v);
        show_time(v);
        show_compare(v);
        if (v->look.labels)
            show_options(v, "Label maps");
        show_options(v, "Light");
        show_options(v, "Sampling");
        show_options(v, "Meshes");
        show_options(v, "Marks on the picture");
    }
    v->ui->panel_end(v->window);
}

/* In two columns. */
static void show_key(view *v, size_t n)
{
    static const cwi_ui_color color = {0.86f, 0.89f, 0.92f, 1}, strong = {1, 0.8f, 0.3f, 1};
    const double scale = v->ui->scale(v->window);
    char names[64];
    cwi_ui_area a;
    if (!view_key_names(n, names, sizeof names))
        return;
    v->ui->area(v->window, view_keys[n].command, 0, 17 * scale, &a);
    v->ui->write(v->window, CWI_UI_PANEL, a.rect.x, a.rect.y, strong, names);
    v->ui->write(v->window, CWI_UI_PANEL, a.rect.x + 170 * scale, a.rect.y, color,
                 view_keys[n].about);
}

static void show_keys(view *v)
{
    const double scale = v->ui->scale(v->window);
    const double width = fmin(620 * scale, (double)v->width - 20);
    const cwi_ui_rect rect = {0.5 * ((double)v->width - width), 40 * scale, width,
                              fmax(100, (double)v->height - 80 * scale)};
    if (v->ui->panel_begin(v->window, "Keys", &rect, 0, &v->shown.help)) {
        v->ui->text(v->window,
                    "Left drag: orbit.  Middle or Shift+left: pan.  Right drag, wheel: zoom.\n"
                    "Ctrl+left: shift and opacity.  Double-click: set the cross-hair.\n"
                    "On slices: left moves the cross-hair, right sets black and white,\n"
                    "the wheel changes the slice, Ctrl+wheel zooms.");
        v->ui->rule(v->window);
        for (size_t n = 0; n < view_key_count; n++)
            show_key(v, n);
    }
    v->ui->panel_end(v->window);
}

static void show_about(view *v)
{
    char line[512];
    const double scale = v->ui->scale(v->window);
    const cwi_ui_rect rect = {60 * scale, 60 * scale, 520 * scale, 0};
    if (v->ui->panel_begin(v->window, "About", &rect, 0, &v->shown.about)) {
        snprintf(line, sizeof line, "cubewright %s\nwindow: %s\nscene: %s", cw_version(),
                 v->ui->name(v->window), v->renderer ? cw_renderer_name(v->renderer) : "-");
        v->ui->text(v->window, line);
        v->ui->rule(v->window);
        for (int m = 0; m < CW_MODE_COUNT; m++) {
            snprintf(line, sizeof line, "%s: %s%s%s", cw_mode_name((cw_mode)m),
                     cw_mode_about((cw_mode)m), *cw_mode_source((cw_mode)m) ? ". " : "",
                     cw_mode_source((cw_mode)m));
            v->ui->text(v->window, line);
        }
    }
    v->ui->panel_end(v->window);
}

/* "1.2 ms" and how far refining has come. */
static void show_status(view *v)
{
    static const char *const levels[] = {"...", "rough", "refining", "done"};
    char line[512];
    const view_part *space = &v->parts[VIEW_SPACE];
    const double scale = v->ui->scale(v->window);
    const cwi_ui_rect rect = {2 * scale, (double)v->height - STRIP_HEIGHT * scale, 0, 0};
    snprintf(line, sizeof line, "%s   %s, %.0f ms, %s   %s%s", cli_shown_path(v->path),
             cw_mode_name(v->mode), space->ms, levels[space->level], v->probe,
             v->shown.cut == 1   ? "   wheel cuts x"
             : v->shown.cut == 2 ? "   wheel cuts y"
             : v->shown.cut == 3 ? "   wheel cuts z"
                                 : "");
    v->ui->panel_begin(v->window, "Status", &rect, CWI_UI_BARE, NULL);
    v->ui->text(v->window, line);
    v->ui->panel_end(v->window);
}

static void show_message(view *v)
{
    const double scale = v->ui->scale(v->window);
    const double width = fmin(520 * scale, (double)v->width - 16);
    const cwi_ui_rect rect = {8 * scale, v->bar_height + 8 * scale, width, 0};
    bool open = true;
    if (v->message[0] && v->ui->seconds(v->window) > v->message_until)
        v->message[0] = '\0';
    if (!v->message[0])
        return;
    if (v->ui->panel_begin(v->window, v->is_error ? "Error" : "Note", &rect, 0, &open))
        v->ui->text(v->window, v->message);
    v->ui->panel_end(v->window);
    if (!open)
        v->message[0] = '\0';
}

static void show_nothing(view *v)
{
    static const cwi_ui_color grey = {0.7f, 0.75f, 0.8f, 1};
    const char *text = "Drop a volume, a mesh or a folder here";
    double size[2];
    v->ui->text_size(v->window, text, size);
    v->ui->write(v->window, CWI_UI_BEHIND, 0.5 * ((double)v->width - v->panel_width - size[0]),
                 0.5 * ((double)v->height - size[1]), grey, text);
}

void view_panels(view *v, const cwi_ui_input *in)
{
    (void)in;
    v->bar_height = v->panel_width = 0;
    v->strip_height = v->shown.panels ? STRIP_HEIGHT * v->ui->scale(v->window) : 0;
    if (v->shown.panels) {
        show_bar(v);
        show_side(v);
    }
    if (!v->path)
        show_nothing(v);
    else if (v->shown.panels)
        show_status(v);
    if (v->shown.files)
        view_browse(v);
    if (v->shown.help)
        show_keys(v);
    if (v->shown.about)
        show_about(v);
    show_message(v);
}
