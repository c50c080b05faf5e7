/* Resolves the labels that an option chooses, and the limit of their smoothing. */
#define _GNU_SOURCE /* FNM_CASEFOLD */
#include "cli/inputs/label_choice.h"

#include "cli/framework/options.h"
#include "cli/framework/quantity.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/label_ids.h"

#include <ctype.h>
#include <fnmatch.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The longest range of numbers: it is listed in memory. */
enum { MAX_RANGE = 1 << 20, ITEM_BYTES = 256 };

void cli_free_label_choice(cli_label_choice *choice)
{
    free(choice->labels);
    *choice = (cli_label_choice){0};
}

static cw_status add_chosen(const char *option, cli_label_choice *choice,
                            cli_chosen_label label, cw_error *err)
{
    if (label.value == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s: 0 is the background, not a label", option);
    if (choice->count == choice->capacity) {
        const size_t capacity = choice->capacity ? 2 * choice->capacity : 16;
        cli_chosen_label *grown = realloc(choice->labels, capacity * sizeof *grown);
        if (!grown)
            return cwi_fail_memory(err);
        choice->labels = grown;
        choice->capacity = capacity;
    }
    choice->labels[choice->count++] = label;
    return CW_OK;
}

/* Reads "7" or "7-9"; a number of 64 bits or below 0 by itself. Returns false for anything else. */
static bool read_range(const char *item, cw_label *first, cw_label *last)
{
    char from[ITEM_BYTES];
    const size_t sign = *item == '-', length = sign + strspn(item + sign, "0123456789");
    snprintf(from, sizeof from, "%.*s", (int)length, item);
    if (!cw_label_parse(from, first))
        return false;
    *last = *first;
    return item[length] == '\0' ||
           (item[length] == '-' && cw_label_parse(item + length + 1, last));
}

/* The labels that are known: those with names, and the numbers of those with voxels. */
typedef struct known_labels {
    const cw_label_table *table;
    const cw_label_ids *ids;
} known_labels;

/* Adds a label by its number. */
static cw_status add_number(const char *option, cli_label_choice *choice, const cw_label *label,
                            const known_labels *known, cw_error *err)
{
    cli_chosen_label chosen = {.value = cw_label_ids_find(known->ids, label),
                               .id = cwi_label_size(label),
                               .is_negative = label->is_negative,
                               .of_all_layers = true};
    const cw_label_table *t = known->table;
    for (size_t n = 0; n < t->count && chosen.value == UINT32_MAX; n++) /* one without voxels */
        if (cwi_label_size(&t->labels[n]) == chosen.id &&
            t->labels[n].is_negative == chosen.is_negative)
            chosen.value = t->labels[n].value;
    return add_chosen(option, choice, chosen, err);
}

static cw_status add_range(const char *option, cli_label_choice *choice, const char *item,
                           const cw_label ends[2], const known_labels *known, cw_error *err)
{
    const uint64_t first = cwi_label_size(&ends[0]), last = cwi_label_size(&ends[1]);
    if (first == last && ends[0].is_negative == ends[1].is_negative)
        return add_number(option, choice, &ends[0], known, err);
    if (ends[0].is_negative || ends[1].is_negative || first > last)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s: '%s' is no range of labels, such as 7-9; those below 0 are stated "
                        "one by one",
                        option, item);
    if (last - first >= MAX_RANGE)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s: '%s' is longer than %d labels", option, item,
                        MAX_RANGE);
    cw_status st = CW_OK;
    for (uint64_t n = 0; n <= last - first && st == CW_OK; n++) {
        const uint64_t value = first + n;
        const bool fits = value <= UINT32_MAX;
        const cw_label label = {.value = fits ? (uint32_t)value : 0, .id = fits ? 0 : value};
        st = add_number(option, choice, &label, known, err);
    }
    return st;
}

/* Reports a name that the table does not have, with the nearest. */
static cw_status fail_unknown(const char *option, const char *item, const cw_label_table *table,
                              cw_error *err)
{
    const char **names = calloc(table->count + 1, sizeof *names);
    size_t count = 0;
    if (table->count == 0) {
        free(names);
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s: '%s' is no number, and no names are known; --names FILE "
                        "states them",
                        option, item);
    }
    for (size_t n = 0; names && n < table->count; n++)
        if (table->labels[n].name)
            names[count++] = table->labels[n].name;
    const char *nearest = names ? cli_nearest(item, names) : NULL;
    free(names);
    return nearest ? cwi_fail(err, CW_ERR_ARGUMENT,
                              "%s: no label is named '%s'; did you mean '%s'?", option, item,
                              nearest)
                   : cwi_fail(err, CW_ERR_ARGUMENT,
                              "%s: no label is named '%s'; 'cubewright info' lists them",
                              option, item);
}

