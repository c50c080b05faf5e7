/* The table of all commands, in the order of the help. */
#include "cli/framework/commands.h"
#include "core/base/status.h"

#include <string.h>

const cli_command *const cli_commands[] = {
    &cli_extract, &cli_join,    &cli_simplify,       &cli_smooth, &cli_remesh,
    &cli_repair,  &cli_convert, &cli_hollow,         &cli_offset, &cli_check,
    &cli_info,    &cli_render,  &cli_report_command, &cli_view,   &cli_make,
    &cli_formats, &cli_help,    &cli_version,        NULL};

const cli_command *cli_find_command(const char *name, cw_error *err)
{
    const char *names[32] = {0};
    for (size_t n = 0; cli_commands[n]; n++) {
        if (strcmp(name, cli_commands[n]->name) == 0)
            return cli_commands[n];
        names[n] = cli_commands[n]->name;
    }
    const char *nearest = cli_nearest(name, names);
    if (nearest)
        cwi_fail(err, CW_ERR_ARGUMENT, "'%s' is not a command; did you mean '%s'?", name,
                 nearest);
    else
        cwi_fail(err, CW_ERR_ARGUMENT, "'%s' is not a command; 'cubewright help' lists them",
                 name);
    return NULL;
}
