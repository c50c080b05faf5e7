/* Joining the parts of a surface to one file. */
#ifndef CLI_EXTRACT_PART_JOIN_H
#define CLI_EXTRACT_PART_JOIN_H

#include "cli/extract/part_manifest.h"

#include <cubewright/spool.h>

/* The command (cmd_join.c). */
extern const cli_command cli_join;

/* Appends the fragments of parts `first` to `end` - 1 of a folder to a spool. *sides: whether they
 * have samples on each side
 * Returns CW_ERR_IO for a part that is missing; CW_ERR_FORMAT for a damaged one or one of another
 * job */
CW_NODISCARD cw_status cli_append_parts(const char *folder, const cli_manifest *manifest,
                                        size_t first, size_t end, cw_mesh_spool *spool,
                                        cw_part_counts *sides, cw_error *err);

/* A file to write of joined parts. */
typedef struct cli_joined {
    const char *output, *from; /* from: "8 parts", for the line */
    const cw_write_desc *desc; /* without provenance, which is the manifest's */
    const cli_manifest *manifest;
    const cli_input *input; /* its threads and memory are for the check */
    bool check;             /* measure the surface, and hold it to the promise */
    double start;           /* time that the line counts from, by cli_seconds() */
} cli_joined;

/* Checks a surface, writes its file and prints its line. A spool that a team shares is checked by
 * rank 0, and written by all.
 * Returns CW_ERR_EMPTY when the parts have no surface; CW_ERR_CHECK; as cw_parts_write() */
CW_NODISCARD cw_status cli_write_joined(const cli_joined *joined, const cw_mesh_spool *spool,
                                        const cw_part_counts *sides, const cw_team *team,
                                        cw_error *err);

/* Writes the file of all parts of a folder. */
CW_NODISCARD cw_status cli_join_parts(const char *folder, const cli_joined *joined,
                                      cw_error *err);

#endif