static cw_status add_names(const char *option, cli_label_choice *choice, const char *item,
                           const cw_label_table *table, cw_error *err)
{
    cw_status st = CW_OK;
    bool is_known = false;
    for (size_t n = 0; n < table->count && st == CW_OK; n++) {
        const cw_label *label = &table->labels[n];
        if (!label->name || fnmatch(item, label->name, FNM_CASEFOLD) != 0 || !label->value)
            continue;
        is_known = true;
        st = add_chosen(option, choice,
                        (cli_chosen_label){.value = label->value,
                                           .layer = label->layer,
                                           .id = cwi_label_size(label),
                                           .is_negative = label->is_negative},
                        err);
    }
    return st == CW_OK && !is_known ? fail_unknown(option, item, table, err) : st;
}

cw_status cli_choose_labels(const char *option, const char *text, const cw_label_table *table,
                            const cw_label_ids *ids, cli_label_choice *choice, cw_error *err)
{
    const known_labels known = {table, ids};
    cw_status st = CW_OK;
    *choice = (cli_label_choice){.all = strcmp(text, "all") == 0};
    for (const char *at = text; !choice->all && st == CW_OK; at++) {
        char item[ITEM_BYTES];
        cw_label ends[2] = {{0}};
        const size_t length = strcspn(at, ",");
        if (length == 0 || length >= sizeof item)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "%s %s: expected is 'all', or a list such as 1,5,7-9,Liver", option,
                            text);
        snprintf(item, sizeof item, "%.*s", (int)length, at);
        st = read_range(item, &ends[0], &ends[1])
                 ? add_range(option, choice, item, ends, &known, err)
                 : add_names(option, choice, item, table, err);
        at += length;
        if (!*at)
            break;
    }
    return st;
}

cw_status cli_labels_of_layer(const cli_label_choice *choice, uint32_t layer, uint32_t **values,
                              size_t *count, cw_error *err)
{
    *count = 0;
    *values = calloc(choice->count + 1, sizeof **values);
    if (!*values)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < choice->count; n++)
        if (choice->labels[n].of_all_layers || choice->labels[n].layer == layer)
            (*values)[(*count)++] = choice->labels[n].value;
    return CW_OK;
}

void cli_mark_found(cli_label_choice *choice, uint32_t layer, uint32_t value)
{
    for (size_t n = 0; n < choice->count; n++) {
        cli_chosen_label *label = &choice->labels[n];
        if (label->value == value && (label->of_all_layers || label->layer == layer))
            label->is_found = true;
    }
}

size_t cli_list_missing(const cli_label_choice *choice, const cw_label_table *table, char *list,
                        size_t size)
{
    size_t used = 0, missing = 0;
    *list = '\0';
    for (size_t n = 0; n < choice->count; n++) {
        const cli_chosen_label *chosen = &choice->labels[n];
        char name[CLI_LABEL_NAME], number[CW_LABEL_NUMBER];
        if (chosen->is_found)
            continue;
        const cw_label known = cli_complete_label(table, chosen->layer, chosen->value, name);
        const cw_label label = {.id = chosen->id, .is_negative = chosen->is_negative};
        cw_label_number(&label, number);
        if (chosen->value == UINT32_MAX && !cw_label_find(table, known.layer, known.value))
            snprintf(name, sizeof name, "label_%s", number);
        if (used < size - 1)
            used += (size_t)snprintf(list + used, size - used, "%s%s (%.60s)",
                                     missing ? ", " : "", number, name);
        missing++;
    }
    return missing;
}

cw_status cli_find_label_move(const cli_length *length, const double spacing[3],
                              double *max_move, cw_error *err)
{
    const double voxel = fmax(spacing[0], fmax(spacing[1], spacing[2]));
    *max_move = length->given ? 0 : 0.5;
    if (!length->given || length->is_word)
        return CW_OK;
    *max_move = length->unit == CLI_VOXELS ? length->value : length->value / voxel;
    if (!(*max_move > 0 && *max_move <= 0.5))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--smooth-labels %s is %.3g voxels; above 0 and up to 0.5 was expected",
                        cli_length_text(length), *max_move);
    return CW_OK;
}
