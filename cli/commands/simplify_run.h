/* The command simplify: what it is asked for, and the work. */
#ifndef CLI_COMMANDS_SIMPLIFY_RUN_H
#define CLI_COMMANDS_SIMPLIFY_RUN_H

#include "cli/inputs/volume_input.h"
#include "cli/results/mesh_write_options.h"

typedef struct cli_simplify_args {
    cli_common common;
    cli_input input; /* of the source volume; limits, safety and claims are the mesh's, too */
    cli_compress compress;
    cli_written written;
    const char *output, *json, *source, *mesh_reader;
    cli_length error, drop;
    cli_number ratio, iso;
    size_t triangles;
    cli_counts lod;
    cli_weights attributes; /* normal, color, scalar */
    int inside, progress;
    bool allow_intersections, keep_border, merge, measure, orient;
} cli_simplify_args;

/* Fails when they contradict each other, or lack what is needed; looks at no file. */
CW_NODISCARD cw_status cli_check_simplify_args(const cli_simplify_args *args, cw_error *err);

/* Reads, simplifies, measures and writes, as the arguments say. */
CW_NODISCARD cw_status cli_run_simplify(void *args, cw_error *err);

#endif
