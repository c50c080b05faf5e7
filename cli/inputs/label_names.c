/* Finds the names and colours of a volume's labels. */
#define _GNU_SOURCE /* strdup */
#include "cli/inputs/label_names.h"

#include "cli/framework/console.h"
#include "cli/framework/field_names.h"
#include "cli/framework/standard_streams.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/label_table.h"

#include <cubewright/formats.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void cli_free_label_names(cli_label_names *names)
{
    cw_label_table_free(&names->table);
    free(names->path);
    *names = (cli_label_names){0};
}

static cw_status read_stated(const char *path, cli_label_names *names, cw_error *err)
{
    cw_status st = cw_label_table_read(path, &names->table, &names->format, err);
    names->path = st == CW_OK ? strdup(path) : NULL;
    if (st == CW_OK && !names->path)
        st = cwi_fail_memory(err);
    return st;
}

static cw_status read_beside(const cli_volume *volume, cli_label_names *names, cw_error *err)
{
    cw_error why;
    if (cli_is_standard(volume->path)) /* nothing is beside it */
        return CW_OK;
    cw_status st = cw_label_table_beside(volume->path, &names->path, err);
    if (st != CW_OK || !names->path)
        return st;
    st = cw_label_table_read(names->path, &names->table, &names->format, &why);
    if (st == CW_OK)
        return st;
    cli_say("%s: the names beside it are not used: %s", volume->path,
            cli_name_options(why.message, (char[CLI_MESSAGE]){0}));
    cli_free_label_names(names);
    return CW_OK;
}

cw_status cli_find_label_names(const char *path, cli_volume *volume, cli_label_names *names,
                               cw_error *err)
{
    cw_status st = CW_OK;
    *names = (cli_label_names){0};
    if (path) {
        st = read_stated(path, names, err);
    } else if (volume->labels.count) {
        names->table = volume->labels;
        volume->labels = (cw_label_table){0};
    } else {
        st = read_beside(volume, names, err);
    }
    const size_t count = names->table.count;
    if (st == CW_OK)
        st = cw_label_table_renumber(&names->table, &volume->ids, err);
    if (st == CW_OK && volume->ids.rounded)
        cli_say("%s: %zu voxels are rounded to whole numbers, by up to %.3g", volume->path,
                volume->ids.rounded, volume->ids.largest_rounding);
    if (st != CW_OK)
        cli_free_label_names(names);
    else if (names->path)
        cli_say("%s: names of %zu labels from %s (%s)", volume->path, count, names->path,
                names->format);
    else if (count)
        cli_say("%s: names of %zu labels from the volume itself", volume->path, count);
    return st;
}

cw_label cli_complete_label(const cw_label_table *table, uint32_t layer, uint32_t value,
                            char name[CLI_LABEL_NAME])
{
    const cw_label *known = cw_label_find(table, layer, value);
    cw_label label = known ? *known : (cw_label){.value = value, .layer = layer};
    if (label.name && *label.name)
        snprintf(name, CLI_LABEL_NAME, "%s", label.name);
    else
        snprintf(name, CLI_LABEL_NAME, "label_%s",
                 cw_label_number(&label, (char[CW_LABEL_NUMBER]){0}));
    label.name = name;
    cwi_label_color(&label, label.color);
    label.has_color = true;
    return label;
}
