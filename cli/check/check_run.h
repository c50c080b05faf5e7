/* The command check between its files: options, and a run with its measurements. */
#ifndef CLI_CHECK_CHECK_RUN_H
#define CLI_CHECK_CHECK_RUN_H

#include "cli/framework/quantity.h"
#include "cli/inputs/mesh_input.h"
#include "cli/looks/looks_facts.h"
#include "cli/looks/looks_input.h"
#include "cli/results/printability.h"
#include "cli/results/run_report.h"

/* The command (cmd_check.c). */
extern const cli_command cli_check;

typedef struct cli_check_args {
    cli_common common;
    cli_input input; /* of the source volume */
    const char *source, *reference, *defects, *json, *mesh_reader;
    cli_number iso;
    cli_length tolerance;
    cli_amount min_volume;
    size_t largest;
    bool fill_voids;
    cli_printer printer;
    int profile, inside, progress;
    bool deep, open, histogram;
    const char *looks;
} cli_check_args;

/* State of the command: inputs and measurements; findings point into it. */
typedef struct cli_check_run {
    const cli_check_args *args;
    cli_number iso; /* of args, as a number */
    cli_mesh mesh, reference;
    cli_volume volume;
    uint8_t *defects; /* of each triangle; NULL unless they are painted */
    float *distances; /* largest around each vertex, or how much walls and gaps lack of their
                         limits; NULL: nothing to measure from */
    cw_quality quality, field;
    cw_crossings crossings;
    cw_cgal_facts cgal;
    cw_print_facts print;
    cw_orient_facts orient;
    cw_distance to_field, from_field, to_reference, from_reference;
    cw_appearance looks, bare_looks; /* with the maps on the mesh, and without */
    bool has_maps;                   /* on the mesh */
    cli_looks_limit looks_limit;
    cw_findings findings;
    cw_verdict verdicts[CW_MAX_VERDICTS];
    size_t verdict_count;
    struct cli_part_checks *solids; /* of a file of several; else NULL */
    cli_report report;
    double start;
} cli_check_run;

/* Returns the volume below which components of the source's surface are left out. */
double cli_check_least_mm3(const cli_check_run *run);

/* Returns the tolerance for distances in millimetres; 0: none. */
double cli_check_tolerance_mm(const cli_check_run *run);

/* Returns true if walls and gaps are painted: distances from something have precedence. */
bool cli_check_paints_walls(const cli_check_args *args);

/* Measures all that the options ask for; findings point into the run. */
CW_NODISCARD cw_status cli_check_measure(cli_check_run *run, cw_error *err);

#endif
