/* The commands hollow and offset, which make a solid of another: what they are asked for, and
 * the work. */
#ifndef CLI_COMMANDS_OFFSET_HOLLOW_H
#define CLI_COMMANDS_OFFSET_HOLLOW_H

#include "cli/results/mesh_write_options.h"

typedef struct cli_solid_args {
    cli_common common;
    cli_input input;
    cli_compress compress;
    cli_written written;
    const char *output, *json, *voxel;
    const char *drain, *by; /* of hollow, and of offset */
    cli_length wall;        /* of hollow */
    int progress;
    bool measure, sharp, refine;
} cli_solid_args;

/* Rows that both commands have. */
#define CLI_SOLID_OPTIONS                                                                      \
    {"voxel",                                                                                  \
     0,                                                                                        \
     CLI_TEXT,                                                                                 \
     "L",                                                                                      \
     "Voxel size of the level set: auto, 0.2mm or 0.1% of the box's diagonal (auto)",          \
     offsetof(cli_solid_args, voxel)},                                                         \
        {"output",                                                                             \
         'o',                                                                                  \
         CLI_TEXT,                                                                             \
         "FILE",                                                                               \
         "Mesh to write, in the format of its extension; may hold {stem}",                     \
         offsetof(cli_solid_args, output),                                                     \
         CLI_VALUES_MESH_OUTPUT},                                                              \
        CLI_JSON_OPTION(cli_solid_args), CLI_WRITTEN_OPTIONS(cli_solid_args),                  \
        CLI_COMPRESS_OPTIONS(cli_solid_args), CLI_MESH_INPUT_OPTIONS(cli_solid_args),          \
        CLI_PROGRESS_OPTION(cli_solid_args)

extern const cli_solid_args cli_solid_defaults;

CW_NODISCARD cw_status cli_run_hollow(void *args, cw_error *err);
CW_NODISCARD cw_status cli_run_offset(void *args, cw_error *err);

#endif
