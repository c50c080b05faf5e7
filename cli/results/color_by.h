/* Colours of a surface by another volume, or another array of the same file. */
#ifndef CLI_RESULTS_COLOR_BY_H
#define CLI_RESULTS_COLOR_BY_H

#include "cli/framework/json_writer.h"
#include "cli/inputs/volume_input.h"

#include <cubewright/pipeline.h>

typedef struct cli_color_args {
    const char *by, *range;
    int map; /* cw_colormap */
} cli_color_args;

/* Rows of a command whose struct has a cli_color_args as `color`. */
#define CLI_COLOR_OPTIONS(type)                                                                \
    CLI_HEADED("Colours"),                                                                     \
        {"color-by",                                                                           \
         0,                                                                                    \
         CLI_TEXT,                                                                             \
         "VOLUME|ARRAY",                                                                       \
         "Colour the surface by another volume, or by an array of the input; NAME:mag and "    \
         "NAME:2 are magnitudes and components (none)",                                        \
         offsetof(type, color.by),                                                             \
         CLI_VALUES_VOLUME},                                                                   \
        {"colormap",                                                                           \
         0,                                                                                    \
         CLI_CHOICE,                                                                           \
         "viridis/inferno/cool-warm/gray",                                                     \
         "Colours of --color-by, from low to high values (viridis)",                           \
         offsetof(type, color.map)},                                                           \
    {                                                                                          \
        "range", 0, CLI_TEXT, "LOW:HIGH",                                                      \
            "Values of the ends of the map (those of the first surface)",                      \
            offsetof(type, color.range)                                                        \
    }

/* The volume of colours, as far as it was read. Zeroed, it was not. */
typedef struct cli_coloring {
    const cli_color_args *args;
    cli_volume volume;
    size_t step; /* of the volume that was read */
    bool is_read, has_range;
    double low, high;
} cli_coloring;

/* Fails for a range that is none, and for a map or range without a volume. */
CW_NODISCARD cw_status cli_check_color(const cli_color_args *args, cw_error *err);

/* Sets *volume to the volume of colours. Reads it before, for the first mesh and for each step that
 * has one of its own.
 * path   of the input whose array it may be; input  how that is read */
CW_NODISCARD cw_status cli_open_coloring(cli_coloring *coloring, const char *path,
                                         const cli_input *input, size_t step,
                                         const cw_volume **volume, cw_error *err);

/* Returns the settings of the pipeline, without its callback: the map, and its range if it is known. */
cw_pipeline_color cli_describe_coloring(const cli_coloring *coloring);

/* Gives a mesh the values and colours of the volume that cli_open_coloring() read, and says so. */
CW_NODISCARD cw_status cli_color_mesh(cli_coloring *coloring, cw_mesh *mesh, int threads,
                                      cw_error *err);

/* Says what the pipeline did, and keeps the range for the next surface. */
void cli_tell_coloring(cli_coloring *coloring, const cw_pipeline_facts *facts);

/* Writes the settings. */
void cli_json_color(cli_json *j, const cli_coloring *coloring);
void cli_free_coloring(cli_coloring *coloring);

#endif
