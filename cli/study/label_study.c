/* Studies a label map: extracts all labels at once, and measures and draws each by itself. */
#include "cli/study/label_study.h"

#include "cli/framework/console.h"
#include "cli/framework/run_config.h"
#include "cli/framework/temp_folder.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/labels.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How many labels have more voxels than a row's; of equal ones the first counts. */
static size_t rank_of(const cli_label_study *l, size_t row)
{
    size_t rank = 0;
    for (size_t n = 0; n < l->scene.shown.count; n++)
        rank += l->scene.voxels[n] > l->scene.voxels[row] ||
                (n < row && l->scene.voxels[n] == l->scene.voxels[row]);
    return rank;
}

static cw_status color_mesh(cw_mesh *mesh, const uint8_t color[4], cw_error *err)
{
    cwi_free(mesh->colors);
    mesh->colors = cwi_alloc_array(mesh->vertex_count, 4);
    if (!mesh->colors)
        return cwi_fail_memory(err);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        memcpy(mesh->colors + 4 * v, color, 3);
        mesh->colors[4 * v + 3] = 255;
    }
    return CW_OK;
}

static cw_status study_label(cli_label_study *l, const cw_label_surfaces *surfaces, size_t n,
                             cw_error *err)
{
    cli_study *s = &l->study;
    cli_label_row *row = &l->rows[n];
    const double *mm = s->volume->spacing;
    const cw_quality_desc desc = {.threads = s->threads};
    cw_mesh mesh = {0};
    cw_quality quality;
    row->label = &l->scene.shown.labels[n];
    row->voxels = l->scene.voxels[n];
    row->voxels_mm3 = (double)row->voxels * mm[0] * mm[1] * mm[2];
    cw_status st = cw_label_mesh(surfaces, row->label->value, &mesh, err);
    if (st == CW_OK)
        st = cw_quality_measure(&mesh, &desc, &quality, err);
    if (st == CW_OK) {
        row->triangles = quality.triangles;
        row->components = quality.components;
        row->closed = cw_quality_is_closed_manifold(&quality);
        row->mesh_mm3 = quality.volume_mm3;
        row->area_mm2 = quality.area_mm2;
    }
    if (st == CW_OK && mesh.triangle_count && rank_of(l, n) < CLI_LABEL_PICTURES) {
        st = color_mesh(&mesh, row->label->color, err);
        if (st == CW_OK)
            st = cli_draw_mesh(s, &mesh, &mesh, NULL, &row->drawn, err);
    }
    cw_mesh_free(&mesh);
    return st;
}

/* The row of a label in a layer; rows are in rising order of both. */
static size_t find_row(const cli_label_study *l, uint32_t layer, uint32_t value)
{
    const cw_label *label = cw_label_find(&l->scene.shown, layer, value);
    return label ? (size_t)(label - l->scene.shown.labels) : 0;
}

static cw_status color_surfaces(const cli_label_study *l, const cw_label_surfaces *surfaces,
                                uint32_t layer, cw_mesh *mesh, cw_error *err)
{
    uint8_t(*colors)[4] = cwi_alloc_zeroed(surfaces->label_count + 1, sizeof *colors);
    if (!colors)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < surfaces->label_count; n++) {
        const cw_label *label =
            cw_label_find(&l->scene.shown, layer, surfaces->labels[n].label);
        if (label) {
            memcpy(colors[n], label->color, 3);
            colors[n][3] = 255;
        }
    }
    cw_status st = cw_label_colored_mesh(surfaces, (const uint8_t(*)[4])colors, mesh, err);
    cwi_free(colors);
    return st;
}

static cw_status pack_labels(cli_label_study *l, const cw_mesh *mesh, uint32_t layer,
                             cw_error *err)
{
    uint8_t *bytes = cwi_alloc_array(mesh->vertex_count + 1, 1);
    if (!bytes)
        return cwi_fail_memory(err);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        bytes[v] = (uint8_t)find_row(l, layer, mesh->labels[v]);
    cw_status st = cli_pack_mesh(mesh, bytes, &l->packed, err);
    cwi_free(bytes);
    return st;
}

/* Simplified, if need be, all labels together: neighbours stay without a gap. */
static cw_status turn_labels(cli_label_study *l, const cw_label_surfaces *surfaces,
                             uint32_t layer, cw_error *err)
{
    const cw_label_simplify_desc desc = {
        .triangles = CLI_PACKED_TRIANGLES,
        .threads = l->study.threads,
        .progress = cli_progress((double)surfaces->mesh.triangle_count / 1e6, "Mtriangle")};
    const bool large = surfaces->mesh.triangle_count > CLI_PACKED_TRIANGLES;
    cw_label_surfaces small = {0};
    cw_mesh mesh = {0};
    if (l->layers > 1 || l->scene.shown.count > CLI_LABEL_COLORS) {
        snprintf(l->packed.why, sizeof l->packed.why, "%s",
                 l->layers > 1 ? "labels overlap in several components of the volume"
                               : "there are more than 256 labels");
        return CW_OK;
    }
    cw_status st = large ? cw_label_simplify(surfaces, &desc, &small, err) : CW_OK;
    if (st == CW_OK)
        st = color_surfaces(l, large ? &small : surfaces, layer, &mesh, err);
    if (st == CW_OK && mesh.triangle_count <= 2 * CLI_PACKED_TRIANGLES)
        st = pack_labels(l, &mesh, layer, err);
    else if (st == CW_OK)
        snprintf(l->packed.why, sizeof l->packed.why,
                 "%zu triangles are left when they are simplified", mesh.triangle_count);
    if (st == CW_OK && large)
        l->packed.made_of = surfaces->mesh.triangle_count;
    cw_mesh_free(&mesh);
    cw_label_surfaces_free(&small);
    return st;
}

