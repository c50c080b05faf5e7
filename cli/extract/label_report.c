/* Tells of labels: the table of --table, and their part of the JSON report. */
#include "cli/extract/label_run.h"

#include "cli/results/stage_facts.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/affine.h"

#include <cubewright/labels.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Returns the volume of a voxel in cubic millimetres; NAN where voxels differ in size. */
static double voxel_mm3(const cli_label_run *r)
{
    const cw_volume *v = &r->volume.view;
    for (int a = 0; a < 3; a++)
        if (v->coordinates[a])
            return NAN;
    return fabs(cwi_affine_determinant(v->affine[0]));
}

/* Returns the label on the other side of a patch of an item; false where it has no part in it. */
static bool find_neighbour(const cli_label_item *item, const cw_label_patch *patch,
                           uint32_t *other)
{
    const bool is_first = patch->labels[0] == item->label.value;
    *other = patch->labels[is_first ? 1 : 0];
    return is_first || patch->labels[1] == item->label.value;
}

/* Returns the label that a value stands for beside an item. */
static cw_label find_label(const cli_label_run *r, const cli_label_item *item, uint32_t value)
{
    char name[CLI_LABEL_NAME];
    cw_label label = cli_complete_label(&r->names.table, item->layer->number, value, name);
    label.name = NULL;
    return label;
}

/* Prints a field of a CSV: in quotes where it needs them. */
static void put_field(FILE *out, const char *text)
{
    if (!strpbrk(text, ",\"\n")) {
        fputs(text, out);
        return;
    }
    fputc('"', out);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', out);
        fputc(*text, out);
    }
    fputc('"', out);
}

/* Returns true if surfaces were simplified to a number of triangles: their errors are measured. */
static bool has_errors(const cli_label_run *r)
{
    bool has = false;
    for (size_t n = 0; n < r->item_count; n++)
        has = has || !isnan(r->items[n].max_error_mm);
    return has;
}

static void put_row(FILE *out, const cli_label_run *r, const cli_label_item *item)
{
    const cw_label_surfaces *s = &item->layer->surfaces;
    const uint8_t *c = item->label.color;
    const double voxel = voxel_mm3(r);
    const char *separator = "";
    uint32_t other;
    fprintf(out, "%s,", cw_label_number(&item->label, (char[CW_LABEL_NUMBER]){0}));
    put_field(out, item->name);
    fprintf(out, ",%d,%d,%d,%d,%u,%zu,", c[0], c[1], c[2], c[3], item->label.layer,
            item->voxels);
    if (!isnan(voxel))
        fprintf(out, "%.9g", voxel * (double)item->voxels);
    if (item->facts.quality.open_edges)
        fputs(",,", out); /* an open surface encloses nothing */
    else
        fprintf(out, ",%.9g,", item->facts.quality.volume_mm3);
    fprintf(out, "%.9g,%zu,%zu,", item->facts.quality.area_mm2, item->facts.quality.triangles,
            item->facts.quality.components);
    for (size_t p = 0; p < s->patch_count; p++)
        if (find_neighbour(item, &s->patches[p], &other)) {
            const cw_label label = find_label(r, item, other);
            fprintf(out, "%s%s:%.6g", separator,
                    cw_label_number(&label, (char[CW_LABEL_NUMBER]){0}),
                    cw_label_patch_area(s, &s->patches[p]));
            separator = ";";
        }
    if (has_errors(r) && !isnan(item->max_error_mm))
        fprintf(out, ",%.6g,%.6g", item->max_error_mm, item->rms_error_mm);
    else if (has_errors(r))
        fputs(",,", out);
    const cw_label_change *change = cli_find_label_change(item);
    if (change)
        fprintf(out, ",%zu,%zu,%zu,%zu", change->voxels_before, change->components_removed,
                change->voxels_removed, change->voxels_added);
    fputc('\n', out);
}

/* Prints the table. Its first columns are those of 3D Slicer's tables of colours. */
static void put_table(FILE *out, const void *p)
{
    const cli_label_run *r = p;
    fputs("LabelValue,Name,Color_R,Color_G,Color_B,Color_A,layer,voxels,voxel_volume_mm3,"
          "mesh_volume_mm3,area_mm2,triangles,components,neighbour_areas_mm2",
          out);
    if (has_errors(r))
        fputs(",max_error_mm,rms_error_mm", out);
    if (cli_cleans_labels(r->args))
        fputs(",voxels_before,components_removed,voxels_removed,voxels_added", out);
    fputc('\n', out);
    for (size_t n = 0; n < r->item_count; n++)
        put_row(out, r, &r->items[n]);
}

