/* Decides whether a picture shows the labels of a label map, and makes what it shows. */
#include "cli/render/label_pictures.h"

#include "cli/framework/console.h"
#include "core/base/status.h"

#include <string.h>

/* Returns the first option given that says how labels are drawn; NULL for none. */
static const char *find_hint(const render_args *args)
{
    return args->look.names          ? "names"
           : args->look.opacity      ? "label-opacity"
           : args->look.smooth.given ? "smooth-labels"
           : args->marks.legend      ? "legend"
                                     : NULL;
}

/* Checks what is asked of labels over slices of another volume. */
static cw_status check_overlay(const render_args *args, cw_error *err)
{
    double opacity;
    const bool is_quad = args->marks.layout == CLI_LAYOUT_QUAD;
    const bool is_slices = args->scene.mode ? args->scene.mode == 1 + CW_MODE_SLICES : !is_quad;
    if (!args->overlay)
        return CW_OK;
    if (!is_slices && !is_quad)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--overlay is drawn over slices: --mode slices or --layout quad");
    if (is_slices && (args->iso.given || args->mesh))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--overlay cannot be combined with --%s",
                        args->mesh ? "mesh" : "iso");
    cw_status st = cli_check_values(&args->values, &args->look, err);
    return st == CW_OK ? cli_overlay_opacity(&args->overlay_opacity, &opacity, err) : st;
}

cw_status cli_check_label_look(const render_args *args, cw_error *err)
{
    const struct {
        bool is_given;
        const char *option;
    } refused[] = {
        {args->iso.given, "--iso"},
        {args->inside != CLI_INSIDE_AUTO, "--inside"},
        {args->mesh != NULL, "--mesh"},
        {args->compare != NULL, "--compare"},
        {args->scene.color != NULL, "--color, for meshes without colours"},
        {args->scene.cap, "--cap, which fills cuts in one colour"},
        {args->scene.transfer != NULL, "--tf"},
        {args->save_transfer != NULL, "--save-tf"},
        {args->input.array.component.magnitude, "--component mag"},
    };
    const bool has_labels = args->look.labels && !args->overlay;
    const int mode = args->scene.mode - 1;
    for (size_t n = 0; n < sizeof refused / sizeof *refused && has_labels; n++)
        if (refused[n].is_given)
            return cwi_fail(err, CW_ERR_ARGUMENT, "--labels cannot be combined with %s",
                            refused[n].option);
    if (has_labels && mode >= 0 && mode != CW_MODE_MESH && mode != CW_MODE_SLICES)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--labels does nothing in the mode %s; it is for mesh, slices",
                        cw_mode_name((cw_mode)mode));
    return check_overlay(args, err);
}

/* Returns true if the options leave it to the volume whether its labels are drawn, and in which
 * mode. */
static bool may_draw_labels(const cli_command *command, const render_args *args,
                            const cli_source *s, cw_mode *mode)
{
    const int requested = args->scene.mode;
    *mode = requested == 1 + CW_MODE_SLICES ? CW_MODE_SLICES : CW_MODE_MESH;
    if (s->is_mesh || s->is_level_set || s->is_uneven || args->iso.given || args->mesh ||
        args->compare || args->scene.hide || args->scene.transfer || args->scene.color ||
        args->scene.cap || args->marks.histogram || args->marks.color_bar ||
        args->input.array.component.magnitude || (requested && *mode != CW_MODE_SLICES))
        return false;
    return cli_check_scene(command, &args->common, *mode, true, NULL) == CW_OK;
}

/* Reads the first step, and finds if it is a label map. */
static cw_status find_labels(cli_pictures *p, cw_mode mode, cw_error *err)
{
    char what[CLI_LABELS_TEXT];
    cli_source *s = &p->source;
    s->of_labels = s->is_label_map;
    cw_status st = cli_read_step(s, &p->args->input, 0, err);
    if (st == CW_OK)
        st = cli_looks_like_labels(&s->volume, what, err);
    if (st != CW_OK || !*what)
        return st;
    cli_say("%s: %s: its labels are drawn; %s draws its numbers", s->volume.path, what,
            mode == CW_MODE_SLICES ? "--tf window" : "--mode composite");
    p->look.labels = "all";
    p->mode = mode;
    return CW_OK;
}

