/* Decides whether a picture shows the labels of a label map, and makes what it shows. */
#include "cli/render/label_pictures.h"

#include "cli/framework/console.h"
#include "core/base/status.h"

#include <string.h>

/* Returns the first option given that says how labels are drawn; NULL for none. */
static const char *find_hint(const render_args *args)
{
    return args->look.names     ? "names"
           : args->look.opacity ? "label-opacity"
           : args->look.smooth  ? "smooth-labels"
                                : NULL;
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
        {args->input.component.magnitude, "--component mag"},
    };
    const int mode = args->scene.mode - 1;
    for (size_t n = 0; n < sizeof refused / sizeof *refused && args->look.labels; n++)
        if (refused[n].is_given)
            return cwi_fail(err, CW_ERR_ARGUMENT, "--labels cannot be combined with %s",
                            refused[n].option);
    if (args->look.labels && mode >= 0 && mode != CW_MODE_MESH && mode != CW_MODE_SLICES)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--labels does nothing in the mode %s; it is for mesh, slices",
                        cw_mode_name((cw_mode)mode));
    return CW_OK;
}

/* Returns true if the options leave it to the volume whether its labels are drawn, and in which
 * mode. */
static bool may_draw_labels(const cli_command *command, const render_args *args,
                            const cli_source *s, cw_mode *mode)
{
    const int asked = args->scene.mode;
    *mode = asked == 1 + CW_MODE_SLICES ? CW_MODE_SLICES : CW_MODE_MESH;
    if (s->is_mesh || s->is_level_set || s->is_uneven || args->iso.given || args->mesh ||
        args->compare || args->scene.hide || args->scene.transfer || args->scene.color ||
        args->scene.cap || args->marks.histogram || args->marks.color_bar ||
        args->input.component.magnitude || (asked && *mode != CW_MODE_SLICES))
        return false;
    return cli_check_scene(command, &args->common, *mode, true, NULL) == CW_OK;
}

/* Reads the first step, and finds if it is a label map. */
static cw_status find_labels(cli_pictures *p, cw_mode mode, cw_error *err)
{
    char what[160];
    cli_source *s = &p->source;
    s->of_labels = s->is_label_map;
    cw_status st = cli_read_step(s, &p->args->input, 0, err);
    if (st == CW_OK)
        st = cli_looks_like_labels(&s->volume, what, sizeof what, err);
    if (st != CW_OK || !*what)
        return st;
    cli_say("%s: %s: its labels are drawn; %s draws its numbers", s->volume.path, what,
            mode == CW_MODE_SLICES ? "--tf window" : "--mode composite");
    p->look.labels = "all";
    p->mode = mode;
    return CW_OK;
}

cw_status cli_decide_labels(cli_pictures *p, cw_error *err)
{
    const render_args *args = p->args;
    const char *hint = find_hint(args);
    cw_mode mode;
    cw_status st = CW_OK;
    p->look = args->look;
    if (p->look.labels && p->source.is_mesh)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s is a mesh; --labels is for volumes",
                        args->common.inputs[0]);
    if (p->look.labels && !args->scene.mode)
        p->mode = CW_MODE_MESH;
    else if (!p->look.labels && may_draw_labels(p->command, args, &p->source, &mode))
        st = find_labels(p, mode, err);
    p->source.of_labels = p->look.labels;
    if (st == CW_OK && hint && !p->look.labels)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--%s is for labels, and none are drawn: --labels all", hint);
    return st;
}

cw_status cli_open_labels(cli_pictures *p, size_t step, cw_error *err)
{
    const cli_input *input = &p->args->input;
    cli_volume *volume = &p->source.volume;
    const size_t at = p->source.series.moments[step].step;
    cw_status st = cli_find_shown_labels(&p->look, input, at, volume, &p->labels, err);
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
