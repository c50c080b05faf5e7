/* The manifest of an extraction in parts: a folder's record of the job, which all parts share. */
#ifndef CLI_EXTRACT_PART_MANIFEST_H
#define CLI_EXTRACT_PART_MANIFEST_H

#include "cli/extract/extract_run.h"

/* A job as the manifest states it. A zeroed one is empty; free it with cli_free_manifest(). */
typedef struct cli_manifest {
    char *text;   /* JSON */
    uint64_t job; /* number of the job: a hash of the text */
    size_t parts;
    double iso;
    bool open;        /* at the border of the volume */
    double least_mm3; /* components that enclose less are left out of the file; 0: none is */
    char *lines[CLI_EXTRACT_PROVENANCE][2]; /* provenance for the file: key and value */
    size_t line_count;
} cli_manifest;

/* Describes a run's job: input, options that change the surface, number of parts. */
CW_NODISCARD cw_status cli_describe_job(const cli_extract_run *run, size_t parts,
                                        cli_manifest *manifest, cw_error *err);

/* Writes the manifest into a folder, which is made if need be. If there is one already, it must be
 * of the same job. Returns CW_ERR_ARGUMENT for that of another job, CW_ERR_OUTPUT, CW_ERR_IO */
CW_NODISCARD cw_status cli_settle_manifest(const char *folder, const cli_manifest *manifest,
                                           cw_error *err);

/* Reads the manifest of a folder. Returns CW_ERR_IO, CW_ERR_FORMAT */
CW_NODISCARD cw_status cli_read_manifest(const char *folder, cli_manifest *manifest,
                                         cw_error *err);
void cli_free_manifest(cli_manifest *manifest);

/* Fails when the output is the manifest or a part of a folder, by any name. */
CW_NODISCARD cw_status cli_check_joined_output(const char *output, const char *folder,
                                               size_t parts, cw_error *err);

/* Prints a number of parts: "8 parts". Returns the text. */
enum { CLI_PARTS_TEXT = 32 };
const char *cli_count_parts(size_t parts, char text[CLI_PARTS_TEXT]);

/* Prints the path of a part's fragment, counted from 0: FOLDER/part-2-of-8.cwpart. */
enum { CLI_FRAGMENT_PATH = 4096 };
CW_NODISCARD cw_status cli_name_fragment(const char *folder, size_t part, size_t parts,
                                         char path[CLI_FRAGMENT_PATH], cw_error *err);

#endif
