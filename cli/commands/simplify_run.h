/* The command simplify: what it is asked for, and the work. */
#ifndef CLI_COMMANDS_SIMPLIFY_RUN_H
#define CLI_COMMANDS_SIMPLIFY_RUN_H

#include "cli/commands/mesh_command.h"

/* The input's settings are of the source volume; limits, safety and claims are the mesh's, too. */
typedef struct cli_simplify_args {
    cli_mesh_args mesh;
    const char *mesh_reader;
    cli_length error, drop;
    cli_number ratio, iso;
    size_t triangles;
    cli_counts lod;
    cli_weights attributes; /* normal, color, scalar */
    int inside;
    bool allow_intersections, keep_border;
} cli_simplify_args;

/* Reads, simplifies, measures and writes, as the arguments say. */
CW_NODISCARD cw_status cli_run_simplify(void *args, cw_error *err);

#endif
