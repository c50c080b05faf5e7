/* The command `window`: greys of slices by numbers, by the names of radiology, or by the values. */
#include "cli/inputs/level_choice.h"
#include "cli/session/verbs.h"

#include "core/base/status.h"
#include "core/volume/named_level.h"

#include <stdio.h>
#include <string.h>

/* Windows by name: width and level in Hounsfield units, as usual on consoles. */
static const struct {
    const char *name;
    double width, level;
} windows[] = {{"brain", 80, 40},        {"stroke", 40, 40},      {"subdural", 200, 75},
               {"bone", 2000, 400},      {"temporal", 2800, 600}, {"soft-tissue", 400, 40},
               {"mediastinum", 350, 50}, {"lung", 1500, -600},    {"abdomen", 400, 50},
               {"liver", 150, 30},       {"spine", 250, 50},      {"angio", 600, 300}};

enum { WINDOWS = sizeof windows / sizeof *windows };

const char *view_window_name(size_t n, double range[2])
{
    if (n >= WINDOWS)
        return NULL;
    range[0] = windows[n].level - 0.5 * windows[n].width;
    range[1] = windows[n].level + 0.5 * windows[n].width;
    return windows[n].name;
}

bool view_is_hounsfield(const view *v)
{
    return v->document.has_volume &&
           cwi_is_hounsfield(&v->document.source.volume.whole, &v->document.statistics);
}

static cw_status find_window(const view *v, const char *name, double range[2], cw_error *err)
{
    const char *names[WINDOWS + 2] = {[WINDOWS] = "auto"};
    for (size_t n = 0; n < WINDOWS; n++) {
        names[n] = view_window_name(n, range);
        if (strcmp(name, names[n]) != 0)
            continue;
        return view_is_hounsfield(v)
                   ? CW_OK
                   : cwi_fail(err, CW_ERR_ARGUMENT,
                              "window %s is in Hounsfield units, and these values are not: "
                              "'window LOW HIGH'",
                              name);
    }
    const char *nearest = cli_nearest(name, names);
    return nearest
               ? cwi_fail(err, CW_ERR_ARGUMENT, "window '%s': did you mean '%s'?", name,
                          nearest)
               : cwi_fail(err, CW_ERR_ARGUMENT,
                          "window '%s': LOW HIGH, auto, or a name such as bone was expected",
                          name);
}

static cw_status run_window(view *v, int count, char **args, cw_error *err)
{
    double n[2] = {0};
    cw_status st = CW_OK;
    if (count == 2)
        st = view_take("window", args, count, n, err);
    else if (strcmp(args[0], "auto") != 0)
        st = find_window(v, args[0], n, err);
    if (st == CW_OK && count == 2 && !(n[0] < n[1]))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "window %s %s: rising values were expected",
                      args[0], args[1]);
    if (st == CW_OK)
        memcpy(v->state.window, n, sizeof n);
    view_touch(v, VIEW_SLICES);
    return st;
}

static const view_verb rows[] = {
    EDIT("window", "LOW HIGH | NAME | auto",
         "Set the values that are black and white in slices, or in Hounsfield units: brain, "
         "stroke, subdural, bone, temporal, soft-tissue, mediastinum, lung, abdomen, liver, "
         "spine, angio; auto: by the values",
         1, 2, run_window),
};
const view_verbs view_window_verbs = {rows, sizeof rows / sizeof *rows};
