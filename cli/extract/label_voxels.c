/* Samples the voxels of labels at other distances and cleans them before they are extracted, and says what
 * became of them. */
#include "cli/extract/label_run.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/inputs/volume_prepare.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void cli_list_label(const cli_label_run *r, uint32_t layer, uint32_t value,
                    char list[CLI_LABEL_LIST])
{
    char name[CLI_LABEL_NAME], number[CW_LABEL_NUMBER];
    char text[CLI_LABEL_NAME + CW_LABEL_NUMBER + 8];
    const size_t used = strlen(list), room = CLI_LABEL_LIST - sizeof ", ...";
    const cw_label label = cli_complete_label(&r->names.table, layer, value, name);
    snprintf(text, sizeof text, "%s%s (%.40s)", used ? ", " : "",
             cw_label_number(&label, number), name);
    if (used >= 3 && strcmp(list + used - 3, "...") == 0)
        return;
    snprintf(list + used, CLI_LABEL_LIST - used, "%s",
             used + strlen(text) <= room ? text : ", ...");
}

void cli_tell_absent_fields(const cli_label_run *r)
{
    const cw_label_scores *scores = &r->fields.scores;
    const bool has_background = scores->rule == CW_BACKGROUND_FIELD;
    const cw_label_surfaces *s = &r->layers[0].surfaces;
    char list[CLI_LABEL_LIST] = "";
    size_t absent = 0, next = 0;
    for (size_t n = has_background; n < scores->count; n++) {
        const uint32_t label = (uint32_t)(n + !has_background);
        while (next < s->label_count && s->labels[next].label < label)
            next++;
        if (next < s->label_count && s->labels[next].label == label)
            continue;
        cli_list_label(r, 0, label, list);
        absent++;
    }
    if (absent)
        cli_say("%s: %zu field%s the largest at no voxel: label%s %s", r->volume.path, absent,
                absent == 1 ? " is" : "s are", absent == 1 ? "" : "s", list);
}

/* --- other distances --------------------------------------------------------------------- */

static int compare_label(const void *key, const void *count)
{
    const uint32_t label = *(const uint32_t *)key,
                   other = ((const cw_label_count *)count)->label;
    return (label > other) - (label < other);
}

/* Says which labels, of those to be extracted, had voxels and have none any more. */
static cw_status tell_lost(const cli_label_run *r, const cw_volume *view,
                           const cw_volume *sampled, uint32_t layer, const cw_labels_desc *desc,
                           cw_error *err)
{
    cw_label_count *old = NULL, *now = NULL;
    size_t old_count = 0, now_count = 0, lost = 0;
    char list[CLI_LABEL_LIST] = "";
    cw_status st = cw_label_counts(view, desc->background, &old, &old_count, err);
    if (st == CW_OK)
        st = cw_label_counts(sampled, desc->background, &now, &now_count, err);
    const size_t count = desc->label_count ? desc->label_count : old_count;
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        const uint32_t label = desc->label_count ? desc->labels[n] : old[n].label;
        if (bsearch(&label, now, now_count, sizeof *now, compare_label) ||
            !bsearch(&label, old, old_count, sizeof *old, compare_label))
            continue;
        cli_list_label(r, layer, label, list);
        lost++;
    }
    if (lost)
        cli_say("%s: %zu label%s lost by --resample: %s", r->volume.path, lost,
                lost == 1 ? " is" : "s are", list);
    cw_label_counts_free(old);
    cw_label_counts_free(now);
    return st;
}

/* Says how the first component was sampled; the others are in the same grid. */
static void note_grid(cli_label_run *r, const double old[3], const double mm[3],
                      const cw_volume *sampled, cw_label_kernel kernel)
{
    if (r->grid.dim[0])
        return;
    cli_note_volume(&r->volume,
                    "resampled from %g x %g x %g mm to %g x %g x %g mm, %zu x %zu x %zu "
                    "voxels, %s",
                    old[0], old[1], old[2], mm[0], mm[1], mm[2], sampled->dim[0],
                    sampled->dim[1], sampled->dim[2], cw_label_kernel_name(kernel));
    r->grid = *sampled;
    r->grid.data = r->grid.owned = r->grid.owned_grid = NULL;
    cli_report_end(&r->report, "resample",
                   r->volume.view.dim[0] * r->volume.view.dim[1] * r->volume.view.dim[2],
                   sampled->dim[0] * sampled->dim[1] * sampled->dim[2]);
    cli_report_begin(&r->report);
}

