/* Finds the labels that a picture shows, with their colours and opacities, and makes their
 * surfaces. */
#include "cli/inputs/label_scene.h"

#include "cli/framework/console.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/labels.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ITEM_BYTES = 256 };

static void drop_shown(cli_label_scene *s)
{
    cli_free_label_choice(&s->choice);
    cw_label_table_free(&s->shown);
    free(s->voxels);
    s->voxels = NULL;
}

void cli_free_label_scene(cli_label_scene *scene)
{
    drop_shown(scene);
    cli_free_label_names(&scene->names);
    *scene = (cli_label_scene){0};
}

void cli_label_layers(const cli_volume *volume, const cli_input *input, size_t *first,
                      size_t *end)
{
    const bool is_one = input->array.component.given && !input->array.component.magnitude;
    *first = is_one ? input->array.component.number : 0;
    *end = is_one            ? *first + 1
           : volume->streams ? volume->whole.components
                             : volume->voxels.components;
}

static bool is_chosen(const cli_label_choice *choice, uint32_t layer, uint32_t value)
{
    for (size_t n = 0; n < choice->count; n++)
        if (choice->labels[n].value == value &&
            (choice->labels[n].of_all_layers || choice->labels[n].layer == layer))
            return true;
    return choice->all;
}

/* Adds the labels of one component that occur and were chosen. Those that their table hides are
 * hidden unless they were named. */
static cw_status add_counted(cli_label_scene *s, uint32_t layer, const cw_label_count *counts,
                             size_t count, cw_error *err)
{
    cw_status st = CW_OK;
    size_t *voxels = realloc(s->voxels, (s->shown.count + count + 1) * sizeof *voxels);
    if (!voxels)
        return cwi_fail_memory(err);
    s->voxels = voxels;
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        char name[CLI_LABEL_NAME];
        if (!is_chosen(&s->choice, layer, counts[n].label))
            continue;
        cw_label label = cli_complete_label(&s->names.table, layer, counts[n].label, name);
        label.hidden = label.hidden && s->choice.all;
        cli_mark_found(&s->choice, layer, label.value);
        s->voxels[s->shown.count] = counts[n].voxels;
        st = cw_label_table_add(&s->shown, &label, err);
    }
    return st;
}

static cw_status count_layer(cli_label_scene *s, const cli_volume *volume, size_t layer,
                             size_t step, cw_error *err)
{
    cw_volume view;
    cw_label_count *counts = NULL;
    size_t count = 0;
    cw_status st = cw_volume_select(&volume->voxels, layer, step, &view, err);
    if (st == CW_OK)
        st = cw_label_counts(&view, 0, &counts, &count, err);
    if (st == CW_OK)
        st = add_counted(s, (uint32_t)layer, counts, count, err);
    cw_label_counts_free(counts);
    return st == CW_OK ? st : cwi_fail_in(err, st, volume->path);
}

/* Sets an opacity of the labels that an item names: "Liver:0.3". Those of "all" are set in a
 * round before the others. */
static cw_status set_opacity(cli_label_scene *s, const cw_label_ids *ids, char *item,
                             bool for_all, cw_error *err)
{
    cli_label_choice choice = {0};
    char *colon = strrchr(item, ':'), *end = NULL;
    const double opacity = colon ? strtod(colon + 1, &end) : -1;
    if (!colon || colon == item || end == colon + 1 || *end || !(opacity >= 0 && opacity <= 1))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--label-opacity '%s': expected is LABEL:OPACITY with 0 to 1, such as "
                        "17:0.3,Liver:0.5,all:0.8",
                        item);
    *colon = '\0';
    cw_status st =
        cli_choose_labels("--label-opacity", item, &s->names.table, ids, &choice, err);
    for (size_t n = 0; n < s->shown.count && st == CW_OK && choice.all == for_all; n++)
        if (is_chosen(&choice, s->shown.labels[n].layer, s->shown.labels[n].value))
            s->shown.labels[n].color[3] = (uint8_t)lround(255 * opacity);
    cli_free_label_choice(&choice);
    return st;
}

static cw_status set_opacities(const char *text, const cw_label_ids *ids, cli_label_scene *s,
                               cw_error *err)
{
    cw_status st = CW_OK;
    for (int round = 0; round < 2; round++)
        for (const char *at = text; at && st == CW_OK; at = strchr(at, ',')) {
            char item[ITEM_BYTES];
            at += *at == ',';
            const size_t length = strcspn(at, ",");
            snprintf(item, sizeof item, "%.*s", (int)length, at);
            st = set_opacity(s, ids, item, round == 0, err);
        }
    return st;
}

