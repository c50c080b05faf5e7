/* Dialogs that save the surface as a mesh, and the session as a picture. */
#include "cli/window/panels.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { MAX_FORMATS = 32 };

/* The formats that this build writes meshes in, by their first extension. */
static size_t list_extensions(char extensions[][16], const char *names[], const char *abouts[])
{
    size_t rows, count = 0;
    const cw_format *all = cw_formats(&rows);
    for (size_t n = 0; n < rows && count < MAX_FORMATS; n++) {
        if (!all[n].writes_mesh || !all[n].in_this_build || all[n].extensions[0] != '.')
            continue;
        snprintf(extensions[count], sizeof extensions[count], "%.*s",
                 (int)strcspn(all[n].extensions, " "), all[n].extensions);
        names[count] = extensions[count];
        abouts[count++] = all[n].about;
    }
    return count;
}

static const char *extension_of(const char *path)
{
    const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.');
    return dot && (!slash || dot > slash) ? dot : path + strlen(path);
}

/* "head.nii.gz" becomes "head.stl", in the folder that the program runs in. */
static void suggest_name(const view *v, char *name, size_t size, const char *extension)
{
    const char *slash = strrchr(v->document.path, '/');
    const char *base = slash && slash[1] ? slash + 1 : v->document.path;
    const size_t length = strcspn(base, ".");
    snprintf(name, size, "%.*s%s", (int)(length ? length : 1), length ? base : "a", extension);
}

static void change_extension(char *name, size_t size, const char *extension)
{
    const size_t length = (size_t)(extension_of(name) - name);
    snprintf(name + length, size - length, "%s", extension);
}

static void warn_of_old(view *v, const char *name)
{
    if (access(name, F_OK) == 0)
        v->ui->text(v->window, "This file exists and would be replaced.");
}

static void show_format(view *v, view_saving *s)
{
    char extensions[MAX_FORMATS][16];
    const char *names[MAX_FORMATS], *abouts[MAX_FORMATS];
    const size_t count = list_extensions(extensions, names, abouts);
    size_t chosen = count;
    for (size_t n = 0; n < count; n++)
        chosen = strcmp(names[n], extension_of(s->mesh_name)) == 0 ? n : chosen;
    if (v->ui->choice(v->window, "Format", names, count, &chosen) && chosen < count)
        change_extension(s->mesh_name, sizeof s->mesh_name, names[chosen]);
    if (chosen < count)
        v->ui->tip(v->window, abouts[chosen]);
}

/* The number of triangles of a choice of their part; 0: all. */
static size_t show_part_choice(view *v, view_saving *s)
{
    static const char *const names[] = {"all triangles", "half of them", "a fifth", "a tenth",
                                        "1 of 50"};
    static const size_t divisors[] = {1, 2, 5, 10, 50};
    v->ui->choice(v->window, "Triangles", names, sizeof names / sizeof *names, &s->part);
    v->ui->tip(v->window, "Fewer triangles are made by simplification; its error is measured");
    return s->part ? view_whole_mesh(v)->triangle_count / divisors[s->part] : 0;
}

static bool are_facts_old(const view *v, size_t triangles)
{
    const view_measured_mesh *m = &v->document.measured;
    return !m->is_known || m->triangles != triangles || m->iso != v->state.args.iso.value;
}

