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
    view_label_map *labels = &v->document.labels;
    const render_args *args = &v->state.args;
    const int mode = args->scene.mode;
    const bool fits = mode == 0 || mode == 1 + CW_MODE_MESH || mode == 1 + CW_MODE_SLICES;
    labels->look = args->look;
    if (args->overlay && v->document.has_volume)
        labels->look.labels = labels->look.labels ? labels->look.labels : "all";
    else if (!v->document.has_volume || v->document.source.is_mesh || !fits || args->mesh ||
             args->compare || (args->iso.given && !v->state.iso_is_ours))
        labels->look.labels = NULL;
    else if (!labels->look.labels && *labels->note && !args->scene.transfer &&
             !v->state.is_edited)
        labels->look.labels = "all";
}

bool view_shows_surfaces(const view *v)
{
    return v->document.labels.look.labels && !v->state.args.overlay;
}

cw_status view_look_for_labels(view *v, cw_error *err)
{
    return cli_looks_like_labels(&v->document.source.volume, v->document.labels.note, err);
}

void view_forget_labels(view *v)
{
    view_label_map *labels = &v->document.labels;
    view_overlay *overlay = &v->document.overlay;
    cli_free_label_scene(&labels->scene);
    cli_free_volume(&overlay->volume);
    overlay->values = (cli_slice_labels){0};
    overlay->has_range = false;
    overlay->path = NULL;
    labels->has_scene = labels->has_mesh = false;
}

static bool is_same_text(const char *a, const char *b)
{
    return a == b || (a && b && strcmp(a, b) == 0);
}

static bool is_same_length(const cli_length *a, const cli_length *b)
{
    return a->given == b->given && a->is_word == b->is_word && a->value == b->value &&
           a->unit == b->unit;
}

/* Gives the volume its own names back, before others are looked for. */
static void give_names_back(view *v)
{
    view_label_map *labels = &v->document.labels;
    cli_volume *volume =
        v->document.overlay.path ? &v->document.overlay.volume : &v->document.source.volume;
    if (labels->scene.has_names && !labels->scene.names.path) {
        volume->labels = labels->scene.names.table;
        labels->scene.names.table = (cw_label_table){0};
    }
    cli_free_label_scene(&labels->scene);
}

static cw_status need_overlay(view *v, cw_error *err)
{
    view_overlay *overlay = &v->document.overlay;
    const char *path = v->state.args.overlay;
    if (is_same_text(overlay->path, path))
        return CW_OK;
    give_names_back(v);
    view_forget_labels(v);
    if (!path)
        return CW_OK;
    char what[CLI_LABELS_TEXT] = "";
    cw_status st = cli_read_overlay(path, &v->state.args.input, &overlay->volume, err);
    if (st == CW_OK)
        st = cli_looks_like_labels(&overlay->volume, what, err);
    overlay->looks_like_labels = *what;
    overlay->path = st == CW_OK ? path : NULL;
    return st;
}

static size_t step_of_labels(const view *v)
{
    return v->document.overlay.path ? 0 : v->document.source.series.moments[v->state.step].step;
}

/* Makes the colours of an overlay of values; its percentiles are found once. */
static cw_status need_values(view *v, cw_error *err)
{
    view_overlay *overlay = &v->document.overlay;
    const render_args *args = &v->state.args;
    cw_status st = cli_check_values(&args->values, &args->look, err);
    if (st == CW_OK && !overlay->has_range && args->values.range.count == 0) {
        st = cli_overlay_range(&overlay->volume, (int)args->input.threads, overlay->range, err);
        overlay->has_range = st == CW_OK;
    }
    return st == CW_OK ? cli_make_values(&overlay->volume, &args->values, overlay->range,
                                         &args->overlay_opacity, &overlay->values, err)
                       : st;
}

cw_status view_need_labels(view *v, cw_error *err)
{
    view_label_map *labels = &v->document.labels;
    view_overlay *overlay = &v->document.overlay;
    const cli_label_look *a = &labels->look, *b = &labels->found;
    double opacity;
    if (!labels->look.labels)
        return CW_OK;
    cw_status st = cli_overlay_opacity(&v->state.args.overlay_opacity, &opacity, err);
    if (st == CW_OK)
        st = need_overlay(v, err);
    overlay->values = (cli_slice_labels){0};
    if (st == CW_OK && overlay->path &&
        !cli_overlay_is_labels(overlay->looks_like_labels, &v->state.args.values,
                               &v->state.args.look))
        return need_values(v, err);
    if (st == CW_OK)
        st = cli_check_values(&v->state.args.values, &v->state.args.look, err);
    const bool has_names = is_same_text(a->names, b->names);
    if (st != CW_OK ||
        (labels->has_scene && has_names && is_same_text(a->labels, b->labels) &&
         is_same_text(a->opacity, b->opacity) && is_same_length(&a->smooth, &b->smooth)))
        return st;
    if (!has_names)
        give_names_back(v);
    labels->has_scene = labels->has_mesh = false;
    labels->found = labels->look;
    const bool over = overlay->path;
    st = cli_find_shown_labels(
        &labels->look, over ? &all_layers : &v->state.args.input, step_of_labels(v),
        over ? &overlay->volume : &v->document.source.volume, &labels->scene, err);
    labels->has_scene = st == CW_OK;
    return st;
}

cw_status view_need_label_mesh(view *v, cw_error *err)
{
    view_label_map *labels = &v->document.labels;
    view_surface *surface = &v->document.surface;
    cw_mesh mesh;
    cw_status st = view_need_labels(v, err);
    if (st != CW_OK || !view_shows_surfaces(v) || labels->has_mesh)
        return st;
    st = cli_make_label_mesh(&v->state.args.input, step_of_labels(v),
                             &v->document.source.volume, &labels->scene, &mesh, err);
    if (st != CW_OK)
        return st;
    if (surface->is_drawn) {
        cw_mesh_free(&surface->old_mesh);
        surface->old_mesh = v->document.source.mesh;
    } else {
        cw_mesh_free(&v->document.source.mesh);
    }
    surface->is_drawn = false;
    v->document.source.mesh = mesh;
    surface->level = 0;
    labels->has_mesh = true;
    return CW_OK;
}

cli_slice_labels view_slice_labels(const view *v)
{
    const view_label_map *labels = &v->document.labels;
    const view_overlay *overlay = &v->document.overlay;
    double opacity = 1;
    if (labels->look.labels && overlay->values.volume)
        return overlay->values;
    if (!labels->look.labels || !labels->has_scene)
        return (cli_slice_labels){0};
    if (!overlay->path)
        return (cli_slice_labels){.volume = &v->document.source.volume,
                                  .input = &v->state.args.input,
                                  .step = step_of_labels(v),
                                  .shown = &labels->scene.shown,
                                  .opacity = 1,
                                  .is_base = true};
    if (cli_overlay_opacity(&v->state.args.overlay_opacity, &opacity, NULL) != CW_OK)
        opacity = 1;
    return (cli_slice_labels){.volume = &overlay->volume,
                              .input = &all_layers,
                              .shown = &labels->scene.shown,
                              .opacity = opacity};
}

void view_name_label(const view *v, uint32_t value, char *text, size_t size)
{
    const view_label_map *labels = &v->document.labels;
    char name[CLI_LABEL_NAME];
    const cw_label *shown = NULL;
    for (size_t n = 0; n < labels->scene.shown.count && !shown; n++)
        if (labels->scene.shown.labels[n].value == value)
            shown = &labels->scene.shown.labels[n];
    if (!shown)
        cli_complete_label(&labels->scene.names.table, 0, value, name);
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