static cw_status find_names(const cli_label_look *look, cli_volume *volume, cli_label_scene *s,
                            cw_error *err)
{
    if (s->has_names)
        return CW_OK;
    cw_status st = cli_find_label_names(look->names, volume, &s->names, err);
    s->has_names = st == CW_OK;
    return st;
}

static cw_status check_shown(const cli_volume *volume, const cli_label_scene *s, cw_error *err)
{
    char list[256];
    const size_t missing = cli_list_missing(&s->choice, &s->names.table, list, sizeof list);
    if (missing)
        cli_say("%s: no voxel has label%s %s: skipped", volume->path, missing == 1 ? "" : "s",
                list);
    return s->shown.count
               ? CW_OK
               : cwi_fail(err, CW_ERR_EMPTY,
                          "%s: none of the labels has voxels: all values are the background or "
                          "not chosen",
                          volume->path);
}

cw_status cli_find_shown_labels(const cli_label_look *look, const cli_input *input, size_t step,
                                cli_volume *volume, cli_label_scene *s, cw_error *err)
{
    size_t first, end;
    drop_shown(s);
    if (volume->view.cells || volume->view.sparse)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "%s: labels are those of dense grids of voxels; this is %s",
                        volume->path,
                        volume->view.cells ? "an irregular grid" : "a sparse one");
    cw_status st = cli_find_label_move(&look->smooth, volume->spacing, &s->max_move, err);
    if (st == CW_OK)
        st = find_names(look, volume, s, err);
    if (st == CW_OK)
        st = cli_choose_labels("--labels", look->labels, &s->names.table, &volume->ids,
                               &s->choice, err);
    cli_label_layers(volume, input, &first, &end);
    for (size_t c = first; c < end && st == CW_OK; c++)
        st = count_layer(s, volume, c, step, err);
    if (st == CW_OK)
        st = check_shown(volume, s, err);
    return st == CW_OK ? set_opacities(look->opacity, &volume->ids, s, err) : st;
}

/* Appends a mesh of labels to another. Both are of one volume. */
static cw_status append_mesh(cw_mesh *mesh, const cw_mesh *more, cw_error *err)
{
    const size_t v = mesh->vertex_count, t = mesh->triangle_count;
    cw_mesh sum = *mesh;
    sum.vertex_count += more->vertex_count;
    sum.triangle_count += more->triangle_count;
    bool is_whole = sum.vertex_count <= UINT32_MAX;
#define GROW(field, count, from, width)                                                        \
    if (is_whole) {                                                                            \
        sum.field = cwi_realloc_array(mesh->field, count, (width) * sizeof *sum.field);        \
        is_whole = sum.field;                                                                  \
        mesh->field = sum.field ? sum.field : mesh->field;                                     \
    }                                                                                          \
    if (is_whole)                                                                              \
        memcpy(sum.field + (width) * (from), more->field,                                      \
               (width) * ((count) - (from)) * sizeof *sum.field);
    GROW(positions, sum.vertex_count, v, 3)
    GROW(normals, sum.vertex_count, v, 3)
    GROW(colors, sum.vertex_count, v, 4)
    GROW(labels, sum.vertex_count, v, 1)
    GROW(triangles, sum.triangle_count, t, 3)
#undef GROW
    if (!is_whole)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < more->vertex_count; n++)
        for (int a = 0; a < 3; a++)
            sum.positions[3 * (v + n) + (size_t)a] +=
                (float)(more->origin[a] - mesh->origin[a]);
    for (size_t n = 3 * t; n < 3 * sum.triangle_count; n++)
        sum.triangles[n] += (uint32_t)v;
    *mesh = sum;
    return CW_OK;
}

/* Lists the colours of the labels that were extracted. */
static cw_status list_colors(const cli_label_scene *s, uint32_t layer,
                             const cw_label_surfaces *surfaces, uint8_t (**colors)[4],
                             cw_error *err)
{
    *colors = calloc(surfaces->label_count + 1, sizeof **colors);
    if (!*colors)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < surfaces->label_count; n++) {
        const cw_label *label = cw_label_find(&s->shown, layer, surfaces->labels[n].label);
        if (label && !label->hidden)
            memcpy((*colors)[n], label->color, 4);
    }
    return CW_OK;
}

