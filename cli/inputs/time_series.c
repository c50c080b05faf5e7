/* Finds the chosen steps of a time series in one file or several, and checks that several
 * files agree. */
#include "cli/inputs/time_series.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <stdlib.h>

static cw_status fail_memory(cw_error *err)
{
    return cwi_fail_memory(err);
}

static cw_status check_known(const cw_volume *first, const char *first_path,
                             const cw_volume *other, const char *other_path, unsigned flag,
                             const char *what, cw_error *err)
{
    const bool is_known = first->known & flag;
    if (is_known == (bool)(other->known & flag))
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "%s and %s are not of one series: the first names %s %s, the second %s",
                    first_path, other_path, is_known ? "a" : "no", what,
                    is_known ? "does not" : "does");
}

cw_status cli_agree(const cw_volume *first, const char *first_path, const cw_volume *other,
                    const char *other_path, cw_error *err)
{
    const cw_volume *several = first->steps > 1 ? first : other;
    if (several->steps > 1)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "%s: holds %zu time steps; a file of a series of files holds one",
                        several == first ? first_path : other_path, several->steps);
    if (other->components != first->components)
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "%s and %s are not of one series: the first has %zu value%s a voxel, the "
            "second %zu",
            first_path, other_path, first->components, first->components == 1 ? "" : "s",
            other->components);
    cw_status st =
        check_known(first, first_path, other, other_path, CW_KNOWN_UNIT, "unit", err);
    return st == CW_OK
               ? check_known(first, first_path, other, other_path, CW_KNOWN_FRAME, "frame", err)
               : st;
}

static cw_status check_files(const cli_series *series, const cli_input *input, cw_error *err)
{
    cw_volume first = {0};
    cw_status st = CW_OK;
    for (size_t n = 0; n < series->files.count && st == CW_OK; n++) {
        const char *path = series->files.path[n];
        cw_volume other;
        st = cli_read_shape(path, input, &other, err);
        if (st != CW_OK)
            return st;
        first = n ? first : other; /* whose coordinates soon are gone */
        cw_error why = {0};
        st = cli_agree(&first, series->files.path[0], &other, path, &why);
        cw_volume_free(&other);
        if (st != CW_OK)
            st = cwi_fail(err, st, "%s; --batch takes each by itself", why.message);
    }
    return st;
}

/* Lists every step that the rows name; `total` is the number of steps in the series. */
static cw_status choose_steps(cli_series *series, const cli_steps *requested, size_t total,
                              cw_error *err)
{
    cli_steps steps = *requested;
    if (steps.all || !steps.given) {
        steps.count = 1;
        steps.rows[0].first = 0;
        steps.rows[0].last = total - 1;
        steps.rows[0].by = 1;
    }
    const size_t last = steps.rows[steps.count - 1].last;
    if (last >= total)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--steps asks for step %zu; there are 0 to %zu",
                        last, total - 1);
    series->moments = calloc(total, sizeof *series->moments);
    if (!series->moments)
        return fail_memory(err);
    for (size_t r = 0; r < steps.count; r++)
        for (size_t n = steps.rows[r].first; n <= steps.rows[r].last; n += steps.rows[r].by)
            series->moments[series->count++].number = n;
    return CW_OK;
}

/* A list of files has a time for each. */
static cw_status take_times(cli_series *series, const char *path, const cli_input *input,
                            cw_error *err)
{
    const cw_read_desc desc = cli_read_desc(path, input);
    cw_pvd_entry *entries;
    size_t count;
    cw_status st = cw_pvd_read(path, &desc, &entries, &count, err);
    for (size_t n = 0; n < series->count && st == CW_OK; n++)
        if (series->moments[n].number < count) /* the file may have changed */
            series->moments[n].time_s = entries[series->moments[n].number].time;
    series->timed = st == CW_OK;
    cw_pvd_free(entries, count);
    return st;
}

static cw_status find_in_files(cli_series *series, const char *path, const cli_input *input,
                               const cli_steps *steps, cw_error *err)
{
    if (input->step)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--step is for the steps of one file; of files --steps %zu takes one",
                        input->step);
    cw_status st = check_files(series, input, err);
    if (st == CW_OK)
        st = choose_steps(series, steps, series->files.count, err);
    for (size_t n = 0; n < series->count; n++)
        series->moments[n].path = series->files.path[series->moments[n].number];
    return st == CW_OK && cw_pvd_is(path) ? take_times(series, path, input, err) : st;
}

static cw_status find_in_file(cli_series *series, const char *path, const cli_input *input,
                              const cli_steps *steps, cw_error *err)
{
    cw_volume shape;
    if (input->step)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--step or --steps, not both");
    cw_status st = cli_read_shape(path, input, &shape, err);
    if (st != CW_OK)
        return st;
    st = choose_steps(series, steps, shape.steps, err);
    const double step_s = shape.step_seconds;
    cw_volume_free(&shape);
    if (st != CW_OK)
        return cwi_fail_in(err, st, path);
    series->timed = step_s > 0;
    for (size_t n = 0; n < series->count; n++) {
        cli_moment *m = &series->moments[n];
        m->path = path;
        m->step = m->number;
        m->time_s = series->timed ? (double)m->step * step_s : 0;
    }
    return CW_OK;
}

static cw_status take_one(cli_series *series, const char *path, size_t step, cw_error *err)
{
    series->moments = calloc(1, sizeof *series->moments);
    if (!series->moments)
        return fail_memory(err);
    series->count = 1;
    *series->moments = (cli_moment){.path = path, .step = step, .number = step};
    return CW_OK;
}

cw_status cli_find_series(cli_series *series, const cli_common *common, const cli_input *input,
                          const cli_steps *steps, cw_error *err)
{
    const char *const *paths = common->inputs;
    cw_read_desc desc = cli_read_desc(common->input_count == 1 ? paths[0] : NULL, input);
    const cw_raw_layout raw = {0}; /* only whether there is one counts here */
    desc.raw = input->raw ? &raw : NULL;
    cw_status st = cw_steps_list(paths, common->input_count, &desc, &series->files.path,
                                 &series->files.count, err);
    if (st != CW_OK)
        return st;
    series->given = steps->given || series->files.count;
    return series->files.count ? find_in_files(series, paths[0], input, steps, err)
           : steps->given      ? find_in_file(series, paths[0], input, steps, err)
                               : take_one(series, paths[0], input->step, err);
}

void cli_free_series(cli_series *series)
{
    cw_steps_free(series->files.path, series->files.count);
    free(series->moments);
    *series = (cli_series){0};
}
