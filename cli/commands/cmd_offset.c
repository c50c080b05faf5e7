/* The command offset: its options; cli_run_offset() in offset_hollow.c does the work. */
#include "cli/commands/command_rows.h"
#include "cli/commands/offset_hollow.h"

static const cli_option options[] = {
    {"by", 'b', CLI_SHIFT, "L",
     "Distance to move the surface: 1mm, -0.5mm (inward), or 0; 1% is of the box's diagonal",
     offsetof(cli_solid_args, by)},
    {"sharp", 0, CLI_FLAG, NULL,
     "Restore edges and corners that voxels cut off (on; --no-sharp)",
     offsetof(cli_solid_args, sharp)},
    {"refine", 0, CLI_FLAG, NULL,
     "Use smaller voxels where --by 0 would be off by more than half of one (on; "
     "--no-refine)",
     offsetof(cli_solid_args, refine)},
    CLI_MESH_MEASURE(
        "Measure how far the result deviates from its distance (on; --no-measure)"),
    CLI_SOLID_OPTIONS,
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    {NULL, CLI_NEEDS, "by"},
    CLI_COMPRESS_RULES,
};

const cli_command cli_offset = {
    .name = "offset",
    .usage = "MESH -o MESH --by L [options]",
    .about = "Move a closed surface outward or inward, or rebuild it",
    .page = cli_page_offset,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = 1,
    .inputs = CLI_VALUES_MESH,
    .size = sizeof(cli_solid_args),
    .defaults = &cli_solid_defaults,
    .run = cli_run_offset,
};
