/* The commands hollow and offset, which make a solid of another: what they are asked for, and
 * the work. */
#ifndef CLI_COMMANDS_OFFSET_HOLLOW_H
#define CLI_COMMANDS_OFFSET_HOLLOW_H

#include "cli/commands/mesh_command.h"
#include "cli/framework/json_writer.h"

#include <cubewright/level_set.h>

enum { CLI_MAX_DRAINS = 16 };

/* Holes to the outside. */
typedef struct cli_drains {
    size_t count;
    cli_length wide[CLI_MAX_DRAINS];
    double direction[CLI_MAX_DRAINS][3];
} cli_drains;

/* A lattice inside of a hollow solid. */
typedef struct cli_infill {
    bool given;
    int kind;                  /* cw_infill_kind */
    cli_length cell, walls[2]; /* the second: not given, unless they change */
} cli_infill;

typedef struct cli_solid_args {
    cli_mesh_args mesh;
    cli_length voxel, by, wall; /* by: of offset; wall, drain and infill: of hollow */
    cli_drains drain;
    cli_infill infill; /* what it is graded by is mesh.source */
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

/* --- lattices, in infill_option.c ----------------------------------------------------------- */

extern const cli_kind cli_kind_infill;

/* A lattice with the volume that it is graded by. Zeroed: none. */
typedef struct cli_lattice {
    cw_infill_desc desc;
    cli_volume volume;
} cli_lattice;

/* Resolves the options, and reads the volume. Lengths may be fractions of a diagonal.
 * by     of --infill-by: depth:L or a file; NULL: not given
 * input  how the volume is read */
CW_NODISCARD cw_status cli_open_lattice(const cli_infill *infill, const char *by,
                                        const cli_input *input, double diagonal_mm,
                                        cli_lattice *lattice, cw_error *err);
void cli_free_lattice(cli_lattice *lattice);

/* Returns true if --infill-by names a file; fails for a depth that is none. */
CW_NODISCARD cw_status cli_check_infill_by(const char *by, bool *is_file, cw_error *err);

/* Writes the settings, and the facts. */
void cli_json_lattice(cli_json *j, const cli_lattice *lattice, const char *by);
void cli_json_lattice_facts(cli_json *j, const cw_hollow_facts *facts, bool measured);

/* Describes the walls that were measured, for the line; needs 160 bytes. */
void cli_describe_lattice(const cw_infill_desc *desc, const cw_hollow_facts *facts, char *text,
                          size_t size);

#endif
