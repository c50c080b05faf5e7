/* Commands, as text that a shell takes. */
#ifndef CLI_REPORT_POINT_COMMAND_H
#define CLI_REPORT_POINT_COMMAND_H

#include "cli/report/study.h"

/* The command that does what a point does; free() it. NULL: no memory. */
char *cli_point_command(const cli_study *study, const cli_point *point);

#endif
