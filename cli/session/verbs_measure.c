/* Commands that measure. */
#include "cli/session/verbs.h"
#include "cli/session/view_measure.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_WORDS = 3 * VIEW_POLYGON + 1 };

static cw_status read_kind(const char *verb, const char *word, view_measure_kind *kind,
                           cw_error *err)
{
    for (int k = VIEW_MEASURE_DISTANCE; k <= VIEW_MEASURE_AREA; k++)
        if (strcmp(word, view_measure_name((view_measure_kind)k)) == 0) {
            *kind = (view_measure_kind)k;
            return CW_OK;
        }
    return cwi_fail(err, CW_ERR_ARGUMENT, "%s '%s': distance, angle, area or off was expected",
                    verb, word);
}

/* Removes one measurement by its number, or all. */
static cw_status remove_measures(view *v, int count, char **args, cw_error *err)
{
    double n = 0;
    view_state *s = &v->state;
    cw_status st = count > 1 ? view_take("measure off", args + 1, 1, &n, err) : CW_OK;
    if (st == CW_OK && count > 2)
        st = cwi_fail(err, CW_ERR_ARGUMENT, "measure off: one number was expected");
    if (st == CW_OK && count > 1 && !(n >= 1 && n <= (double)s->measure_count && n == floor(n)))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "measure off %s: there are %zu measurements",
                      args[1], s->measure_count);
    if (st != CW_OK)
        return st;
    if (count == 1)
        s->measure_count = 0;
    else
        memmove(s->measures + (size_t)n - 1, s->measures + (size_t)n,
                (s->measure_count-- - (size_t)n) * sizeof *s->measures);
    return CW_OK;
}

/* Each measurement is a change of its own, also where a script makes several. */
static cw_status run_measure(view *v, int count, char **args, cw_error *err)
{
    view_measure_kind kind = VIEW_MEASURE_NONE;
    double numbers[MAX_WORDS][3];
    cw_status st = view_need_open(v, err);
    v->input.gesture++;
    if (st == CW_OK && strcmp(args[0], "off") == 0)
        return remove_measures(v, count, args, err);
    if (st == CW_OK)
        st = read_kind("measure", args[0], &kind, err);
    if (st == CW_OK && (count - 1) % 3 != 0)
        st = cwi_fail(err, CW_ERR_ARGUMENT,
                      "measure %s: points of three numbers were expected, not %d numbers",
                      args[0], count - 1);
    if (st == CW_OK)
        st = view_take("measure", args + 1, count - 1, numbers[0], err);
    return st == CW_OK ? view_add_measure(v, kind, (const double(*)[3])numbers,
                                          (size_t)(count - 1) / 3, err)
                       : st;
}

static cw_status run_tool(view *v, int count, char **args, cw_error *err)
{
    view_measure_kind kind = VIEW_MEASURE_NONE;
    (void)count;
    cw_status st = view_need_open(v, err);
    if (st == CW_OK && strcmp(args[0], "off") != 0)
        st = read_kind("measure-tool", args[0], &kind, err);
    if (st == CW_OK)
        view_choose_tool(v, kind);
    return st;
}

static cw_status run_point(view *v, int count, char **args, cw_error *err)
{
    double point[3];
    cw_status st = view_take("measure-point", args, count, point, err);
    if (st == CW_OK)
        st = view_need_open(v, err);
    return st == CW_OK ? view_add_tool_point(v, point, err) : st;
}

static cw_status run_pick(view *v, int count, char **args, cw_error *err)
{
    double pixel[2];
    cw_picked picked = {0};
    cw_status st = view_take("measure-pick", args, count, pixel, err);
    if (st == CW_OK)
        st = view_need_open(v, err);
    if (st == CW_OK && v->state.args.compare)
        st = cwi_fail(err, CW_ERR_ARGUMENT,
                      "measure-pick: a comparison shows two things; measure in slices");
    if (st == CW_OK && v->picture.parts[VIEW_SPACE].level == VIEW_STALE)
        st = cwi_fail(err, CW_ERR_ARGUMENT, "measure-pick: the scene is not drawn yet");
    if (st == CW_OK)
        st = view_pick_point(v, pixel, &picked, err);
    if (st != CW_OK)
        return st;
    if (picked.kind != CW_PICK_NOTHING)
        return view_add_tool_point(v, picked.point, err);
    view_say(v, false, "nothing is seen there to be measured");
    return CW_OK;
}

static cw_status run_end(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    return view_end_tool(v, err);
}

static cw_status run_copy(view *v, int count, char **args, cw_error *err)
{
    char *text;
    size_t size;
    (void)count, (void)args;
    FILE *out = cwi_text_open(&text, &size);
    if (out)
        view_print_measures(v, out);
    if (!out || !cwi_text_close(out, &text))
        return cwi_fail_memory(err);
    v->ui->set_clipboard(v->window, text);
    view_say(v, false, "the measurements are copied");
    free(text);
    return CW_OK;
}

static const view_verb rows[] = {
    EDIT("measure", "distance|angle|area X Y Z ... | off [N]",
         "Measure between points in LPS mm: 2, 3 (the corner second), or 3 and more around an "
         "area; off removes one or all",
         1, MAX_WORDS, run_measure),
    VERB("measure-tool", "distance|angle|area|off", "Measure by clicks; again: stop", 1, 1,
         run_tool),
    VERB("measure-point", "X Y Z", "Add a point to what is being measured, in LPS mm", 3, 3,
         run_point),
    VERB("measure-pick", "X Y", "Add the point that a pixel of the scene shows", 2, 2,
         run_pick),
    VERB("measure-end", "", "Close the area that is being measured", 0, 0, run_end),
    VERB("copy-measurements", "", "Copy all measurements as text", 0, 0, run_copy),
};
const view_verbs view_measure_verbs = {rows, sizeof rows / sizeof *rows};
