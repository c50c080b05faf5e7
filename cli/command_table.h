/* Declares the table of all commands. */
#ifndef CLI_COMMAND_TABLE_H
#define CLI_COMMAND_TABLE_H

#include "cli/framework/options.h"

/* In the order of help; the last is NULL. */
extern const cli_command *const cli_command_table[];

#endif
