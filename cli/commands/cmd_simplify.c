/* The command simplify: its options; simplify_run.c does the work. */
#include "cli/commands/simplify_run.h"
#include "cli/framework/commands.h"

static const cli_simplify_args defaults = {.mesh.measure = true};

static const cli_option options[] = {
    CLI_MESH_OUTPUT(", with --lod {lod}"),
    CLI_HEADED("Target"),
    {"error", 'e', CLI_LENGTH, "L", "Error limit: 0.1mm, or 0.05% of the box's diagonal",
     offsetof(cli_simplify_args, error)},
    {"triangles", 'n', CLI_COUNT, "N", "Triangle count to reach, such as 50k",
     offsetof(cli_simplify_args, triangles)},
    {"ratio", 0, CLI_NUMBER, "R", "Fraction of the triangles to keep, such as 0.25",
     offsetof(cli_simplify_args, ratio)},
    {"lod", 0, CLI_COUNTS, "N[,N...]",
     "Triangle counts of levels of detail, such as 50k,12k,3k: a file each, and a glTF with "
     "all",
     offsetof(cli_simplify_args, lod)},
    CLI_HEADED("What is preserved"),
    {"attributes", 0, CLI_WEIGHTS, "normal/color/scalar",
     "Attributes to keep sharp, with weights: normal:0.5,color:1 (as the shape allows)",
     offsetof(cli_simplify_args, attributes)},
    {"allow-intersections", 0, CLI_FLAG, NULL,
     "Allow new intersections of triangles, which is faster (off)",
     offsetof(cli_simplify_args, allow_intersections)},
    {"keep-border", 0, CLI_FLAG, NULL,
     "Keep the borders of open surfaces as they are, so that tiles still fit (off)",
     offsetof(cli_simplify_args, keep_border)},
    {"drop-components", 0, CLI_LENGTH, "L",
     "Leave out components with a shorter box diagonal at the start, such as 2mm (none)",
     offsetof(cli_simplify_args, drop)},
    CLI_MESH_MERGE,
    CLI_MESH_ORIENT,
    CLI_HEADED("Source volume and error"),
    {"source", 's', CLI_TEXT, "VOLUME",
     "Volume to take normals from (off: carry over the input's)",
     offsetof(cli_mesh_args, source), CLI_VALUES_VOLUME},
    {"iso", 'i', CLI_LEVEL, "V",
     "Isovalue of the source, to measure the distance to its surface, too",
     offsetof(cli_simplify_args, iso)},
    {"inside", 0, CLI_CHOICE, "above/below", "Which values of the source are inside (above)",
     offsetof(cli_simplify_args, inside)},
    CLI_MESH_MEASURE(
        "Measure the error, which takes longer than simplifying (on; --no-measure)"),
    CLI_MESH_WRITING,
    CLI_HEADED("Reading the source"),
    CLI_CLAIM_OPTIONS("source", "the source", CLI_INPUT_ROW(cli_mesh_args, source_claim)),
    CLI_INPUT_OPTIONS(cli_mesh_args),
    {"max-triangles", 0, CLI_COUNT, "N",
     "Stop before reading more triangles than this, such as 100M (no limit)",
     CLI_INPUT_ROW(cli_mesh_args, max_triangles)},
    {"mesh-reader", 0, CLI_TEXT, "NAME",
     "Read the mesh as this format; names as in 'formats' (by content)",
     offsetof(cli_simplify_args, mesh_reader), CLI_VALUES_MESH_READER},
    CLI_PROGRESS_OPTION(cli_mesh_args),
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "error triangles ratio lod"},
    {NULL, CLI_NEEDS, "output"},
    {"lod", CLI_EXCLUDES, "error triangles ratio"},
    {"iso", CLI_NEEDS, "source"},
    {"iso", CLI_EXCLUDES, "no-measure"},
    CLI_COMPRESS_RULES,
};

const cli_command cli_simplify = {
    .name = "simplify",
    .usage = "MESH -o MESH --error L|--triangles N|--ratio R|--lod N,... [options]",
    .about = "Reduce the triangles of a mesh, within a guaranteed error limit",
    .page = cli_page_simplify,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = 1,
    .inputs = CLI_VALUES_MESH,
    .size = sizeof(cli_simplify_args),
    .defaults = &defaults,
    .run = cli_run_simplify,
};
