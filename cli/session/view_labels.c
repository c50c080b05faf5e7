/* Shows label maps in the window: which labels are drawn, their names and surfaces. */
#include "cli/session/view.h"

#include "cli/framework/console.h"
#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The input options of a volume of labels, whose components are all read. */
static const cli_input all_layers;

void view_choose_labels(view *v)
{
    const render_args *args = &v->state.args;
    const int mode = args->scene.mode;
    const bool fits = mode == 0 || mode == 1 + CW_MODE_MESH || mode == 1 + CW_MODE_SLICES;
    v->look = args->look;
    if (args->overlay && v->has_volume)
        v->look.labels = v->look.labels ? v->look.labels : "all";
    else if (!v->has_volume || v->source.is_mesh || !fits || args->mesh || args->compare ||
             (args->iso.given && !v->state.iso_is_ours))
        v->look.labels = NULL;
    else if (!v->look.labels && *v->label_note && !args->scene.transfer && !v->state.is_edited)
        v->look.labels = "all";
}

bool view_shows_surfaces(const view *v)
{
    return v->look.labels && !v->state.args.overlay;
}

cw_status view_look_for_labels(view *v, cw_error *err)
{
    return cli_looks_like_labels(&v->source.volume, v->label_note, sizeof v->label_note, err);
}

void view_forget_labels(view *v)
{
    cli_free_label_scene(&v->labels);
    cli_free_volume(&v->overlay);
    v->overlay_values = (cli_slice_labels){0};
    v->has_overlay_range = false;
    v->overlay_path = NULL;
    v->has_labels = v->has_label_mesh = false;
}

static bool is_same_text(const char *a, const char *b)
{
    return a == b || (a && b && strcmp(a, b) == 0);
}

/* Prepares to look for names elsewhere: the volume gets its own back. */
static void give_names_back(view *v)
{
    cli_volume *volume = v->overlay_path ? &v->overlay : &v->source.volume;
    if (v->labels.has_names && !v->labels.names.path) {
        volume->labels = v->labels.names.table;
        v->labels.names.table = (cw_label_table){0};
    }
    cli_free_label_scene(&v->labels);
}

static cw_status need_overlay(view *v, cw_error *err)
{
    const char *path = v->state.args.overlay;
    if (is_same_text(v->overlay_path, path))
        return CW_OK;
    give_names_back(v);
    view_forget_labels(v);
    if (!path)
        return CW_OK;
    char what[160] = "";
    cw_status st = cli_read_overlay(path, &v->state.args.input, &v->overlay, err);
    if (st == CW_OK)
        st = cli_looks_like_labels(&v->overlay, what, sizeof what, err);
    v->overlay_looks_like_labels = *what;
    v->overlay_path = st == CW_OK ? path : NULL;
    return st;
}

static size_t step_of_labels(const view *v)
{
    return v->overlay_path ? 0 : v->source.series.moments[v->state.step].step;
}

/* Makes the colours of an overlay of values; its percentiles are found once. */
static cw_status need_values(view *v, cw_error *err)
{
    const render_args *args = &v->state.args;
    cw_status st = cli_check_values(&args->values, &args->look, err);
    if (st == CW_OK && !v->has_overlay_range && args->values.range.count == 0) {
        st = cli_overlay_range(&v->overlay, (int)args->input.threads, v->overlay_range, err);
        v->has_overlay_range = st == CW_OK;
    }
    return st == CW_OK ? cli_make_values(&v->overlay, &args->values, v->overlay_range,
                                         &args->overlay_opacity, &v->overlay_values, err)
                       : st;
}

cw_status view_need_labels(view *v, cw_error *err)
{
    const cli_label_look *a = &v->look, *b = &v->found;
    double opacity;
    if (!v->look.labels)
        return CW_OK;
    cw_status st = cli_overlay_opacity(&v->state.args.overlay_opacity, &opacity, err);
    if (st == CW_OK)
        st = need_overlay(v, err);
    v->overlay_values = (cli_slice_labels){0};
    if (st == CW_OK && v->overlay_path &&
        !cli_overlay_is_labels(v->overlay_looks_like_labels, &v->state.args.values,
                               &v->state.args.look))
        return need_values(v, err);
    if (st == CW_OK)
        st = cli_check_values(&v->state.args.values, &v->state.args.look, err);
    const bool has_names = is_same_text(a->names, b->names);
    if (st != CW_OK ||
        (v->has_labels && has_names && is_same_text(a->labels, b->labels) &&
         is_same_text(a->opacity, b->opacity) && is_same_text(a->smooth, b->smooth)))
        return st;
    if (!has_names)
        give_names_back(v);
    v->has_labels = v->has_label_mesh = false;
    v->found = v->look;
    const bool over = v->overlay_path;
    st = cli_find_shown_labels(&v->look, over ? &all_layers : &v->state.args.input,
                               step_of_labels(v), over ? &v->overlay : &v->source.volume,
                               &v->labels, err);
    v->has_labels = st == CW_OK;
    return st;
}

cw_status view_need_label_mesh(view *v, cw_error *err)
{
    cw_mesh mesh;
    cw_status st = view_need_labels(v, err);
    if (st != CW_OK || !view_shows_surfaces(v) || v->has_label_mesh)
        return st;
    st = cli_make_label_mesh(&v->state.args.input, step_of_labels(v), &v->source.volume,
                             &v->labels, &mesh, err);
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

cli_slice_labels view_slice_labels(const view *v)
{
    double opacity = 1;
    if (v->look.labels && v->overlay_values.volume)
        return v->overlay_values;
    if (!v->look.labels || !v->has_labels)
        return (cli_slice_labels){0};
    if (!v->overlay_path)
        return (cli_slice_labels){.volume = &v->source.volume,
                                  .input = &v->state.args.input,
                                  .step = step_of_labels(v),
                                  .shown = &v->labels.shown,
                                  .opacity = 1,
                                  .is_base = true};
    if (cli_overlay_opacity(&v->state.args.overlay_opacity, &opacity, NULL) != CW_OK)
        opacity = 1;
    return (cli_slice_labels){.volume = &v->overlay,
                              .input = &all_layers,
                              .shown = &v->labels.shown,
                              .opacity = opacity};
}

void view_name_label(const view *v, uint32_t value, char *text, size_t size)
{
    char name[CLI_LABEL_NAME];
    const cw_label *shown = NULL;
    for (size_t n = 0; n < v->labels.shown.count && !shown; n++)
        if (v->labels.shown.labels[n].value == value)
            shown = &v->labels.shown.labels[n];
    if (!shown)
        cli_complete_label(&v->labels.names.table, 0, value, name);
    snprintf(text, size, "label %u, %s", value, shown ? shown->name : name);
}

void view_label_at(const view *v, const double world[3], char *text, size_t size)
{
    uint32_t layer, value;
    const cli_slice_labels l = view_slice_labels(v);
    *text = '\0';
    if (l.has_values) {
        const double number = cw_volume_sample(&l.field, world);
        if (!isnan(number))
            snprintf(text, size, "overlay %.5g", number);
        return;
    }
    if (!l.volume || !cli_find_label_at(l.volume, l.input, l.step, world, &layer, &value))
        return;
    const cw_label *shown = cw_label_find(l.shown, layer, value);
    if (shown)
        snprintf(text, size, "label %u, %s", value, shown->name);
}
