/* Changes settings of a session by name. */
#include "cli/session/view.h"

#include "cli/framework/option_rules.h"
#include "cli/inputs/level_choice.h"
#include "cli/render/compare_options.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const cli_option *view_find_option(const view *v, const char *name)
{
    static const char *const fixed[] = {
        "exec",    "run",        "config",  "hidden",     "output",
        "memory",  "max-voxels", "timeout", "no-sandbox", "allow-external",
        "threads", "size",       "steps",   "step",       "recent"};
    for (size_t n = 0; n < sizeof fixed / sizeof *fixed; n++)
        if (strcmp(fixed[n], name) == 0)
            return NULL;
    for (size_t n = 0; n < v->command->option_count; n++) {
        const cli_option *o = &v->command->options[n];
        if (o->kind != CLI_HEADING && strcmp(o->name, name) == 0)
            return o;
    }
    return NULL;
}

/* An option as on the command line; "off" and "none" take back what was set. */
static cw_status parse_setting(view *v, const cli_option *o, const char *value, cw_error *err)
{
    char *words[1];
    const char *inputs[2] = {0};
    cli_command bare = *v->command;
    render_args *args = &v->state.args;
    const bool flag = o->kind == CLI_FLAG;
    const bool off = value && (strcmp(value, "off") == 0 || strcmp(value, "default") == 0);
    bare.min_inputs = 0;
    if (off && !flag) {
        memcpy((char *)args + o->offset, (const char *)v->command->defaults + o->offset,
               o->kind->size);
        args->common.given[o - v->command->options] = false;
        return CW_OK;
    }
    if (flag && value && !off && strcmp(value, "on") != 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s '%s': on or off was expected", o->name,
                        value);
    if (!flag && !value)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s needs a value: %s", o->name,
                        o->value ? o->value : "a text");
    char *word = malloc(strlen(o->name) + (value ? strlen(value) : 0) + 8);
    if (!word)
        return cwi_fail_memory(err);
    if (flag)
        sprintf(word, off ? "--no-%s" : "--%s", o->name);
    else
        sprintf(word, "--%s=%s", o->name, value);
    words[0] = (char *)view_keep_text(v, word);
    free(word);
    if (!words[0])
        return cwi_fail_memory(err);
    const size_t count = args->common.input_count;
    const char **before = args->common.inputs;
    args->common.input_count = 0;
    cw_status st = cli_parse(&bare, 1, words, args, inputs, err);
    args->common.inputs = before;
    args->common.input_count = count;
    return st;
}

/* Applies the effects of a setting on other parts of the state. */
static cw_status follow_name(view *v, const char *name, cw_error *err)
{
    view_state *s = &v->state;
    if (strcmp(name, "tf") == 0)
        s->is_edited = false;
    if (strcmp(name, "camera") == 0 || strcmp(name, "ortho") == 0 || strcmp(name, "fov") == 0)
        s->is_placed = false;
    if (strcmp(name, "iso") == 0)
        s->iso_is_ours = false;
    if (strcmp(name, "layout") == 0) /* as at the start */
        v->shown.cross = s->args.marks.layout == CLI_LAYOUT_QUAD;
    if (strcmp(name, "iso") == 0 && !s->args.iso.given &&
        s->args.scene.mode == 1 + CW_MODE_MESH && v->document.has_volume)
        s->args.scene.mode = 0;
    if (strcmp(name, "labels") == 0 && s->args.look.labels &&
        !s->args.overlay) { /* they are drawn by themselves */
        s->args.iso = (cli_number){0};
        if (s->args.scene.mode != 1 + CW_MODE_SLICES)
            s->args.scene.mode = 0;
    }
    if (strcmp(name, "iso") == 0 && s->args.iso.given && !s->args.overlay)
        s->args.look.labels = NULL;
    if (strcmp(name, "iso") == 0 && v->document.path &&
        !v->document.source.is_mesh) { /* it may be a name */
        cw_status found =
            cli_choose_level(&v->document.source.volume, &s->args.input, &s->args.iso, err);
        if (found != CW_OK)
            return found;
    }
    v->picture.transfer_is_old = true;
    v->picture.is_measured = false;
    const bool had_labels = v->document.labels.look.labels;
    cw_status st = view_choose_mode(v, err);
    view_touch(v, had_labels || v->document.labels.look.labels || s->args.marks.isolines ||
                          strcmp(name, "isolines") == 0
                      ? VIEW_ALL
                      : 1 << VIEW_SPACE);
    return st == CW_OK ? view_need_labels(v, err) : st;
}

/* Parses --compare of a session. Settings for other modes stay set in a session; only the
 * settings of a side must have an effect. */
cw_status view_parse_split(const view *v, cli_split *split, cw_error *err)
{
    render_args args = v->state.args;
    memset(args.common.given, 0, sizeof args.common.given);
    return cli_parse_split(v->command, &args, split, err);
}

/* Checks settings: returns an error if they could not be drawn. Draws nothing. */
static cw_status try_scene(view *v, cw_error *err)
{
    static const cli_turns one = {0};
    const render_args *args = &v->state.args;
    uint8_t background[2][4];
    cw_scene scene = {.width = 64, .height = 64, .camera = v->state.camera};
    const cli_subject subject = {.volume = view_draws_volume(v) ? cli_drawn(&v->document.source)
                                                                : NULL,
                                 .whole = v->document.source.is_mesh || !v->document.path
                                              ? NULL
                                              : &v->document.source.volume.whole};
    cli_split split = {0};
    if (args->samples > 4)
        return cwi_fail(err, CW_ERR_ARGUMENT, "samples %zu: expected 1 to 4", args->samples);
    if (args->difference.given && !(args->difference.value > 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "difference %g: above 0 was expected",
                        args->difference.value);
    cw_status st = cli_check_camera(&args->scene, &one, err);
    if (st == CW_OK)
        st = cli_background(&args->scene, background, err);
    if (st == CW_OK && v->document.path)
        st = view_need_transfer(v, err);
    if (st == CW_OK && v->document.path)
        st = cli_check_rules(v->command, args, err);
    if (st == CW_OK && v->document.path && (v->state.is_placed || !subject.volume))
        st = cli_make_scene(&args->scene, &subject, v->picture.mode, &v->picture.transfer,
                            &scene, err);
    if (st == CW_OK && args->compare) {
        st = view_parse_split(v, &split, err);
        cli_free_split(&split);
    }
    return st;
}

cw_status view_set(view *v, const char *name, const char *value, cw_error *err)
{
    const cli_option *o = view_find_option(v, name);
    const view_state before = v->state;
    const cw_mode mode = v->picture.mode;
    if (!o)
        return cwi_fail(err, CW_ERR_ARGUMENT, "'%s' is not a setting", name);
    if (v->script.is_configuring && v->state.args.common.given[o - v->command->options])
        return CW_OK; /* the command line takes precedence */
    cw_status st = parse_setting(v, o, value, err);
    if (st == CW_OK)
        st = follow_name(v, name, err);
    if (st == CW_OK)
        st = try_scene(v, err);
    if (st == CW_OK)
        return CW_OK;
    v->state = before;
    v->picture.mode = mode;
    v->picture.transfer_is_old = true;
    return st;
}
