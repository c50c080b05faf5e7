#include "cli/commands.h"
#include "cli/solid.h"

static const cli_option options[] = {
    {"wall", 'w', CLI_LENGTH, "L", "how thick what stays is: 2mm, or 1% of the box's diagonal",
     offsetof(cli_solid_args, wall)},
    {"drain", 0, CLI_TEXT, "D@AXIS[,...]",
     "holes so wide out of the largest cavity: 4mm@-z, or 4mm@-z,3mm@+x (none)",
     offsetof(cli_solid_args, drain)},
    {"measure", 0, CLI_FLAG, NULL, "measure how thick the wall is (on; --no-measure)",
     offsetof(cli_solid_args, measure)},
    CLI_SOLID_OPTIONS,
};

const cli_command cli_hollow = {
    .name = "hollow",
    .usage = "MESH -o MESH --wall L [--drain D@AXIS,...] [options]",
    .about = "a solid with a wall of some thickness and nothing inside, for print",
    .more =
        "Reads a closed mesh, takes out all that is farther inside than the wall is thick,\n"
        "measures the wall and writes it.\n\n"
        "Without --drain the mesh stays as it is, triangle for triangle; the surfaces of the\n"
        "cavities are added, facing inward. Then resin or powder cannot leave them: each\n"
        "cavity that stays sealed is counted.\n\n"
        "--drain makes round holes. Each starts at the largest cavity's farthest point in a\n"
        "direction (+x: the patient's left, +y: back, +z: head), on a flat floor in its "
        "middle,\n"
        "and goes straight out, through whatever is in its way. The whole solid is then made\n"
        "anew, from distances on a grid: edges and corners lose about a voxel.\n\n"
        "--voxel auto is a quarter of the wall, or of the narrowest drain, and coarser, up to\n"
        "half, where memory would not do.\n\n"
        "Printed are the smallest and largest distance from the cavities' surfaces to the "
        "outer\n"
        "one, and the volume that was taken out. All parts are taken as one mesh; colours,\n"
        "scalars and labels are not kept.\n\n"
        "Examples\n"
        "  cubewright hollow bone.stl --wall 2mm -o shell.stl\n"
        "  cubewright hollow bone.stl --wall 2mm --drain 4mm@-z -o shell.3mf\n"
        "  cubewright hollow skull.glb --wall 1.5mm --drain 4mm@-z,4mm@+z -o skull.stl\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .min_inputs = 1,
    .max_inputs = 1,
    .size = sizeof(cli_solid_args),
    .defaults = &cli_solid_defaults,
    .run = cli_run_hollow,
};
