/* Counts the labels of a label map, finds their names, and prints them. */
#include "cli/info/info_labels.h"

#include "cli/framework/quantity.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <stdio.h>
#include <stdlib.h>

/* More labels are in the JSON only. */
enum { MAX_LINES = 500 };

void cli_free_label_facts(cli_label_facts *facts)
{
    cli_free_label_names(&facts->names);
    free(facts->labels);
    *facts = (cli_label_facts){0};
}

static cw_status add_counts(cli_label_facts *facts, uint32_t layer,
                            const cw_label_count *counts, size_t count, cw_error *err)
{
    cli_counted_label *grown =
        realloc(facts->labels, (facts->count + count + 1) * sizeof *grown);
    if (!grown)
        return cwi_fail_memory(err);
    facts->labels = grown;
    for (size_t n = 0; n < count; n++)
        facts->labels[facts->count++] =
            (cli_counted_label){counts[n].label, layer, counts[n].voxels};
    return CW_OK;
}

/* Counts the labels of all components. Values that are no labels, such as negative ones, make
 * the volume no label map. */
static cw_status count_layers(const cli_volume *volume, cli_label_facts *facts, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t c = 0; c < volume->voxels.components && st == CW_OK; c++) {
        cw_volume view;
        cw_label_count *counts = NULL;
        size_t count = 0;
        st = cw_volume_select(&volume->voxels, c, 0, &view, err);
        if (st == CW_OK)
            st = cw_label_counts(&view, 0, &counts, &count, err);
        if (st == CW_ERR_ARGUMENT) {
            facts->is_label_map = false;
            return CW_OK;
        }
        if (st == CW_OK)
            st = add_counts(facts, (uint32_t)c, counts, count, err);
        cw_label_counts_free(counts);
    }
    return st;
}

cw_status cli_find_label_facts(const char *names_path, cli_volume *volume,
                               cli_label_facts *facts, cw_error *err)
{
    cw_labels labels;
    *facts = (cli_label_facts){0};
    cw_status st = cw_volume_labels(&volume->voxels, &labels, err);
    if (st == CW_ERR_NO_MEMORY && !names_path) /* its labels are left out */
        return CW_OK;
    facts->is_label_map =
        st == CW_OK && (labels.found || names_path) && !volume->magnitude.data;
    if (facts->is_label_map)
        st = count_layers(volume, facts, err);
    if (st == CW_OK && facts->is_label_map)
        st = cli_find_label_names(names_path, volume, &facts->names, err);
    return st;
}

void cli_print_label_facts(const cli_label_facts *facts, bool is_sampled)
{
    if (!facts->is_label_map)
        return;
    printf("  labels   %s", cli_count(facts->count));
    if (facts->names.path)
        printf(", names from %s (%s)", cli_shown_path(facts->names.path), facts->names.format);
    else if (facts->names.table.count)
        printf(", names from the volume itself");
    puts(is_sampled ? "; voxels are those of the rows that were read (--deep reads all)" : "");
    for (size_t n = 0; n < facts->count && n < MAX_LINES; n++) {
        const cli_counted_label *l = &facts->labels[n];
        char name[CLI_LABEL_NAME];
        const cw_label label =
            cli_complete_label(&facts->names.table, l->layer, l->value, name);
        const uint8_t *c = label.color;
        printf("  %10s  #%02x%02x%02x  %s voxels  %s",
               cw_label_number(&label, (char[CW_LABEL_NUMBER]){0}), c[0], c[1], c[2],
               cli_count(l->voxels), name);
        if (l->layer > 0)
            printf(", in component %u", l->layer);
        puts(label.hidden ? ", hidden in 3D" : "");
    }
    if (facts->count > MAX_LINES)
        printf("  and %s more labels, which --json lists\n",
               cli_count(facts->count - MAX_LINES));
    puts("  extract  --labels all, or a list of numbers and names");
}

void cli_json_label_facts(cli_json *j, const cli_label_facts *facts)
{
    if (!facts->is_label_map)
        return;
    cli_json_open(j, "labels", '[');
    for (size_t n = 0; n < facts->count; n++) {
        const cli_counted_label *l = &facts->labels[n];
        char name[CLI_LABEL_NAME], hex[16];
        const cw_label label =
            cli_complete_label(&facts->names.table, l->layer, l->value, name);
        snprintf(hex, sizeof hex, "#%02X%02X%02X", label.color[0], label.color[1],
                 label.color[2]);
        cli_json_open(j, NULL, '{');
        cli_json_label(j, "label", &label);
        if (l->layer > 0)
            cli_json_count(j, "layer", l->layer);
        cli_json_text(j, "name", name);
        cli_json_text(j, "color", hex);
        cli_json_count(j, "voxels", l->voxels);
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}
