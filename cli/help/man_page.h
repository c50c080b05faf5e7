/* Manual pages in roff (help --man), made from the tables and pages of the help. */
#ifndef CLI_HELP_MAN_PAGE_H
#define CLI_HELP_MAN_PAGE_H

#include "cli/framework/options.h"

/* Prints a manual page to the standard output: of a command; of the program, which is named
 * "cubewright"; or of the library, "library". "cubewright-extract" is the command extract.
 * Returns CW_ERR_ARGUMENT if there is no such page; CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cli_print_manual(const char *name, cw_error *err);

#endif
