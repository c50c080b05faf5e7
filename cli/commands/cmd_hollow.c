/* The command hollow: its options; cli_run_hollow() in offset_hollow.c does the work. */
#include "cli/commands/command_rows.h"
#include "cli/commands/offset_hollow.h"

static const cli_option options[] = {
    {"wall", 'w', CLI_MESH_LENGTH, "L",
     "Thickness of the wall: 2mm, or 1% of the box's diagonal", offsetof(cli_solid_args, wall)},
    {"drain", 0, &cli_kind_drains, "D@AXIS[,...]",
     "Diameter and direction of drain holes out of the largest cavity: 4mm@-z, or "
     "4mm@-z,3mm@+x (none)",
     offsetof(cli_solid_args, drain)},
    {"infill", 0, &cli_kind_infill, "KIND:CELL:WALL[:WALL]",
     "Lattice in the cavities: gyroid, schwarz-p or diamond, its cells and walls, as "
     "gyroid:8mm:0.8mm (none)",
     offsetof(cli_solid_args, infill)},
    {"infill-by", 0, CLI_TEXT, "depth:L|VOLUME",
     "Change the lattice from the first wall to the second: at this depth below the outer wall, "
     "or from the least to the greatest value of a volume (none)",
     offsetof(cli_solid_args, mesh.source), CLI_VALUES_VOLUME},
    CLI_MESH_MEASURE("Measure the thickness of the wall (on; --no-measure)"),
    CLI_SOLID_OPTIONS,
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    {NULL, CLI_NEEDS, "wall"},
    {"infill-by", CLI_NEEDS, "infill"},
    CLI_COMPRESS_RULES,
};

const cli_command cli_hollow = {
    .name = "hollow",
    .usage = "MESH -o MESH --wall L [--infill KIND:CELL:WALL] [--drain D@AXIS,...] [options]",
    .about = "Turn a solid into a shell, to save print material",
    .page = cli_page_hollow,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = 1,
    .inputs = CLI_VALUES_MESH,
    .size = sizeof(cli_solid_args),
    .defaults = &cli_solid_defaults,
    .run = cli_run_hollow,
};
