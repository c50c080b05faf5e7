/* The page of a window without a file: files of last time, and samples to try. */
#include "cli/window/panels.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

void view_show_recent(view *v)
{
    size_t shown = 0;
    for (size_t n = 0; n < v->recent.count; n++) {
        const char *path = v->recent.files[n], *slash = strrchr(path, '/');
        char label[VIEW_PATH + 16];
        if (access(path, R_OK) != 0)
            continue; /* it may come back, with the disk that it is on */
        shown++;
        snprintf(label, sizeof label, "%s##recent%zu", slash ? slash + 1 : path, n);
        if (v->ui->item(v->window, label, NULL, false, true)) {
            view_ask_open(v, path);
            v->shown.files = false;
        }
        v->ui->tip(v->window, path);
    }
    if (shown == 0)
        v->ui->text(v->window, "No file yet.");
}

static void show_samples(view *v)
{
    static const struct {
        const char *name, *label, *about;
    } samples[] = {
        {"head", "Head, an MRI", "A real scan, of Debian's package mricron-data"},
        {"ct-head", "Head, a made CT", "Skin, skull and brain in Hounsfield units"},
        {"gyroid", "Gyroid", "A field with handles, whose surface is known on paper"},
        {"torus", "Torus", "A solid with one hole"},
    };
    for (size_t n = 0; n < sizeof samples / sizeof *samples; n++) {
        if (!view_has_sample(samples[n].name))
            continue;
        if (v->ui->button(v->window, samples[n].label))
            view_ask(v, "sample %s", samples[n].name);
        v->ui->tip(v->window, samples[n].about);
    }
}

void view_show_start(view *v)
{
    const double scale = v->ui->scale(v->window);
    const double space = fmax(1, (double)v->layout.width - v->layout.panel_width);
    const double width = fmin(380 * scale, 0.9 * space);
    const cwi_ui_rect rect = {0.5 * (space - width), v->layout.bar_height + 40 * scale, width,
                              0};
    if (v->ui->panel_begin(v->window, "Start", &rect, CWI_UI_FIXED, NULL)) {
        v->ui->text(v->window, "Drop a volume, a mesh or a folder here, or:");
        if (v->ui->button(v->window, "Open..."))
            v->shown.files = true;
        v->ui->rule(v->window);
        v->ui->text(v->window, "Recent");
        view_show_recent(v);
        v->ui->rule(v->window);
        v->ui->text(v->window, "Samples");
        show_samples(v);
    }
    v->ui->panel_end(v->window);
}
