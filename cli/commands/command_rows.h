/* The commands that have no room of their own: a row of each cmd_NAME.c. */
#ifndef CLI_COMMANDS_COMMAND_ROWS_H
#define CLI_COMMANDS_COMMAND_ROWS_H

#include "cli/framework/commands.h"

extern const cli_command cli_boolean, cli_convert, cli_engrave, cli_formats, cli_hollow,
    cli_make, cli_offset, cli_remesh, cli_repair, cli_simplify, cli_smooth, cli_uv, cli_version;

#endif
