/* Extraction of one part of a surface, for many processes or machines that share the work. */
#ifndef CLI_EXTRACT_PART_RUN_H
#define CLI_EXTRACT_PART_RUN_H

#include "cli/extract/extract_run.h"

/* extract --part K/N --manifest DIR: makes the fragment of a part, unless it is there. */
CW_NODISCARD cw_status cli_extract_part(const cli_extract_args *args, cw_error *err);

/* mpirun -n N ... extract -o FILE: makes the part of this rank, and with the others the file. With
 * --manifest DIR the parts are kept there, and the same command resumes. */
CW_NODISCARD cw_status cli_extract_ranks(const cli_extract_args *args, cw_error *err);

#endif
