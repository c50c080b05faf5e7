#include "cli/commands.h"
#include "cli/solid.h"

static const cli_option options[] = {
    {"by", 'b', CLI_TEXT, "L",
     "how far: 1mm, -0.5mm (inward), or 0; 1% is of the box's diagonal",
     offsetof(cli_solid_args, by)},
    {"sharp", 0, CLI_FLAG, NULL,
     "put back edges and corners that voxels cut off (on; --no-sharp)",
     offsetof(cli_solid_args, sharp)},
    {"refine", 0, CLI_FLAG, NULL,
     "with --by 0: smaller voxels, or parts, if half of one is not kept (on; --no-refine)",
     offsetof(cli_solid_args, refine)},
    {"measure", 0, CLI_FLAG, NULL,
     "measure how far the result is from where it should be (on; --no-measure)",
     offsetof(cli_solid_args, measure)},
    CLI_SOLID_OPTIONS,
};

const cli_command cli_offset = {
    .name = "offset",
    .usage = "MESH -o MESH --by L [options]",
    .about = "the surface at a distance from a closed mesh, outward or inward",
    .page = cli_page_offset,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .min_inputs = 1,
    .max_inputs = 1,
    .size = sizeof(cli_solid_args),
    .defaults = &cli_solid_defaults,
    .run = cli_run_offset,
};
