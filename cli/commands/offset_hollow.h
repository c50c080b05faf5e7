/* The commands hollow and offset, which make a solid of another: what they are asked for, and
 * the work. */
#ifndef CLI_COMMANDS_OFFSET_HOLLOW_H
#define CLI_COMMANDS_OFFSET_HOLLOW_H

#include "cli/commands/mesh_command.h"

enum { CLI_MAX_DRAINS = 16 };

/* Holes to the outside. */
typedef struct cli_drains {
    size_t count;
    cli_length wide[CLI_MAX_DRAINS];
    double direction[CLI_MAX_DRAINS][3];
} cli_drains;

typedef struct cli_solid_args {
    cli_mesh_args mesh;
    cli_length voxel, by, wall; /* by: of offset; wall and drain: of hollow */
    cli_drains drain;
    bool sharp, refine;
} cli_solid_args;

/* Rows that both commands have. */
#define CLI_SOLID_OPTIONS                                                                      \
    {"voxel",                                                                                  \
     0,                                                                                        \
     CLI_MESH_LENGTH,                                                                          \
     "auto/L",                                                                                 \
     "Voxel size of the level set: 0.2mm or 0.1% of the box's diagonal (auto)",                \
     offsetof(cli_solid_args, voxel)},                                                         \
        CLI_MESH_OUTPUT(""), CLI_MESH_COMMON

extern const cli_kind cli_kind_drains;
extern const cli_solid_args cli_solid_defaults;

CW_NODISCARD cw_status cli_run_hollow(void *args, cw_error *err);
CW_NODISCARD cw_status cli_run_offset(void *args, cw_error *err);

#endif
