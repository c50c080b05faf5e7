/* Menus, panels and what is written on the window. Widgets ask for commands. */
#include "cli/window/panels.h"
#include "cli/session/view_measure.h"

#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STRIP_PADDING = 9 }; /* of panels, above and below the text */

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
    static const char *const menus[] = {"File",    "Edit", "View", "Scene",
                                        "Measure", "Time", "Help"};
    v->layout.bar_height = v->ui->bar_begin(v->window);
    for (size_t n = 0; n < sizeof menus / sizeof *menus; n++)
        show_menu(v, menus[n]);
    v->ui->bar_end(v->window);
}

/* Shows the keys of a row and what they do, in one of two columns. */
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
    const double width = fmin(620 * scale, (double)v->layout.width - 20);
    const cwi_ui_rect rect = {0.5 * ((double)v->layout.width - width), 40 * scale, width,
                              fmax(100, (double)v->layout.height - 80 * scale)};
    if (v->ui->panel_begin(v->window, "Keys", &rect, 0, &v->shown.help)) {
        v->ui->text(v->window,
                    "Left drag: orbit.  Middle or Shift+left: pan.  Right drag, wheel: zoom.\n"
                    "Ctrl+left: shift and opacity.  Double-click: set the cross-hair.\n"
                    "On slices: left moves the cross-hair, right sets black and white,\n"
                    "the wheel changes the slice, Ctrl+wheel zooms.\n"
                    "While something is measured, clicks add its points; Escape stops.");
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
                 v->ui->name(v->window),
                 v->picture.renderer ? cw_renderer_name(v->picture.renderer) : "-");
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

static bool fits_line(const view *v, const char *line, double width)
{
    double size[2];
    v->ui->text_size(v->window, line, size);
    return size[0] <= width;
}

/* "1.2 ms" and how far refining has come, in one line: where there is no room the value under
 * the mouse stays longest. */
static void describe_status(const view *v, char *line, size_t size, double width)
{
    static const char *const levels[] = {"...", "rough", "refining", "done"};
    const view_part *space = &v->picture.parts[VIEW_SPACE];
    const char *path = cli_shown_path(v->document.path), *slash = strrchr(path, '/');
    const char *wheel = v->shown.cut == 1   ? "   wheel cuts x"
                        : v->shown.cut == 2 ? "   wheel cuts y"
                        : v->shown.cut == 3 ? "   wheel cuts z"
                                            : "";
    char state[64], tool[96];
    view_tool_hint(v, tool, sizeof tool);
    if (*tool)
        wheel = tool;
    snprintf(state, sizeof state, "%s, %.0f ms, %s", cw_mode_name(v->picture.mode), space->ms,
             levels[space->level]);
    snprintf(line, size, "%s   %s   %s%s", path, state, v->input.probe, wheel);
    if (!fits_line(v, line, width) && slash)
        snprintf(line, size, "%s   %s   %s%s", slash + 1, state, v->input.probe, wheel);
    if (!fits_line(v, line, width))
        snprintf(line, size, "%s   %s%s", state, v->input.probe, wheel);
    if (!fits_line(v, line, width))
        snprintf(line, size, "%s%s", v->input.probe, wheel);
    for (size_t length = strlen(line); length > 0 && !fits_line(v, line, width);)
        line[--length] = '\0';
}

/* The strip below the pictures: the state, and for some seconds a note in its place. It has one
 * line; a longer note covers some of the picture, and without panels each note does. */
static void show_strip(view *v)
{
    char line[VIEW_MESSAGE] = "";
    const double padding = floor(STRIP_PADDING * v->ui->scale(v->window));
    double letter[2];
    v->ui->text_size(v->window, "A", letter);
    const double height = letter[1] + 2 * padding;
    const double width = fmax(1, (double)v->layout.width - v->layout.panel_width);
    const cwi_ui_rect rect = {0, (double)v->layout.height - height, width, height};
    v->layout.strip_height = v->shown.panels ? height : 0;
    if (v->message.text[0] && !v->message.is_error)
        snprintf(line, sizeof line, "%s", v->message.text);
    else if (v->document.path && v->shown.panels)
        describe_status(v, line, sizeof line, width - 3 * padding);
    if (!v->shown.panels && !line[0])
        return;
    v->ui->panel_begin(v->window, "Status", &rect, CWI_UI_STRIP, NULL);
    v->ui->text(v->window, line);
    v->ui->panel_end(v->window);
}

static void show_error(view *v)
{
    const double scale = v->ui->scale(v->window);
    const double width = fmin(520 * scale, (double)v->layout.width - 16);
    const cwi_ui_rect rect = {8 * scale, v->layout.bar_height + 8 * scale, width, 0};
    bool open = true;
    if (!v->message.text[0] || !v->message.is_error)
        return;
    if (v->ui->panel_begin(v->window, "Error", &rect, 0, &open))
        v->ui->text(v->window, v->message.text);
    v->ui->panel_end(v->window);
    if (!open)
        v->message.text[0] = '\0';
}

void view_panels(view *v)
{
    v->layout.bar_height = v->layout.panel_width = v->layout.strip_height = 0;
    if (v->message.text[0] && v->ui->seconds(v->window) > v->message.until)
        v->message.text[0] = '\0';
    if (v->shown.panels) {
        show_bar(v);
        view_show_side(v);
    }
    show_strip(v);
    if (!v->document.path)
        view_show_start(v);
    if (v->shown.files)
        view_browse(v);
    if (v->shown.gallery && v->document.has_volume)
        view_show_gallery(v);
    if (v->shown.save_mesh)
        view_show_save_mesh(v);
    if (v->shown.save_picture)
        view_show_save_picture(v);
    if (v->shown.help)
        show_keys(v);
    if (v->shown.about)
        show_about(v);
    show_error(v);
}
