/* Finds and prints the levels of an image in several sizes. */
#include "cli/info/info_scales.h"

#include <stdio.h>

cw_status cli_find_scales(const char *path, const cw_read_desc *desc, cli_scales *scales,
                          cw_error *err)
{
    *scales = (cli_scales){.chosen = desc->level};
    return cw_levels_list(path, desc, &scales->levels, &scales->count, err);
}

void cli_print_scales(const cli_scales *scales)
{
    for (size_t n = 0; n < scales->count; n++) {
        const cw_level *level = &scales->levels[n];
        const cw_volume *v = &level->shape;
        double spacing[3];
        cw_volume_spacing(v, spacing);
        printf("  scale %-3zu'%s', %zu x %zu x %zu %s, %.6g x %.6g x %.6g %s, axes %s%s\n", n,
               level->name, v->dim[0], v->dim[1], v->dim[2], cw_type_name(v->type), spacing[0],
               spacing[1], spacing[2], v->known & CW_KNOWN_UNIT ? "mm" : "(no unit)",
               level->axes,
               n != scales->chosen ? ""
               : n > 0             ? ", read"
                                   : ", read unless --level names another");
    }
}

void cli_json_scales(cli_json *j, const cli_scales *scales)
{
    if (!scales->count)
        return;
    cli_json_open(j, "scales", '[');
    for (size_t n = 0; n < scales->count; n++) {
        const cw_level *level = &scales->levels[n];
        const cw_volume *v = &level->shape;
        double spacing[3];
        cw_volume_spacing(v, spacing);
        cli_json_open(j, NULL, '{');
        cli_json_text(j, "path", level->name);
        cli_json_numbers(
            j, "dims", (double[3]){(double)v->dim[0], (double)v->dim[1], (double)v->dim[2]}, 3);
        cli_json_text(j, "type", cw_type_name(v->type));
        cli_json_numbers(j, "spacing", spacing, 3);
        cli_json_text(j, "unit", v->known & CW_KNOWN_UNIT ? "mm" : "unknown");
        cli_json_text(j, "axes", level->axes);
        cli_json_bool(j, "read", n == scales->chosen);
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}
