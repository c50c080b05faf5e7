/* The commands hollow and offset, which make a solid of another: what they are asked for, and
 * the work. */
#ifndef CLI_COMMANDS_OFFSET_HOLLOW_H
#define CLI_COMMANDS_OFFSET_HOLLOW_H

#include "cli/commands/mesh_command.h"

typedef struct cli_solid_args {
    cli_mesh_args mesh;
    const char *voxel;
    const char *drain, *by; /* of hollow, and of offset */
    cli_length wall;        /* of hollow */
    bool sharp, refine;
} cli_solid_args;

/* Rows that both commands have. */
#define CLI_SOLID_OPTIONS                                                                      \
    {"voxel",                                                                                  \
     0,                                                                                        \
     CLI_TEXT,                                                                                 \
     "L",                                                                                      \
     "Voxel size of the level set: auto, 0.2mm or 0.1% of the box's diagonal (auto)",          \
     offsetof(cli_solid_args, voxel)},                                                         \
        CLI_MESH_OUTPUT(""), CLI_MESH_COMMON

extern const cli_solid_args cli_solid_defaults;

CW_NODISCARD cw_status cli_run_hollow(void *args, cw_error *err);
CW_NODISCARD cw_status cli_run_offset(void *args, cw_error *err);

#endif