/* Extracts the labels of one component, and adds their surfaces to the mesh. */
static cw_status add_layer(const cw_labels_desc *desc, const cw_volume *view, uint32_t layer,
                           const cli_label_scene *s, cw_mesh *mesh, cw_error *err)
{
    cw_label_surfaces surfaces;
    uint8_t(*colors)[4] = NULL;
    cw_mesh one = {0};
    cw_status st = cw_extract_labels(view, desc, &surfaces, err);
    if (st == CW_OK)
        st = list_colors(s, layer, &surfaces, &colors, err);
    if (st == CW_OK)
        st = cw_label_colored_mesh(&surfaces, (const uint8_t(*)[4])colors, &one, err);
    free(colors);
    cw_label_surfaces_free(&surfaces);
    if (st == CW_OK && mesh->triangle_count == 0) {
        cw_mesh_free(mesh);
        *mesh = one;
        return CW_OK;
    }
    if (st == CW_OK)
        st = append_mesh(mesh, &one, err);
    cw_mesh_free(&one);
    return st;
}

size_t cli_count_visible(const cli_label_scene *scene, bool in_3d)
{
    size_t count = 0;
    for (size_t n = 0; n < scene->shown.count; n++) {
        const cw_label *label = &scene->shown.labels[n];
        count += label->color[3] > 0 && !(in_3d && label->hidden);
    }
    return count;
}

static void tell_hidden(const cli_volume *volume, const cli_label_scene *s)
{
    size_t hidden = 0;
    for (size_t n = 0; n < s->shown.count; n++)
        hidden += s->shown.labels[n].hidden;
    if (hidden)
        cli_say(
            "%s: %zu label%s that the table hides in 3D %s left out; --labels takes them by "
            "number or name",
            volume->path, hidden, hidden == 1 ? "" : "s", hidden == 1 ? "is" : "are");
}

cw_status cli_make_label_mesh(const cli_input *input, size_t step, const cli_volume *volume,
                              const cli_label_scene *s, cw_mesh *mesh, cw_error *err)
{
    size_t first, end;
    cw_status st = CW_OK;
    *mesh = (cw_mesh){0};
    tell_hidden(volume, s);
    cli_label_layers(volume, input, &first, &end);
    for (size_t c = first; c < end && st == CW_OK; c++) {
        cw_volume view;
        uint32_t *values = NULL;
        size_t count = 0;
        st = cw_volume_select(&volume->voxels, c, step, &view, err);
        if (st == CW_OK && !s->choice.all)
            st = cli_labels_of_layer(&s->choice, (uint32_t)c, &values, &count, err);
        const cw_labels_desc desc = {
            .labels = values,
            .label_count = count,
            .no_smoothing = s->max_move == 0,
            .max_move = s->max_move,
            .threads = (int)input->threads,
            .max_triangles = input->max_triangles,
            .progress = cli_progress((double)(view.dim[0] * view.dim[1] * view.dim[2]) / 1e6,
                                     "Mvoxel")};
        if (st == CW_OK && (s->choice.all || count))
            st = add_layer(&desc, &view, (uint32_t)c, s, mesh, err);
        free(values);
    }
    if (st == CW_OK && mesh->triangle_count == 0)
        st = cwi_fail(err, CW_ERR_EMPTY, "all labels are clear, or hidden by their table");
    if (st == CW_OK)
        return CW_OK;
    cw_mesh_free(mesh);
    return cwi_fail_in(err, st, volume->path);
}

bool cli_find_label_at(const cli_volume *volume, const cli_input *input, size_t step,
                       const double world[3], uint32_t *layer, uint32_t *value)
{
    size_t first, end, at[3];
    double index[3];
    const cw_volume *v = &volume->view;
    if (!v->data || v->cells || v->sparse || cw_volume_to_index(v, world, index, NULL) != CW_OK)
        return false;
    for (int a = 0; a < 3; a++) {
        const double nearest = floor(index[a] + 0.5);
        if (!(nearest >= 0 && nearest < (double)v->dim[a]))
            return false;
        at[a] = (size_t)nearest;
    }
    cli_label_layers(volume, input, &first, &end);
    for (size_t c = end; c-- > first;) {
        cw_volume view;
        if (cw_volume_select(&volume->voxels, c, step, &view, NULL) != CW_OK)
            return false;
        const double found = cw_volume_value(&view, at[0], at[1], at[2]);
        if (!(found >= 1 && found <= UINT32_MAX))
            continue;
        *layer = (uint32_t)c;
        *value = (uint32_t)rint(found);
        return true;
    }
    return false;
}

cw_status cli_looks_like_labels(const cli_volume *volume, char what[CLI_LABELS_TEXT],
                                cw_error *err)
{
    cw_labels l;
    *what = '\0';
    if (volume->magnitude.data || volume->view.cells || volume->view.sparse)
        return CW_OK;
    cw_status st = cw_volume_labels(&volume->view, &l, err);
    if (st != CW_OK || !l.found)
        return st == CW_OK ? st : cwi_fail_in(err, st, volume->path);
    cli_describe_labels(volume, &l, what);
    return CW_OK;
}
