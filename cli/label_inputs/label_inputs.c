/* Reads the fields of labels: the components and time steps of one file, or a file a label. */
#include "cli/label_inputs/label_inputs.h"

#include "cli/framework/console.h"
#include "cli/framework/name_template.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

cw_status cli_parse_probabilities(const char *text, cw_label_scores *scores, cw_error *err)
{
    const char *at = text;
    double value = 0;
    *scores = (cw_label_scores){.rule = CW_BACKGROUND_VALUE};
    if (strcmp(text, "first") == 0)
        scores->rule = CW_BACKGROUND_FIELD;
    else if (strcmp(text, "rest") == 0)
        scores->rule = CW_BACKGROUND_REST;
    else if (!cwi_parse_double(&at, &value) || *at || !isfinite(value))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--probabilities: '%s' is neither first, rest nor a number such as 0.5",
                        text);
    scores->has_value = scores->rule == CW_BACKGROUND_VALUE;
    scores->value = value;
    return CW_OK;
}

void cli_free_label_fields(cli_label_fields *f)
{
    for (size_t n = 0; n < f->more_count; n++)
        cli_free_volume(&f->more[n]);
    free(f->more);
    free(f->views);
    free(f->names);
    *f = (cli_label_fields){0};
}

/* Reads all inputs. Each leaves less of the memory's limit to the next. Only the first one is described. */
static cw_status read_files(const cli_common *common, const cli_input *options,
                            cli_volume *first, cli_label_fields *f, cw_error *err)
{
    cli_input input = *options;
    input.array.component.given = input.step_chosen = true; /* all are taken */
    f->more = calloc(common->input_count, sizeof *f->more);
    if (!f->more)
        return cwi_fail_memory(err);
    cw_status st = cli_read_volume(common->inputs[0], &input, false, first, err);
    const cli_volume *last = first;
    input.is_quiet = true;
    for (size_t n = 1; n < common->input_count && st == CW_OK; n++) {
        input.memory = last->memory_left;
        last = &f->more[n - 1];
        st = cli_read_volume(common->inputs[n], &input, false, &f->more[n - 1], err);
        f->more_count += st == CW_OK;
    }
    return st;
}

static const cli_volume *file_at(const cli_volume *first, const cli_label_fields *f, size_t n)
{
    return n == 0 ? first : &f->more[n - 1];
}

/* Lists the fields of all files. */
static cw_status list_fields(const cli_volume *first, cli_label_fields *f, cw_error *err)
{
    size_t count = 0;
    for (size_t n = 0; n <= f->more_count; n++)
        count += file_at(first, f, n)->voxels.components * file_at(first, f, n)->voxels.steps;
    f->views = calloc(count, sizeof *f->views);
    f->names = calloc(count, sizeof *f->names);
    if (!f->views || !f->names)
        return cwi_fail_memory(err);
    for (size_t n = 0; n <= f->more_count; n++) {
        const cli_volume *file = file_at(first, f, n);
        for (size_t i = 0; i < file->voxels.components * file->voxels.steps; i++) {
            cw_volume *view = &f->views[f->scores.count];
            cw_status st = cw_volume_select(&file->voxels, i % file->voxels.components,
                                            i / file->voxels.components, view, err);
            if (st != CW_OK)
                return cwi_fail_in(err, st, file->path);
            f->names[f->scores.count++] = f->more_count ? file->path : NULL;
        }
    }
    f->scores.fields = f->views;
    f->scores.names = f->names;
    return CW_OK;
}

/* Finds if all fields have two values at most, as masks do. */
static cw_status find_masks(const cli_label_fields *f, int threads, bool *are_masks,
                            cw_error *err)
{
    enum { BINS = 256 };
    cw_status st = CW_OK;
    *are_masks = true;
    for (size_t n = 0; n < f->scores.count && st == CW_OK && *are_masks; n++) {
        cw_statistics s;
        st = cw_volume_statistics(&f->views[n], BINS, threads, &s, err);
        for (size_t b = 1; st == CW_OK && b + 1 < s.bin_count; b++)
            *are_masks = *are_masks && s.bins[b] == 0;
        if (st == CW_OK)
            cw_statistics_free(&s);
    }
    return st;
}

static void tell_fields(const char *path, const cli_label_fields *f, bool are_masks)
{
    const cw_label_scores *s = &f->scores;
    char files[48] = "", value[64] = "the background is 1 minus their sum";
    if (f->more_count)
        snprintf(files, sizeof files, " and %zu more file%s", f->more_count,
                 f->more_count == 1 ? "" : "s");
    if (s->rule == CW_BACKGROUND_FIELD)
        snprintf(value, sizeof value, "the first is the background");
    else if (s->rule == CW_BACKGROUND_VALUE)
        snprintf(value, sizeof value, "up to %.6g is background", s->value);
    cli_say("%s%s: %zu field%s of labels; %s", path, files, s->count, s->count == 1 ? "" : "s",
            value);
    if (are_masks)
        cli_say(
            "%s: fields have two values only, as masks do: surfaces stay in steps. A label map "
            "of all is smoothed, without --probabilities",
            path);
}

cw_status cli_read_label_fields(const char *text, const cli_common *common,
                                const cli_input *options, cli_volume *first,
                                cli_label_fields *f, cw_error *err)
{
    bool are_masks = false;
    cw_status st = cli_parse_probabilities(text, &f->scores, err);
    if (st == CW_OK)
        st = read_files(common, options, first, f, err);
    if (st == CW_OK)
        st = list_fields(first, f, err);
    if (st == CW_OK && f->scores.count == 1 && f->scores.rule == CW_BACKGROUND_FIELD)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "%s: there is one field, and --probabilities first takes it as that of the "
            "background; a value such as 0.5 takes it as a label's",
            first->path);
    if (st == CW_OK)
        st = find_masks(f, (int)options->threads, &are_masks, err);
    if (st == CW_OK)
        tell_fields(first->path, f, are_masks);
    return st;
}

cw_status cli_name_label_fields(const cli_label_fields *f, cw_label_table *table, cw_error *err)
{
    const bool has_background = f->scores.rule == CW_BACKGROUND_FIELD;
    cw_status st = CW_OK;
    if (f->scores.count != f->more_count + 1)
        return CW_OK; /* some files hold several */
    for (size_t n = has_background; n < f->scores.count && st == CW_OK; n++) {
        char *stem = cli_stem(f->names[n]);
        const cw_label label = {.value = (uint32_t)(n + !has_background), .name = stem};
        st = stem ? cw_label_table_add(table, &label, err) : cwi_fail_memory(err);
        free(stem);
    }
    return st;
}
