/* Tells what the stages of a surface did: people, and the report. */
#ifndef CLI_RESULTS_STAGE_FACTS_H
#define CLI_RESULTS_STAGE_FACTS_H

#include "cli/inputs/filter_options.h"
#include "cli/results/color_by.h"
#include "cli/results/run_report.h"

/* A surface whose stages ran, and the options that asked for them. */
typedef struct cli_staged {
    const char *subject; /* names the surface: the file of its volume, or a label in that */
    const cw_pipeline_facts *facts;
    double least_mm3; /* what components had to enclose */
    const cli_smoothing *smooth;
    const cli_plane *cut;
    cli_coloring *coloring; /* NULL: its colours are no volume's */
    cli_report *report;     /* gets the warnings */
} cli_staged;

/* Says what the stages did. */
void cli_tell_stages(const cli_staged *surface);

/* Writes what they did: a key for each stage that has one. */
void cli_json_stages(cli_json *j, const cw_pipeline_facts *facts, double least_mm3);

/* Says how many components were kept and dropped. is_cut: a cut followed, which may part them. */
void cli_tell_components(const char *name, double least_mm3, const cw_drop_counts *counts,
                         bool is_cut);

enum { CLI_SMOOTHED_TEXT = 256 };

enum { CLI_HANDLES_TEXT = 320 };

/* Writes the object "handles". */
void cli_json_handles(cli_json *j, const cw_close_handles_facts *facts);

/* Prints how many handles were closed, and why others are left. */
void cli_handles_text(const cw_close_handles_facts *facts, char text[CLI_HANDLES_TEXT]);

/* Writes the object "smooth". */
void cli_json_smoothed(cli_json *j, const cw_smooth_facts *facts);

/* Prints moves, and what they did to volume and triangles. An open surface encloses no volume. */
void cli_smoothed_text(const cw_smooth_facts *facts, char text[CLI_SMOOTHED_TEXT]);

#endif
