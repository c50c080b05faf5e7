/* Commands, as text that a shell takes. */
#ifndef CLI_STUDY_POINT_COMMAND_H
#define CLI_STUDY_POINT_COMMAND_H

#include "cli/study/study.h"

/* The command that does what a point does; free() it. NULL: no memory. */
char *cli_point_command(const cli_study *study, const cli_point *point);

/* The same of settings by themselves, for another output. NULL without memory; free(). */
char *cli_settings_command(const cli_study *study, const cli_tried *tried, const char *output);

#endif
