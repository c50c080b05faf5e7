/* Arguments and facts of the command cut, and its report. */
#ifndef CLI_CUT_CUT_FACTS_H
#define CLI_CUT_CUT_FACTS_H

#include "cli/commands/mesh_command.h"
#include "cli/cut/cut_planes.h"
#include "cli/framework/commands.h"

#include <cubewright/pieces.h>

typedef struct cli_cut_args {
    cli_mesh_args mesh;
    cli_planes planes;
    cli_lengths plate;
    size_t pegs;
    int peg_kind; /* 1: dowels */
    cli_length diameter, length, clearance, wall;
    const char *preview;
    bool lay, measure;
} cli_cut_args;

typedef struct cli_cut_state {
    cw_cut_desc *planes;
    size_t plane_count, plates;
    cw_pieces cut; /* without meshes, once the runner has them */
    cw_assembled assembled;
} cli_cut_state;

extern const cli_command cli_cut;

/* Finds the planes of a run whose mesh is read, and cuts it; tells the planes that a plate needs. */
CW_NODISCARD cw_status cli_cut_solid(cli_mesh_run *r, cw_error *err);
void cli_free_cut(cli_cut_state *state);

/* Steps of the command. */
CW_NODISCARD cw_status cli_report_cut(cli_mesh_run *r, cw_error *err);
void cli_put_cut_params(cli_json *j, const cli_mesh_run *r, const cli_made *made);
void cli_put_cut_facts(cli_json *j, const cli_mesh_run *r);

#endif
