/* The page of a window without a file: files of last time, and samples to try. */
#define _GNU_SOURCE /* mkdtemp */
#include "cli/view/view.h"

#include "cli/framework/console.h"
#include "cli/inputs/synthetic_input.h"
#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SAMPLE_EDGE = 96 };

/* The head MRI of Debian's package mricron-data. */
static const char head_path[] = "/usr/share/mricron/templates/ch2.nii.gz";

/* Samples are files, so that a saved session finds them again. */
static cw_status find_sample_path(const char *name, char path[VIEW_PATH], cw_error *err)
{
    const char *home = getenv("HOME"), *cache = getenv("XDG_CACHE_HOME");
    const bool has_cache = cache && *cache;
    char folder[VIEW_PATH - 80];
    if (!has_cache && !(home && *home))
        return cwi_fail(err, CW_ERR_OUTPUT, "sample %s: HOME is not set", name);
    snprintf(folder, sizeof folder, "%s%s", has_cache ? cache : home,
             has_cache ? "" : "/.cache");
    (void)mkdir(folder, 0700);
    snprintf(path, VIEW_PATH, "%s/cubewright", folder);
    (void)mkdir(path, 0700);
    snprintf(path, VIEW_PATH, "%s/cubewright/%s.nrrd", folder, name);
    return CW_OK;
}

static cw_status make_sample(const view *v, cw_field field, const char *path, cw_error *err)
{
    const size_t dim[3] = {SAMPLE_EDGE, SAMPLE_EDGE, SAMPLE_EDGE};
    cli_volume volume = {0};
    cw_status st = cli_make_field(field, dim, &v->state.args.input, &volume, err);
    if (st == CW_OK)
        st = cw_volume_write(path, &volume.view, NULL, err);
    cli_free_volume(&volume);
    return st;
}

cw_status view_open_sample(view *v, const char *name, cw_error *err)
{
    char path[VIEW_PATH];
    cli_made_field s;
    if (strcmp(name, "head") == 0 && access(head_path, R_OK) == 0)
        return view_open(v, (const char *const[]){head_path}, 1, err);
    if (strcmp(name, "head") == 0)
        return cwi_fail(err, CW_ERR_IO, "%s: no such file; apt-get install mricron-data",
                        head_path);
    for (size_t n = 0; cli_made_field_at(n, &s); n++) {
        if (s.hard || s.is_label_map || strcmp(s.name, name) != 0)
            continue;
        cw_status st = find_sample_path(name, path, err);
        if (st == CW_OK && access(path, R_OK) != 0)
            st = make_sample(v, (cw_field)s.number, path, err);
        return st == CW_OK ? view_open(v, (const char *const[]){path}, 1, err) : st;
    }
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "sample '%s': head, or a field of 'cubewright make --list' was expected",
                    name);
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
        if (strcmp(samples[n].name, "head") == 0 && access(head_path, R_OK) != 0)
            continue;
        if (v->ui->button(v->window, samples[n].label))
            view_ask(v, "sample %s", samples[n].name);
        v->ui->tip(v->window, samples[n].about);
    }
}

void view_show_start(view *v)
{
    const double scale = v->ui->scale(v->window);
    const double space = fmax(1, (double)v->width - v->panel_width);
    const double width = fmin(380 * scale, 0.9 * space);
    const cwi_ui_rect rect = {0.5 * (space - width), v->bar_height + 40 * scale, width, 0};
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
