/* Checks and writes the .pvd list of the files of a time series. */
#include "cli/extract/pvd_list.h"

#include "cli/framework/console.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <stdlib.h>
#include <string.h>

cw_status cli_check_pvd(const char *path, const cli_outputs *outputs, const char *const *inputs,
                        size_t input_count, const cw_write_desc *desc, cw_error *err)
{
    cw_write_desc here = *desc;
    cw_status st = cli_check_output(path, inputs, input_count, err);
    for (size_t n = 0; n < outputs->count && st == CW_OK; n++) {
        const cw_format *format = cw_mesh_format(outputs->path[n], desc->format);
        if (!format || strcmp(format->name, "vtp") != 0)
            return cwi_fail(err, CW_ERR_ARGUMENT, "--pvd lists .vtp files; %s is not one",
                            outputs->path[n]);
        st = cli_check_apart(path, outputs->path[n], err);
    }
    here.format = "vtp"; /* for the folder, and what is in the way, it is the same */
    return st == CW_OK ? cw_mesh_write_check(path, &here, err) : st;
}

static size_t list_written(const cli_report *report, cw_pvd_entry *entries)
{
    size_t count = 0;
    for (const cli_made *m = report->made; m < report->made + report->made_count; m++)
        if (m->written)
            entries[count++] = (cw_pvd_entry){m->path, m->timed ? m->moment->time_s
                                                                : (double)m->moment->number};
    return count;
}

cw_status cli_write_pvd(cli_report *report, const char *path, const cw_write_desc *desc,
                        cw_error *err)
{
    cw_pvd_entry *entries = calloc(report->made_count + 1, sizeof *entries);
    if (!entries)
        return cwi_fail_memory(err);
    const size_t count = list_written(report, entries);
    cw_status st = count ? cw_pvd_write(path, entries, count, desc, err) : CW_OK;
    if (st == CW_OK && count) {
        cli_made *made = cli_report_next(report, path, 0);
        made->name = "pvd";
        made->written = true;
        cli_result("%s: %zu files, from %.6g to %.6g%s\n", path, count, entries[0].time,
                   entries[count - 1].time, report->made->timed ? " s" : "");
    }
    free(entries);
    return st;
}