cw_status cli_write_label_table(const cli_label_run *r, cw_error *err)
{
    return cli_report_make(r->args->table, put_table, r, err);
}

void cli_put_label_params(cli_json *j, const void *p, const cli_made *made)
{
    const cli_label_run *r = p;
    (void)made;
    cli_json_text(j, "labels", r->args->labels);
    cli_json_number(j, "smooth_labels_voxels", r->max_move);
    if (r->error_mm > 0)
        cli_json_number(j, "simplify_error_mm", r->error_mm);
    else if (r->target)
        cli_json_count(j, "simplify_triangles", r->target);
    if (r->extracted)
        cli_json_bool(j, "per_label", r->args->per_label);
    cli_json_bool(j, "open", r->args->open);
    cli_json_bool(j, "shared_faces", r->args->shared_faces);
    cli_json_text(j, "normals", r->args->normals ? "none" : "mesh");
    cli_json_count(j, "step", r->args->input.step);
}

static void put_neighbours(cli_json *j, const cli_label_run *r, const cli_label_item *item)
{
    const cw_label_surfaces *s = &item->layer->surfaces;
    uint32_t other;
    cli_json_open(j, "neighbours", '[');
    for (size_t p = 0; p < s->patch_count; p++)
        if (find_neighbour(item, &s->patches[p], &other)) {
            cli_json_open(j, NULL, '{');
            const cw_label label = find_label(r, item, other);
            cli_json_label(j, "label", &label);
            cli_json_number(j, "area", cw_label_patch_area(s, &s->patches[p]));
            cli_json_close(j, '}');
        }
    cli_json_close(j, ']');
}

static void put_item(cli_json *j, const cli_label_run *r, const cli_label_item *item)
{
    const uint8_t *c = item->label.color;
    char hex[16];
    snprintf(hex, sizeof hex, "#%02X%02X%02X", c[0], c[1], c[2]);
    cli_json_open(j, NULL, '{');
    cli_json_label(j, "label", &item->label);
    if (item->label.layer > 0)
        cli_json_count(j, "layer", item->label.layer);
    cli_json_text(j, "name", item->name);
    cli_json_text(j, "color", hex);
    cli_json_number(j, "opacity", c[3] / 255.0);
    cli_json_count(j, "voxels", item->voxels);
    cli_json_number(j, "voxel_volume", voxel_mm3(r) * (double)item->voxels);
    cli_json_number(j, "mesh_volume",
                    item->facts.quality.open_edges ? NAN : item->facts.quality.volume_mm3);
    cli_json_number(j, "area", item->facts.quality.area_mm2);
    cli_json_count(j, "triangles", item->facts.quality.triangles);
    cli_json_count(j, "components", item->facts.quality.components);
    if (!isnan(item->max_error_mm)) {
        cli_json_number(j, "max_error", item->max_error_mm);
        cli_json_number(j, "rms_error", item->rms_error_mm);
    }
    const cw_label_change *change = cli_find_label_change(item);
    if (change) {
        cli_json_open(j, "cleaned", '{');
        cli_json_count(j, "voxels_before", change->voxels_before);
        cli_json_count(j, "components_removed", change->components_removed);
        cli_json_count(j, "voxels_removed", change->voxels_removed);
        cli_json_count(j, "voxels_added", change->voxels_added);
        cli_json_close(j, '}');
    }
    put_neighbours(j, r, item);
    cli_json_stages(j, &item->facts, 0);
    cli_json_close(j, '}');
}

void cli_put_labels(cli_json *j, const void *p)
{
    const cli_label_run *r = p;
    if (r->names.path) {
        cli_json_open(j, "names", '{');
        cli_json_text(j, "path", cli_shown_path(r->names.path));
        cli_json_text(j, "kind", r->names.format);
        cli_json_close(j, '}');
    }
    cli_json_open(j, "labels", '[');
    for (size_t n = 0; n < r->item_count; n++)
        put_item(j, r, &r->items[n]);
    cli_json_close(j, ']');
    cli_json_open(j, "missing_labels", '[');
    for (size_t n = 0; n < r->choice.count; n++)
        if (!r->choice.labels[n].is_found)
            cli_json_label(j, NULL,
                           &(cw_label){.value = r->choice.labels[n].value,
                                       .id = r->choice.labels[n].id,
                                       .is_negative = r->choice.labels[n].is_negative});
    cli_json_close(j, ']');
}