void view_show_save_mesh(view *v)
{
    view_saving *s = &v->widgets->saving;
    const double scale = v->ui->scale(v->window);
    const cwi_ui_rect rect = {60 * scale, 60 * scale, 460 * scale, 0};
    char text[256];
    if (v->document.path && !s->mesh_name[0])
        suggest_name(v, s->mesh_name, sizeof s->mesh_name, ".stl");
    if (v->ui->panel_begin(v->window, "Save mesh", &rect, 0, &v->shown.save_mesh)) {
        bool is_entered = v->ui->input(v->window, "File", s->mesh_name, sizeof s->mesh_name);
        show_format(v, s);
        const size_t triangles = show_part_choice(v, s);
        warn_of_old(v, s->mesh_name);
        v->ui->rule(v->window);
        if (!v->document.path || !view_has_mesh(v)) {
            v->ui->text(v->window, "No surface is shown: choose an isovalue first.");
        } else if (are_facts_old(v, triangles)) {
            if (v->ui->button(v->window, "Measure it"))
                view_ask(v, "measure-mesh %zu", triangles);
            v->ui->tip(v->window, "Size, closedness and error before it is saved");
        } else {
            view_describe_mesh(&v->document.measured.facts, text, sizeof text);
            v->ui->text(v->window, text);
        }
        v->ui->text(v->window, "Cuts are for the picture alone: the whole surface is saved.");
        is_entered |= v->ui->button(v->window, "Save");
        v->ui->same_line(v->window);
        if (v->ui->button(v->window, "Cancel"))
            v->shown.save_mesh = false;
        if (is_entered && s->mesh_name[0] && !strchr(s->mesh_name, '\'')) {
            view_ask(v, "save-mesh '%s' %zu", s->mesh_name, triangles);
            v->shown.save_mesh = false;
        }
    }
    v->ui->panel_end(v->window);
}

void view_show_save_picture(view *v)
{
    static const char *const layouts[] = {"as shown", "single", "quad"};
    static const char *const backgrounds[] = {"as shown", "none"};
    view_saving *s = &v->widgets->saving;
    const double scale = v->ui->scale(v->window);
    const cwi_ui_rect rect = {60 * scale, 60 * scale, 420 * scale, 0};
    if (v->document.path && !s->picture_name[0])
        suggest_name(v, s->picture_name, sizeof s->picture_name, ".png");
    const cwi_ui_rect area = view_picture_area(v);
    if (!(s->picture_size[0] > 0)) {
        s->picture_size[0] = area.width;
        s->picture_size[1] = area.height;
    }
    if (v->ui->panel_begin(v->window, "Save picture", &rect, 0, &v->shown.save_picture)) {
        bool is_entered =
            v->ui->input(v->window, "File", s->picture_name, sizeof s->picture_name);
        v->ui->number(v->window, "Width", &s->picture_size[0], 1, "%.0f pixels");
        v->ui->tip(v->window, "Drag, or double-click to type");
        v->ui->number(v->window, "Height", &s->picture_size[1], 1, "%.0f pixels");
        v->ui->tip(v->window, "Drag, or double-click to type");
        for (int f = 1; f <= 4; f *= 2) {
            char label[32];
            snprintf(label, sizeof label, "%d x the window", f);
            if (f > 1)
                v->ui->same_line(v->window);
            if (v->ui->button(v->window, label)) {
                s->picture_size[0] = f * area.width;
                s->picture_size[1] = f * area.height;
            }
        }
        v->ui->choice(v->window, "Layout", layouts, 3, &s->layout);
        v->ui->choice(v->window, "Background", backgrounds, 2, &s->background);
        warn_of_old(v, s->picture_name);
        for (int a = 0; a < 2; a++)
            s->picture_size[a] = fmin(fmax(round(s->picture_size[a]), 1), 16384);
        is_entered |= v->ui->button(v->window, "Save");
        v->ui->same_line(v->window);
        if (v->ui->button(v->window, "Cancel"))
            v->shown.save_picture = false;
        if (is_entered && s->picture_name[0] && !strchr(s->picture_name, '\'')) {
            const char *now = v->state.args.scene.background;
            if (s->background)
                view_ask(v, "background none");
            view_ask(v, "screenshot '%s' %.0fx%.0f %s", s->picture_name, s->picture_size[0],
                     s->picture_size[1], s->layout ? layouts[s->layout] : "shown");
            if (s->background)
                view_ask(v, "background '%s'", now ? now : "default");
            v->shown.save_picture = false;
        }
    }
    v->ui->panel_end(v->window);
}
