/* Tells of labels: the table of --table, and their part of the JSON report. */
#include "cli/extract/label_run.h"

#include "cli/framework/console.h"
#include "cli/results/stage_facts.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/affine.h"

#include <cubewright/labels.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WORST = 3 }; /* labels that a note names */

/* The fraction of their voxels' volume to which smoothing keeps labels. */
static const double MAX_VOLUME_ERROR = 0.005;

/* Returns the volume of a voxel in cubic millimetres; NAN where voxels differ in size. */
static double voxel_mm3(const cli_label_run *r)
{
    const cw_volume *v = cli_label_grid(r);
    for (int a = 0; a < 3; a++)
        if (v->coordinates[a])
            return NAN;
    return fabs(cwi_affine_determinant(v->affine[0]));
}

cw_status cli_measure_label_volumes(cli_label_run *r, cw_error *err)
{
    const double voxel = voxel_mm3(r);
    size_t next = 0;
    for (size_t l = 0; l < r->layer_count; l++) {
        const cw_label_surfaces *s = &r->layers[l].surfaces;
        double *volumes = cwi_alloc_array(s->label_count, sizeof *volumes);
        if (!volumes)
            return cwi_fail_memory(err);
        cw_label_volumes(s, volumes);
        for (size_t n = 0; n < s->label_count && next < r->item_count; n++) {
            cli_label_item *item = &r->items[next];
            if (item->layer != &r->layers[l] || item->label.value != s->labels[n].label)
                continue; /* hidden */
            item->volume_error = r->args->open || r->args->probabilities
                                     ? NAN
                                     : volumes[n] / (voxel * (double)item->voxels) - 1;
            next++;
        }
        cwi_free(volumes);
    }
    return CW_OK;
}

/* Returns true if a label's surface is off its voxels' volume by more than smoothing promises. */
static bool is_off(const cli_label_item *item)
{
    return fabs(item->volume_error) > MAX_VOLUME_ERROR;
}

static int compare_off(const void *a, const void *b)
{
    const cli_label_item *x = *(const cli_label_item *const *)a,
                         *y = *(const cli_label_item *const *)b;
    const double dx = fabs(x->volume_error), dy = fabs(y->volume_error);
    return dx != dy ? (dx < dy ? 1 : -1) : (x > y) - (x < y);
}

/* Returns the name of a label for a message: its number, if it has no other. */
static const char *shown_name(const cli_label_item *item, char number[16])
{
    snprintf(number, 16, "%u", item->label.value);
    return item->name[0] ? item->name : number;
}

cw_status cli_tell_label_volumes(const cli_label_run *r, cw_error *err)
{
    const cli_label_item **off = cwi_alloc_array(r->item_count, sizeof *off);
    char list[3 * (CLI_LABEL_NAME + 32)] = "";
    size_t count = 0, length = 0;
    if (!off)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < r->item_count; n++)
        if (r->max_move > 0 && is_off(&r->items[n]))
            off[count++] = &r->items[n];
    qsort(off, count, sizeof *off, compare_off);
    for (size_t n = 0; n < count && n < WORST && length < sizeof list; n++) {
        char number[16];
        length += (size_t)snprintf(list + length, sizeof list - length, "%s%s by %+.3g %%",
                                   n ? ", " : "", shown_name(off[n], number),
                                   100 * off[n]->volume_error);
    }
    if (count > WORST)
        cli_say("%s: smoothing leaves %zu labels off the volume of their voxels by more than "
                "0.5 %%: %s, and %zu more; --table lists all",
                r->volume.path, count, list, count - WORST);
    else if (count > 0)
        cli_say("%s: smoothing leaves %zu label%s off the volume of %s voxels by more than "
                "0.5 %%: %s",
                r->volume.path, count, count == 1 ? "" : "s", count == 1 ? "its" : "their",
                list);
    cwi_free(off);
    return CW_OK;
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
    if (!isnan(item->volume_error))
        fprintf(out, ",%.4f", 100 * item->volume_error);
    else
        fputc(',', out);
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
          "mesh_volume_mm3,area_mm2,triangles,components,neighbour_areas_mm2,"
          "volume_error_percent",
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
    if (r->args->probabilities) {
        cli_json_text(j, "probabilities", r->args->probabilities);
        cli_json_count(j, "fields", r->fields.scores.count);
    }
    if (r->args->input.resample.given) {
        cli_resample resample = r->args->input.resample;
        resample.of_labels = true;
        cli_json_text(j, "resample", cli_resample_text(&resample));
    }
    cli_json_number(j, r->args->probabilities ? "max_move_voxels" : "smooth_labels_voxels",
                    r->max_move);
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
    cli_json_number(j, "volume_error_percent", 100 * item->volume_error);
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
    cli_json_open(j, "labels_off_volume", '[');
    for (size_t n = 0; n < r->item_count; n++)
        if (is_off(&r->items[n]))
            cli_json_count(j, NULL, r->items[n].label.value);
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
