/* Shows label maps in the window: which labels are drawn, their names and surfaces. */
#include "cli/view/view.h"

#include "cli/framework/console.h"
#include "core/base/status.h"

#include <stdio.h>
#include <string.h>

void view_choose_labels(view *v)
{
    const render_args *args = &v->state.args;
    const int mode = args->scene.mode;
    const bool fits = mode == 0 || mode == 1 + CW_MODE_MESH || mode == 1 + CW_MODE_SLICES;
    v->look = args->look;
    if (!v->has_volume || v->source.is_mesh || !fits || args->mesh || args->compare ||
        (args->iso.given && !v->state.iso_is_ours))
        v->look.labels = NULL;
    else if (!v->look.labels && *v->label_note && !args->scene.transfer && !v->state.is_edited)
        v->look.labels = "all";
}

cw_status view_look_for_labels(view *v, cw_error *err)
{
    return cli_looks_like_labels(&v->source.volume, v->label_note, sizeof v->label_note, err);
}

void view_forget_labels(view *v)
{
    cli_free_label_scene(&v->labels);
    v->has_labels = v->has_label_mesh = false;
}

static bool is_same_text(const char *a, const char *b)
{
    return a == b || (a && b && strcmp(a, b) == 0);
}

/* Prepares to look for names elsewhere: the volume gets its own back. */
static void give_names_back(view *v)
{
    if (v->labels.has_names && !v->labels.names.path) {
        v->source.volume.labels = v->labels.names.table;
        v->labels.names.table = (cw_label_table){0};
    }
    view_forget_labels(v);
}

cw_status view_need_labels(view *v, cw_error *err)
{
    const cli_label_look *a = &v->look, *b = &v->found;
    const bool has_names = is_same_text(a->names, b->names);
    if (!v->look.labels ||
        (v->has_labels && has_names && is_same_text(a->labels, b->labels) &&
         is_same_text(a->opacity, b->opacity) && is_same_text(a->smooth, b->smooth)))
        return CW_OK;
    if (!has_names)
        give_names_back(v);
    v->has_labels = v->has_label_mesh = false;
    v->found = v->look;
    const size_t step = v->source.series.moments[v->state.step].step;
    cw_status st = cli_find_shown_labels(&v->look, &v->state.args.input, step,
                                         &v->source.volume, &v->labels, err);
    v->has_labels = st == CW_OK;
    return st;
}

cw_status view_need_label_mesh(view *v, cw_error *err)
{
    cw_mesh mesh;
    cw_status st = view_need_labels(v, err);
    if (st != CW_OK || !v->look.labels || v->has_label_mesh)
        return st;
    const size_t step = v->source.series.moments[v->state.step].step;
    st = cli_make_label_mesh(&v->state.args.input, step, &v->source.volume, &v->labels, &mesh,
                             err);
    if (st != CW_OK)
        return st;
    if (v->mesh_is_drawn) {
        cw_mesh_free(&v->old_mesh);
        v->old_mesh = v->source.mesh;
    } else {
        cw_mesh_free(&v->source.mesh);
    }
    v->mesh_is_drawn = false;
    v->source.mesh = mesh;
    v->mesh_level = 0;
    v->has_label_mesh = true;
    return CW_OK;
}

void view_name_label(const view *v, uint32_t layer, uint32_t value, char *text, size_t size)
{
    char name[CLI_LABEL_NAME];
    const cw_label label = cli_complete_label(&v->labels.names.table, layer, value, name);
    const cw_label *shown = cw_label_find(&v->labels.shown, layer, value);
    snprintf(text, size, "label %u, %s", value,
             shown && shown->name ? shown->name : label.name);
}