/* Labels of another volume are all, unless some are chosen. */
static cw_status decide_overlay(cli_pictures *p, cw_error *err)
{
    const render_args *args = p->args;
    if (p->source.is_mesh)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s is a mesh; --overlay is for volumes",
                        args->common.inputs[0]);
    p->look.labels = p->look.labels ? p->look.labels : "all";
    if (!args->scene.mode && args->marks.layout != CLI_LAYOUT_QUAD)
        p->mode = CW_MODE_SLICES;
    return CW_OK;
}

cw_status cli_decide_labels(cli_pictures *p, cw_error *err)
{
    const render_args *args = p->args;
    const char *hint = find_hint(args);
    cw_mode mode;
    cw_status st = CW_OK;
    p->look = args->look;
    if (args->overlay)
        return decide_overlay(p, err);
    if (p->look.labels && p->source.is_mesh)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s is a mesh; --labels is for volumes",
                        args->common.inputs[0]);
    if (p->look.labels && !args->scene.mode)
        p->mode = CW_MODE_MESH;
    else if (!p->look.labels && may_draw_labels(p->command, args, &p->source, &mode))
        st = find_labels(p, mode, err);
    p->source.of_labels = p->look.labels;
    if (st == CW_OK && p->look.labels && p->mode == CW_MODE_SLICES) {
        p->transfer = cli_black_transfer();
        p->has_transfer = true;
    }
    if (st == CW_OK && hint && !p->look.labels)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--%s is for labels, and none are drawn: --labels all", hint);
    return st;
}

/* Finds the colours of an overlay that is no label map. */
static cw_status open_values(cli_pictures *p, cw_error *err)
{
    const render_args *args = p->args;
    double range[2] = {0};
    cw_status st = CW_OK;
    if (args->marks.legend || args->look.smooth.given)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--%s is for labels, and %s is drawn as values: --labels all",
                        args->marks.legend ? "legend" : "smooth-labels", p->overlay.path);
    if (args->values.range.count == 0)
        st = cli_overlay_range(&p->overlay, (int)args->input.threads, range, err);
    if (st == CW_OK)
        st = cli_make_values(&p->overlay, &args->values, range, &args->overlay_opacity,
                             &p->on_slices, err);
    if (st == CW_OK)
        cli_say("%s: values from %.5g to %.5g in %s", p->overlay.path, p->on_slices.values.low,
                p->on_slices.values.high, cw_colormap_name(p->on_slices.values.map));
    return st;
}

/* Reads the overlay once, for all steps. */
static cw_status open_overlay(cli_pictures *p, cw_error *err)
{
    static const cli_input all;
    double opacity;
    char what[CLI_LABELS_TEXT];
    if (p->overlay.path)
        return CW_OK;
    cw_status st = cli_overlay_opacity(&p->args->overlay_opacity, &opacity, err);
    if (st == CW_OK)
        st = cli_read_overlay(p->args->overlay, &p->args->input, &p->overlay, err);
    if (st == CW_OK)
        st = cli_looks_like_labels(&p->overlay, what, err);
    if (st == CW_OK && !cli_overlay_is_labels(*what, &p->args->values, &p->args->look))
        return open_values(p, err);
    if (st == CW_OK)
        st = cli_find_shown_labels(&p->look, &all, 0, &p->overlay, &p->labels, err);
    p->on_slices = (cli_slice_labels){
        .volume = &p->overlay, .input = &all, .shown = &p->labels.shown, .opacity = opacity};
    return st;
}

cw_status cli_open_labels(cli_pictures *p, size_t step, cw_error *err)
{
    const cli_input *input = &p->args->input;
    cli_volume *volume = &p->source.volume;
    const size_t at = p->source.series.moments[step].step;
    if (p->args->overlay)
        return open_overlay(p, err);
    cw_status st = cli_find_shown_labels(&p->look, input, at, volume, &p->labels, err);
    p->on_slices = (cli_slice_labels){.volume = volume,
                                      .input = input,
                                      .step = at,
                                      .shown = &p->labels.shown,
                                      .opacity = 1,
                                      .is_base = true};
    if (st != CW_OK || p->mode != CW_MODE_MESH)
        return st;
    cw_mesh_free(&p->source.mesh);
    return cli_make_label_mesh(input, at, volume, &p->labels, &p->source.mesh, err);
}

bool cli_labels_need_gl(const cli_label_scene *labels)
{
    for (size_t n = 0; n < labels->shown.count; n++) {
        const cw_label *label = &labels->shown.labels[n];
        if (!label->hidden && label->color[3] > 0 && label->color[3] < 255)
            return true;
    }
    return false;
}
