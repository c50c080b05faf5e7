/* A folder of our own, for files that are looked at and thrown away. */
#ifndef CLI_FRAMEWORK_TEMP_FOLDER_H
#define CLI_FRAMEWORK_TEMP_FOLDER_H

#include <cubewright/core.h>

/* Makes one in TMPDIR, or else in /tmp; CW_ERR_OUTPUT, CW_ERR_NO_MEMORY. Give its path to
 * cli_scratch_remove(), which removes it with the files in it, and is harmless on NULL. */
CW_NODISCARD cw_status cli_scratch_make(char **folder, cw_error *err);
void cli_scratch_remove(char *folder);

#endif