cw_status cli_resample_labels(cli_label_run *r, const cw_volume *view, uint32_t layer,
                              const cw_labels_desc *desc, cw_volume *sampled, cw_error *err)
{
    const cli_resample *resample = &r->args->input.resample;
    cw_label_resample_desc d = {.kernel = (cw_label_kernel)resample->label_kernel,
                                .background = desc->background,
                                .threads = desc->threads,
                                .max_bytes = r->volume.memory_left,
                                .progress = desc->progress};
    double old[3];
    cli_resample_spacing(resample, view, old, d.spacing_mm);
    cw_status st = cw_labels_resample(view, &d, sampled, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "--resample");
    note_grid(r, old, d.spacing_mm, sampled, d.kernel);
    st = tell_lost(r, view, sampled, layer, desc, err);
    if (st != CW_OK)
        cw_volume_free(sampled);
    return st;
}

/* --- cleaning ---------------------------------------------------------------------------- */

bool cli_cleans_labels(const cli_extract_args *args)
{
    return args->labels && (args->least.given || args->largest || args->fill_voids);
}

void cli_free_label_layer(cli_label_layer *layer)
{
    cw_label_surfaces_free(&layer->surfaces);
    cw_label_changes_free(layer->changes);
}

/* Converts --min-volume to a number of voxels. */
static cw_status find_least(const cli_label_run *r, const cw_volume *view, size_t *voxels,
                            cw_error *err)
{
    const cli_amount *least = &r->args->least;
    const double voxel = fabs(cwi_affine_determinant(view->affine[0]));
    *voxels = 0;
    if (!least->given)
        return CW_OK;
    if (!least->voxels && view->coordinates[0])
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "%s: its voxels differ in size: --min-volume of labels is then a number "
            "of voxels, such as 30vox",
            r->volume.path);
    *voxels = (size_t)ceil(least->voxels ? least->value : least->value / voxel * (1 - 1e-9));
    return CW_OK;
}

cw_status cli_clean_and_extract(const cli_label_run *r, const cw_volume *view,
                                const cw_labels_desc *desc, cli_label_layer *layer,
                                cw_error *err)
{
    cw_label_clean_desc clean = {.largest = r->args->largest,
                                 .fill_voids = r->args->fill_voids};
    cw_volume cleaned;
    cw_status st = find_least(r, view, &clean.min_voxels, err);
    if (st == CW_OK)
        st =
            cw_labels_clean(view, &clean, &cleaned, &layer->changes, &layer->change_count, err);
    if (st != CW_OK)
        return st;
    st = cw_extract_labels(&cleaned, desc, &layer->surfaces, err);
    cw_volume_free(&cleaned);
    return st;
}

void cli_tell_cleaning(const cli_label_run *r)
{
    char list[CLI_LABEL_LIST] = "";
    size_t components = 0, removed = 0, added = 0, gone = 0;
    for (size_t l = 0; l < r->layer_count; l++)
        for (size_t n = 0; n < r->layers[l].change_count; n++) {
            const cw_label_change *c = &r->layers[l].changes[n];
            components += c->components_removed;
            removed += c->voxels_removed;
            added += c->voxels_added;
            if (c->voxels)
                continue;
            cli_list_label(r, r->layers[l].number, c->label, list);
            gone++;
        }
    if (!cli_cleans_labels(r->args))
        return;
    cli_say(
        "%s: cleaned: %s component%s of labels (%s voxels) went to neighbours; labels got %s "
        "voxels",
        r->volume.path, cli_count(components), components == 1 ? "" : "s", cli_count(removed),
        cli_count(added));
    if (gone)
        cli_say("%s: %zu label%s removed altogether: %s", r->volume.path, gone,
                gone == 1 ? " is" : "s are", list);
}

const cw_label_change *cli_find_label_change(const cli_label_item *item)
{
    const cli_label_layer *layer = item->layer;
    size_t low = 0, high = layer->change_count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (layer->changes[middle].label < item->label.value)
            low = middle + 1;
        else
            high = middle;
    }
    return low < layer->change_count && layer->changes[low].label == item->label.value
               ? &layer->changes[low]
               : NULL;
}
