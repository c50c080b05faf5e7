/* Runs commands by name: the only entry for keys, menus, widgets, the mouse and scripts. */
#include "cli/session/verbs.h"

#include "core/base/status.h"
#include "core/base/text.h"

#include <math.h>
#include <string.h>

cw_status view_take(const char *verb, char **args, int count, double *numbers, cw_error *err)
{
    for (int n = 0; n < count; n++) {
        const char *text = args[n];
        if (!cwi_parse_double(&text, &numbers[n]) || *text || !isfinite(numbers[n]))
            return cwi_fail(err, CW_ERR_ARGUMENT, "%s '%s': a number was expected", verb,
                            args[n]);
    }
    return CW_OK;
}

cw_status view_need_open(const view *v, cw_error *err)
{
    return v->document.path ? CW_OK : cwi_fail(err, CW_ERR_ARGUMENT, "nothing is open");
}

cw_status view_need_volume(const view *v, cw_error *err)
{
    return v->document.has_volume
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT, "no volume on an even grid is open");
}

cw_status view_need_camera(view *v, cw_error *err)
{
    cw_status st = view_need_open(v, err);
    if (st == CW_OK && !v->state.is_placed)
        st = view_place_camera(v, NULL, err);
    view_touch(v, 1 << VIEW_SPACE);
    return st;
}

cw_status view_frame(view *v, double wait_s, cw_error *err)
{
    return v->show_frame(v, wait_s, err);
}

cw_status view_take_in(view *v, cw_error *err)
{
    cw_status st = view_frame(v, 0, err);
    while (st == CW_OK && (v->ui->pending(v->window) || v->script.queued_count) && !v->quits)
        st = view_frame(v, 0, err);
    for (int n = 0; n < 3 && st == CW_OK && v->ui->focused(v->window); n++)
        st = view_frame(v, 0, err); /* the widget that has the keys follows them */
    return st;
}

/* Twice more in the end: widgets that show what has been drawn. */
cw_status view_settle(view *v, cw_error *err)
{
    cw_status st = view_take_in(v, err);
    while (st == CW_OK && !view_is_final(v) && !v->quits)
        st = view_frame(v, 0, err);
    for (int n = 0; n < 2 && st == CW_OK; n++)
        st = view_frame(v, 0, err);
    return st;
}

const view_verb *view_verb_at(size_t n)
{
    static const view_verbs *const lists[] = {
        &view_files_verbs,  &view_scene_verbs, &view_window_verbs,
        &view_camera_verbs, &view_curve_verbs, &view_measure_verbs,
        &view_pieces_verbs, &view_save_verbs,  &view_script_verbs};
    for (size_t l = 0; l < sizeof lists / sizeof *lists; n -= lists[l++]->count)
        if (n < lists[l]->count)
            return &lists[l]->rows[n];
    return NULL;
}

/* The monkey finds neither files to write nor others to open, nor the way out: not by keys, not
 * by menus. */
static bool may_run(const view *v, const char *name)
{
    static const char *const barred[] = {"screenshot", "turntable", "save-state",
                                         "quit",       "next",      "previous",
                                         "save-mesh",  "film",      "save-film"};
    for (size_t n = 0; v->input.is_monkey && n < sizeof barred / sizeof *barred; n++)
        if (strcmp(name, barred[n]) == 0)
            return false;
    return true;
}

static const view_verb *find_verb(const char *name)
{
    const view_verb *verb = NULL;
    for (size_t n = 0; (verb = view_verb_at(n)) && strcmp(verb->name, name) != 0; n++)
        ;
    return verb;
}

static cw_status fail_unknown(const view *v, const char *name, cw_error *err)
{
    const char *names[256] = {0};
    size_t count = 0;
    for (size_t n = 0; view_verb_at(n) && count < 255; n++)
        names[count++] = view_verb_at(n)->name;
    for (size_t n = 0; n < v->command->option_count && count < 255; n++)
        if (view_find_option(v, v->command->options[n].name))
            names[count++] = v->command->options[n].name;
    const char *nearest = cli_nearest(name, names);
    return nearest ? cwi_fail(err, CW_ERR_ARGUMENT, "'%s' is not a command; did you mean '%s'?",
                              name, nearest)
                   : cwi_fail(err, CW_ERR_ARGUMENT,
                              "'%s' is not a command; 'cubewright help view' lists them", name);
}

cw_status view_run(view *v, int count, char **words, cw_error *err)
{
    const view_verb *verb = find_verb(words[0]);
    const bool is_setting = !verb && view_find_option(v, words[0]);
    if (!verb && !is_setting)
        return fail_unknown(v, words[0], err);
    const int min_count = verb ? verb->min_count : 0, max_count = verb ? verb->max_count : 1;
    if (count - 1 < min_count || count - 1 > max_count)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s takes %s, not %d words", words[0],
                        verb ? verb->takes : "one value", count - 1);
    if (!may_run(v, words[0]))
        return CW_OK;
    if (v->film.preview && !v->film.is_running && strcmp(words[0], "play-film") != 0)
        view_stop_preview(v); /* somebody wants something else */
    cw_status st = verb ? verb->run(v, count - 1, words + 1, err)
                        : view_set(v, words[0], count > 1 ? words[1] : NULL, err);
    if (st != CW_OK || !v->document.path || v->film.is_running)
        return st;
    if (is_setting || verb->changes)
        view_remember(v, words[0]);
    if (strncmp(words[0], "camera-", strlen("camera-")) != 0)
        view_note_camera(v, words[0]);
    return CW_OK;
}
