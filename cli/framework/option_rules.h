/* Rules between the options of a command: parsing, help, completion and search read one table. */
#ifndef CLI_FRAMEWORK_OPTION_RULES_H
#define CLI_FRAMEWORK_OPTION_RULES_H

#include "cli/framework/options.h"

/* Checks all rules of a command on its struct. An option counts where its field is not the default.
 * Returns  CW_ERR_ARGUMENT  "--max-move needs --smooth METHOD", "--cull cannot be combined with --snap" */
CW_NODISCARD cw_status cli_check_rules(const cli_command *command, const void *args,
                                       cw_error *err);

/* Returns the first of some options, as in a rule, that is not at its default: "--cull", "--component
 * mag"; in static memory. NULL: all are. */
const char *cli_find_given(const cli_command *command, const void *args, const char *names);

/* Returns the text of an option for help, with its rules behind it; in static memory. */
const char *cli_option_about(const cli_command *command, const cli_option *option);

#endif
