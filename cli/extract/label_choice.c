/* Resolves the labels that --labels chooses. */
#define _GNU_SOURCE /* FNM_CASEFOLD */
#include "cli/extract/label_choice.h"

#include "cli/framework/options.h"
#include "core/base/status.h"

#include <ctype.h>
#include <fnmatch.h>
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

static cw_status add_chosen(cli_label_choice *choice, cli_chosen_label label, cw_error *err)
{
    if (label.value == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--labels: 0 is the background, not a label");
    if (choice->count == choice->capacity) {
        const size_t capacity = choice->capacity ? 2 * choice->capacity : 16;
        cli_chosen_label *grown = realloc(choice->labels, capacity * sizeof *grown);
        if (!grown)
            return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu labels", capacity);
        choice->labels = grown;
        choice->capacity = capacity;
    }
    choice->labels[choice->count++] = label;
    return CW_OK;
}

/* Reads "7" or "7-9". Returns false for anything else. */
static bool read_range(const char *item, uint64_t *first, uint64_t *last)
{
    char *end;
    if (!isdigit((unsigned char)*item))
        return false;
    *first = *last = strtoull(item, &end, 10);
    if (*end == '-' && isdigit((unsigned char)end[1]))
        *last = strtoull(end + 1, &end, 10);
    return *end == '\0';
}

static cw_status add_range(cli_label_choice *choice, const char *item, uint64_t first,
                           uint64_t last, cw_error *err)
{
    if (last > UINT32_MAX || first > last)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--labels: '%s' is no range of labels, which are 1 to 4294967295",
                        item);
    if (last - first >= MAX_RANGE)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--labels: '%s' is longer than %d labels", item,
                        MAX_RANGE);
    cw_status st = CW_OK;
    for (uint64_t value = first; value <= last && st == CW_OK; value++)
        st = add_chosen(
            choice, (cli_chosen_label){.value = (uint32_t)value, .of_all_layers = true}, err);
    return st;
}

/* Reports a name that the table does not have, with the nearest. */
static cw_status fail_unknown(const char *item, const cw_label_table *table, cw_error *err)
{
    const char **names = calloc(table->count + 1, sizeof *names);
    size_t count = 0;
    if (table->count == 0) {
        free(names);
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--labels: '%s' is no number, and no names are known; --names FILE "
                        "states them",
                        item);
    }
    for (size_t n = 0; names && n < table->count; n++)
        if (table->labels[n].name)
            names[count++] = table->labels[n].name;
    const char *nearest = names ? cli_nearest(item, names) : NULL;
    free(names);
    return nearest
               ? cwi_fail(err, CW_ERR_ARGUMENT,
                          "--labels: no label is named '%s'; did you mean '%s'?", item, nearest)
               : cwi_fail(err, CW_ERR_ARGUMENT,
                          "--labels: no label is named '%s'; 'cubewright info' lists them",
                          item);
}

static cw_status add_names(cli_label_choice *choice, const char *item,
                           const cw_label_table *table, cw_error *err)
{
    cw_status st = CW_OK;
    bool is_known = false;
    for (size_t n = 0; n < table->count && st == CW_OK; n++) {
        const cw_label *label = &table->labels[n];
        if (!label->name || fnmatch(item, label->name, FNM_CASEFOLD) != 0 || !label->value)
            continue;
        is_known = true;
        st = add_chosen(choice,
                        (cli_chosen_label){.value = label->value, .layer = label->layer}, err);
    }
    return st == CW_OK && !is_known ? fail_unknown(item, table, err) : st;
}

cw_status cli_choose_labels(const char *text, const cw_label_table *table,
                            cli_label_choice *choice, cw_error *err)
{
    cw_status st = CW_OK;
    *choice = (cli_label_choice){.all = strcmp(text, "all") == 0};
    for (const char *at = text; !choice->all && st == CW_OK; at++) {
        char item[ITEM_BYTES];
        uint64_t first, last;
        const size_t length = strcspn(at, ",");
        if (length == 0 || length >= sizeof item)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "--labels %s: expected is 'all', or a list such as 1,5,7-9,Liver",
                            text);
        snprintf(item, sizeof item, "%.*s", (int)length, at);
        st = read_range(item, &first, &last) ? add_range(choice, item, first, last, err)
                                             : add_names(choice, item, table, err);
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
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu labels", choice->count);
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
