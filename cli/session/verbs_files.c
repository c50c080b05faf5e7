/* Commands that open files and samples, and go through steps. */
#define _GNU_SOURCE /* scandir, strverscmp */
#include "cli/session/verbs.h"

#include "cli/inputs/synthetic_input.h"
#include "core/base/status.h"

#include <dirent.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* --- samples: a head that a package of Debian has, and made fields ------------------------- */

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

bool view_has_sample(const char *name)
{
    return strcmp(name, "head") != 0 || access(head_path, R_OK) == 0;
}

cw_status view_open_sample(view *v, const char *name, cw_error *err)
{
    char path[VIEW_PATH];
    cli_made_field s;
    if (strcmp(name, "head") == 0 && view_has_sample(name))
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

/* --- folders -------------------------------------------------------------------------------- */

static int is_plain(const struct dirent *e)
{
    return e->d_name[0] != '.';
}

static int by_version(const struct dirent **a, const struct dirent **b)
{
    return strverscmp((*a)->d_name, (*b)->d_name);
}

int view_scan(const char *folder, struct dirent ***entries)
{
    *entries = NULL;
    return scandir(folder, entries, is_plain, by_version);
}

void view_free_scan(struct dirent **entries, int count)
{
    for (int n = 0; n < count; n++)
        free(entries[n]);
    free(entries);
}

/* --- the commands ---------------------------------------------------------------------------- */

static cw_status run_open(view *v, int count, char **args, cw_error *err)
{
    return view_open(v, (const char *const *)args, (size_t)count, err);
}

static cw_status run_sample(view *v, int count, char **args, cw_error *err)
{
    (void)count;
    return view_open_sample(v, args[0], err);
}

static cw_status run_quit(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args, (void)err;
    v->quits = true;
    return CW_OK;
}

/* Opens the next readable file of the folder, in natural order; the first follows the last. */
static cw_status open_near(view *v, int by, cw_error *err)
{
    struct dirent **list;
    const char *slash = v->document.path ? strrchr(v->document.path, '/') : NULL;
    char folder[4096] = ".", path[8192];
    cw_status st = view_need_open(v, err);
    if (st != CW_OK)
        return st;
    if (slash)
        snprintf(folder, sizeof folder, "%.*s", (int)(slash - v->document.path + 1),
                 v->document.path);
    const char *own = slash ? slash + 1 : v->document.path;
    const int count = view_scan(folder, &list);
    int at = 0;
    while (at < count && strcmp(list[at]->d_name, own) != 0)
        at++;
    st = cwi_fail(err, CW_ERR_ARGUMENT, "%s: its folder has no other file to open",
                  v->document.path);
    for (int n = 1; n < count && at < count && st != CW_OK; n++) {
        struct stat info;
        cw_volume shape = {0};
        const char *name = list[((at + by * n) % count + count) % count]->d_name;
        snprintf(path, sizeof path, slash ? "%s%s" : "%.0s%s", folder, name);
        const bool readable =
            stat(path, &info) == 0 &&
            (cw_mesh_format(path, NULL) ||
             cli_read_shape(path, &v->state.args.input, &shape, NULL) == CW_OK);
        cw_volume_free(&shape);
        if (readable)
            st = view_open(v, (const char *const[]){path}, 1, err);
    }
    view_free_scan(list, count);
    return st;
}

static cw_status run_next(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    return open_near(v, 1, err);
}

static cw_status run_previous(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    return open_near(v, -1, err);
}

static cw_status run_step(view *v, int count, char **args, cw_error *err)
{
    const size_t steps = v->document.source.series.count;
    double n = 0;
    (void)count;
    cw_status st = view_need_open(v, err);
    if (st != CW_OK || steps < 2)
        return st == CW_OK
                   ? cwi_fail(err, CW_ERR_ARGUMENT, "%s has no other steps", v->document.path)
                   : st;
    if (strcmp(args[0], "next") == 0)
        n = (double)((v->state.step + 1) % steps);
    else if (strcmp(args[0], "previous") == 0)
        n = (double)((v->state.step + steps - 1) % steps);
    else
        st = view_take("step", args, 1, &n, err);
    if (st == CW_OK && (n < 0 || n != floor(n)))
        return cwi_fail(err, CW_ERR_ARGUMENT, "step '%s': a whole number was expected",
                        args[0]);
    return st == CW_OK ? view_go_to_step(v, (size_t)n, err) : st;
}

static const view_verb rows[] = {
    VERB("open", "PATH...", "Open a file, a folder, or the files of a series", 1, INT_MAX,
         run_open),
    VERB("sample", "NAME", "Open a sample: head (Debian's MRI), or a field of 'make'", 1, 1,
         run_sample),
    VERB("next", "", "Open the next file of the folder", 0, 0, run_next),
    VERB("previous", "", "Open the previous file of the folder", 0, 0, run_previous),
    VERB("step", "N|next|previous", "Go to a step of a time series", 1, 1, run_step),
    VERB("quit", "", "Close the window", 0, 0, run_quit),
};
const view_verbs view_files_verbs = {rows, sizeof rows / sizeof *rows};
