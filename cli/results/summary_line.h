/* The line about a mesh that was delivered. */
#ifndef CLI_RESULTS_SUMMARY_LINE_H
#define CLI_RESULTS_SUMMARY_LINE_H

#include "cli/results/write_result.h"

/* Parts of the mesh that is delivered, and their counts. */
typedef struct cli_load {
    const cw_part *parts;
    size_t part_count, vertices, triangles;
} cli_load;

/* Prints "NAME: topology; counts; box; further facts; size; time": the time stands alone.
 * start  when work on it began */
void cli_print_summary(const cli_delivery *how, const cli_made *made, const cli_load *l,
                       size_t border_loops, double start);

#endif
