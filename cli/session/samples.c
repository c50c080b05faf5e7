/* Opens samples: a head that a package of Debian has, and made fields. */
#include "cli/session/view.h"

#include "cli/inputs/synthetic_input.h"
#include "core/base/status.h"

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
