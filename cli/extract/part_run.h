/* Extraction of one part of a surface, for many processes or machines that share the work. */
#ifndef CLI_EXTRACT_PART_RUN_H
#define CLI_EXTRACT_PART_RUN_H

#include "cli/extract/extract_run.h"

/* extract --part K/N --manifest DIR: makes the fragment of a part, unless it is there.
 * extract --queue DIR: makes all parts, together with other processes, and then the file of -o. */
CW_NODISCARD cw_status cli_extract_part(const cli_extract_args *args, cw_error *err);

#endif
