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
    .more =
        "Reads a closed mesh, makes the surface of all points that are so far from it, "
        "measures\n"
        "that distance and writes the surface: closed, a manifold, free of crossings.\n\n"
        "Outward, convex edges and corners come out round; inward, concave ones. What is "
        "thinner\n"
        "than twice the distance is gone. --by 0 makes the surface itself anew: parts that "
        "cross\n"
        "become one.\n\n"
        "Distances are those of a grid's samples, exact; between them the surface is within "
        "half\n"
        "a voxel of where it should be. Edges and corners, which samples cut off by about a "
        "voxel,\n"
        "are put back: most right angles exactly, sharper ones not everywhere (--no-sharp "
        "leaves\n"
        "them cut).\n\n"
        "With --by 0 all of the surface is within half a voxel of the input, and the input of "
        "it,\n"
        "sharp edges, tips and thin walls too. Where that takes voxels of half the size, or a "
        "quarter,\n"
        "it is told, and costs some eight or thirty times the time. What is thin all over, "
        "such "
        "as\n"
        "bone, takes parts of voxels, down to an eighth, where it is thin: pieces and handles "
        "that it\n"
        "has more then are told. --no-refine takes neither. If half a voxel cannot be kept, "
        "the "
        "mesh\n"
        "is written all the same, and the exit code is 1.\n\n"
        "--voxel auto is 1/256 of the box's diagonal, or a quarter of the distance if that is\n"
        "finer, but not below 1/512, and coarser where memory would not do.\n\n"
        "Printed is how far the result's distance from the input is off, at most and by the "
        "root\n"
        "of the mean square; with --by 0 the distance both ways. All parts are taken as one "
        "mesh;\n"
        "colours, scalars and labels are not kept.\n\n"
        "Examples\n"
        "  cubewright offset bone.stl --by 1mm -o larger.stl\n"
        "  cubewright offset bone.stl --by -0.5mm --voxel 0.2mm -o smaller.stl\n"
        "  cubewright offset overlapping.obj --by 0 -o one.stl\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .min_inputs = 1,
    .max_inputs = 1,
    .size = sizeof(cli_solid_args),
    .defaults = &cli_solid_defaults,
    .run = cli_run_offset,
};
