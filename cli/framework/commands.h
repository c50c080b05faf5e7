/* Commands by name, and the pages of their help. */
#ifndef CLI_FRAMEWORK_COMMANDS_H
#define CLI_FRAMEWORK_COMMANDS_H

#include "cli/framework/options.h"

/* The long help of each command: help/NAME.txt, as core/embed.cmake puts it into
 * the program. */
extern const char cli_page_boolean[], cli_page_check[], cli_page_convert[], cli_page_cut[],
    cli_page_engrave[], cli_page_extract[], cli_page_formats[], cli_page_help[],
    cli_page_hollow[], cli_page_info[], cli_page_join[], cli_page_make[], cli_page_offset[],
    cli_page_remesh[], cli_page_render[], cli_page_repair[], cli_page_report[],
    cli_page_simplify[], cli_page_smooth[], cli_page_uv[], cli_page_version[], cli_page_view[],
    cli_page_voxelize[];

/* Pages of topics. */
extern const char cli_page_environment[], cli_page_library[];

/* All commands in the order of help; the last is NULL. The program sets it when it starts. */
extern const cli_command *const *cli_commands;

/* A page of 'help' that is not about a command. */
typedef struct cli_topic {
    const char *name, *about;
    const char *page; /* NULL: the exit codes */
} cli_topic;

/* The last row has no name. */
extern const cli_topic cli_topics[];

/* The row of a name; NULL, and an error with the nearest name, when there is none. */
const cli_command *cli_find_command(const char *name, cw_error *err);

#endif
