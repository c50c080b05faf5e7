/* Cleans the voxels of labels before they are extracted, and says what became of them. */
#include "cli/extract/label_run.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"

#include <math.h>
#include <stdio.h>

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
    char list[200] = "";
    size_t components = 0, removed = 0, added = 0, gone = 0, used = 0;
    for (size_t l = 0; l < r->layer_count; l++)
        for (size_t n = 0; n < r->layers[l].change_count; n++) {
            const cw_label_change *c = &r->layers[l].changes[n];
            char name[CLI_LABEL_NAME], number[CW_LABEL_NUMBER];
            components += c->components_removed;
            removed += c->voxels_removed;
            added += c->voxels_added;
            if (c->voxels)
                continue;
            const cw_label label =
                cli_complete_label(&r->names.table, r->layers[l].number, c->label, name);
            if (used < sizeof list - 1)
                used +=
                    (size_t)snprintf(list + used, sizeof list - used, "%s%s (%.40s)",
                                     gone ? ", " : "", cw_label_number(&label, number), name);
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