static cw_status draw_together(cli_label_study *l, const cw_label_surfaces *surfaces,
                               uint32_t layer, cw_error *err)
{
    cw_mesh mesh = {0};
    cw_status st = color_surfaces(l, surfaces, layer, &mesh, err);
    if (st == CW_OK && mesh.triangle_count && !l->all.bytes)
        st = cli_draw_mesh(&l->study, &mesh, &mesh, NULL, &l->all, err);
    cw_mesh_free(&mesh);
    return st == CW_OK ? turn_labels(l, surfaces, layer, err) : st;
}

static cw_status study_layer(cli_label_study *l, uint32_t layer, cw_error *err)
{
    cw_volume view;
    cw_label_surfaces surfaces = {0};
    uint32_t *values = NULL;
    size_t count = 0;
    cw_status st = cw_volume_select(&l->study.volume->voxels, layer, l->step, &view, err);
    if (st == CW_OK && !l->scene.choice.all)
        st = cli_labels_of_layer(&l->scene.choice, layer, &values, &count, err);
    const cw_labels_desc desc = {
        .labels = values,
        .label_count = count,
        .no_smoothing = l->scene.max_move == 0,
        .max_move = l->scene.max_move,
        .threads = l->study.threads,
        .progress =
            cli_progress((double)(view.dim[0] * view.dim[1] * view.dim[2]) / 1e6, "Mvoxel")};
    const double start = cli_seconds();
    if (st == CW_OK)
        st = cw_extract_labels(&view, &desc, &surfaces, err);
    l->extract_seconds += cli_seconds() - start;
    l->triangles += surfaces.mesh.triangle_count;
    for (size_t n = 0; n < l->scene.shown.count && st == CW_OK; n++)
        if (l->scene.shown.labels[n].layer == layer)
            st = study_label(l, &surfaces, n, err);
    if (st == CW_OK)
        st = draw_together(l, &surfaces, layer, err);
    cw_label_surfaces_free(&surfaces);
    free(values);
    return st;
}

static bool has_labels(const cli_label_study *l, uint32_t layer)
{
    for (size_t n = 0; n < l->scene.shown.count; n++)
        if (l->scene.shown.labels[n].layer == layer)
            return true;
    return false;
}

cw_status cli_study_labels(cli_label_study *l, const cli_label_look *look, cli_volume *volume,
                           cw_error *err)
{
    cli_study *s = &l->study;
    size_t first, end;
    s->start = cli_seconds();
    s->deadline = INFINITY;
    s->voxel_mm = cbrt(volume->spacing[0] * volume->spacing[1] * volume->spacing[2]);
    cw_status st = cli_find_shown_labels(look, l->input, l->step, volume, &l->scene, err);
    if (st == CW_OK)
        st = cli_scratch_make(&s->folder, err);
    if (st != CW_OK)
        return st;
    l->rows = calloc(l->scene.shown.count + 1, sizeof *l->rows);
    if (!l->rows)
        return cwi_fail_memory(err);
    cli_label_layers(volume, l->input, &first, &end);
    for (size_t c = first; c < end; c++)
        l->layers += has_labels(l, (uint32_t)c);
    for (size_t c = first; c < end && st == CW_OK; c++)
        if (has_labels(l, (uint32_t)c))
            st = study_layer(l, (uint32_t)c, err);
    s->seconds = cli_seconds() - s->start;
    return st == CW_OK ? st : cwi_fail_in(err, st, volume->path);
}

void cli_free_label_study(cli_label_study *l)
{
    for (size_t n = 0; n < l->scene.shown.count && l->rows; n++)
        free(l->rows[n].drawn.bytes);
    free(l->rows);
    free(l->all.bytes);
    cli_free_packed(&l->packed);
    cli_free_label_scene(&l->scene);
    cli_study_free(&l->study);
}

static void json_row(cli_json *j, const cli_label_study *l, const cli_label_row *row)
{
    cli_json_open(j, NULL, '{');
    cli_json_count(j, "label", row->label->value);
    if (l->layers > 1)
        cli_json_count(j, "layer", row->label->layer);
    cli_json_text(j, "name", row->label->name);
    cli_json_count(j, "voxels", row->voxels);
    cli_json_number(j, "voxels_mm3", row->voxels_mm3);
    cli_json_count(j, "triangles", row->triangles);
    cli_json_count(j, "components", row->components);
    cli_json_bool(j, "closed", row->closed);
    cli_json_number(j, "area_mm2", row->area_mm2);
    if (row->closed)
        cli_json_number(j, "volume_mm3", row->mesh_mm3);
    cli_json_close(j, '}');
}

void cli_put_label_json(FILE *out, const void *study)
{
    const cli_label_study *l = study;
    cli_json j = {.out = out};
    cli_json_begin(&j, "cubewright-labels-1");
    cli_json_input(&j, "input", l->study.volume);
    cli_json_number(&j, "max_move_voxels", l->scene.max_move);
    cli_json_count(&j, "triangles", l->triangles);
    cli_json_number(&j, "extract_seconds", l->extract_seconds);
    cli_json_number(&j, "seconds", l->study.seconds);
    cli_json_open(&j, "labels", '[');
    for (size_t n = 0; n < l->scene.shown.count; n++)
        json_row(&j, l, &l->rows[n]);
    cli_json_close(&j, ']');
    cli_json_close(&j, '}');
}
