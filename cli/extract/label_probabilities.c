/* Reads the fields of `extract --labels --probabilities`: the components and time steps of one file, or a
 * file a label. */
#include "cli/extract/label_run.h"

#include "cli/framework/console.h"
#include "cli/framework/name_template.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <math.h>
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

/* Reads all inputs into memory, of which the limit leaves less from one to the next. Of the first one the
 * header is told. */
static cw_status read_files(cli_label_run *r, cw_error *err)
{
    const cli_common *common = &r->args->common;
    cli_input input = r->args->input;
    input.array.component.given = input.step_chosen = true; /* all are taken */
    r->fields.more = calloc(common->input_count, sizeof *r->fields.more);
    if (!r->fields.more)
        return cwi_fail_memory(err);
    cw_status st = cli_read_volume(common->inputs[0], &input, false, &r->volume, err);
    const cli_volume *last = &r->volume;
    input.is_quiet = true;
    for (size_t n = 1; n < common->input_count && st == CW_OK; n++) {
        cli_volume *next = &r->fields.more[n - 1];
        input.memory = last->memory_left;
        st = cli_read_volume(common->inputs[n], &input, false, next, err);
        r->fields.more_count += st == CW_OK;
        last = next;
    }
    return st;
}

static const cli_volume *file_at(const cli_label_run *r, size_t n)
{
    return n == 0 ? &r->volume : &r->fields.more[n - 1];
}

/* Lists the fields of all files: components of the first time step, then of the next. */
static cw_status list_fields(cli_label_run *r, cw_error *err)
{
    cli_label_fields *f = &r->fields;
    size_t count = 0;
    for (size_t n = 0; n <= f->more_count; n++)
        count += file_at(r, n)->voxels.components * file_at(r, n)->voxels.steps;
    f->views = calloc(count, sizeof *f->views);
    f->names = calloc(count, sizeof *f->names);
    if (!f->views || !f->names)
        return cwi_fail_memory(err);
    for (size_t n = 0; n <= f->more_count; n++) {
        const cli_volume *file = file_at(r, n);
        for (size_t t = 0; t < file->voxels.steps; t++)
            for (size_t c = 0; c < file->voxels.components; c++) {
                cw_status st = cw_volume_select(&file->voxels, c, t,
                                                &f->views[f->scores.count], err);
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
static cw_status find_masks(const cli_label_run *r, bool *are_masks, cw_error *err)
{
    enum { BINS = 256 };
    cw_status st = CW_OK;
    *are_masks = true;
    for (size_t n = 0; n < r->fields.scores.count && st == CW_OK && *are_masks; n++) {
        cw_statistics s;
        st = cw_volume_statistics(&r->fields.views[n], BINS, (int)r->args->input.threads, &s, err);
        for (size_t b = 1; st == CW_OK && b + 1 < s.bin_count; b++)
            *are_masks = *are_masks && s.bins[b] == 0;
        if (st == CW_OK)
            cw_statistics_free(&s);
    }
    return st;
}

static void tell_fields(const cli_label_run *r)
{
    const cw_label_scores *s = &r->fields.scores;
    char files[48] = "", value[64] = "the background is 1 minus their sum";
    if (r->fields.more_count)
        snprintf(files, sizeof files, " and %zu more file%s", r->fields.more_count,
                 r->fields.more_count == 1 ? "" : "s");
    if (s->rule == CW_BACKGROUND_FIELD)
        snprintf(value, sizeof value, "the first is the background");
    else if (s->rule == CW_BACKGROUND_VALUE)
        snprintf(value, sizeof value, "below %.6g is background", s->value);
    cli_say("%s%s: %zu field%s of labels; %s", r->volume.path, files, s->count,
            s->count == 1 ? "" : "s", value);
}

cw_status cli_read_label_fields(cli_label_run *r, cw_error *err)
{
    cw_status st = cli_parse_probabilities(r->args->probabilities, &r->fields.scores, err);
    if (st == CW_OK)
        st = read_files(r, err);
    if (st == CW_OK)
        st = list_fields(r, err);
    if (st != CW_OK)
        return st;
    if (r->fields.scores.count == 1 && r->fields.scores.rule == CW_BACKGROUND_FIELD)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s: there is one field, and --probabilities first takes it as that of the "
                        "background; a value such as 0.5 takes it as a label's",
                        r->volume.path);
    tell_fields(r);
    bool are_masks;
    st = find_masks(r, &are_masks, err);
    if (st == CW_OK && are_masks)
        cli_say("%s: fields have two values only, as masks do: surfaces stay in steps. A label map of "
                "all is smoothed, without --probabilities",
                r->volume.path);
    return st;
}

cw_status cli_name_label_fields(cli_label_run *r, cw_error *err)
{
    const bool has_background = r->fields.scores.rule == CW_BACKGROUND_FIELD;
    cw_status st = CW_OK;
    if (r->fields.scores.count != r->fields.more_count + 1)
        return CW_OK; /* some files hold several */
    for (size_t n = has_background; n < r->fields.scores.count && st == CW_OK; n++) {
        char *stem = cli_stem(r->fields.names[n]);
        const cw_label label = {.value = (uint32_t)(n + !has_background), .name = stem};
        st = stem ? cw_label_table_add(&r->names.table, &label, err) : cwi_fail_memory(err);
        free(stem);
    }
    return st;
}
