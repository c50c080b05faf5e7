/* Finds commands by name, and lists the topics of help. */
#include "cli/framework/commands.h"
#include "core/base/status.h"

#include <string.h>

const cli_command *const *cli_commands;

const cli_topic cli_topics[] = {
    {"environment", "variables of the environment, and files", cli_page_environment},
    {"exit", "the exit codes", NULL},
    {"library", "the library for C and C++", cli_page_library},
    {NULL, NULL, NULL},
};

const cli_command *cli_find_command(const char *name, cw_error *err)
{
    const char *names[32] = {0};
    for (size_t n = 0; cli_commands[n]; n++) {
        if (strcmp(name, cli_commands[n]->name) == 0)
            return cli_commands[n];
        names[n] = cli_commands[n]->name;
    }
    char hint[CLI_HINT_BYTES];
    cli_hint(NULL, name, names, hint);
    cwi_fail(err, CW_ERR_ARGUMENT, "'%s' is not a command; %s", name, hint);
    return NULL;
}
