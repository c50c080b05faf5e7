/* The row of the command info. */
#ifndef CLI_INFO_CMD_INFO_H
#define CLI_INFO_CMD_INFO_H

#include "cli/framework/commands.h"

extern const cli_command cli_info;

#endif
