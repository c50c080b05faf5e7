/* The page of a study, and its parts. */
#ifndef CLI_REPORT_PAGE_H
#define CLI_REPORT_PAGE_H

#include "cli/study/mesh_study.h"

#include <stdio.h>

/* Writes the page: one file of HTML that needs no other, and is well-formed XML as well. */
void cli_put_page(FILE *out, const void *study);
void cli_put_mesh_page(FILE *out, const void *mesh_study);
void cli_put_label_page(FILE *out, const void *label_study);
void cli_put_series_page(FILE *out, const void *series_study);

/* Everything before the contents of the page, and after it, with the scripts. */
void cli_put_page_begin(FILE *out, const char *title);
void cli_put_page_end(FILE *out);

/* Embedded when the program is built: report/style.css, report/view3d.js, report/tables.js. */
extern const char cli_report_style_style[], cli_report_script_view3d[],
    cli_report_script_tables[];

/* Text, escaped. */
void cli_put_html(FILE *out, const char *text);

/* Bytes as base64. */
void cli_put_base64(FILE *out, const char *bytes, size_t size);

/* Writes a picture, unless it is empty. The text for those who do not see it is escaped. */
void cli_put_image(FILE *out, const cli_png *png, const char *alt);

/* A command to be copied. */
void cli_put_code(FILE *out, const char *command);

/* One fact of the list at the top, in a <dl class="facts">. */
void cli_put_fact(FILE *out, const char *name, const char *value);

/* "12.3 ms", or "2.4 s"; "median of 3", "1 run". In one of four texts in static memory. */
const char *cli_seconds_text(double seconds);
const char *cli_runs_text(const cli_point *point);

/* Parts, from the top down. */
void cli_put_advice(FILE *out, const cli_study *study);
void cli_put_overview(FILE *out, const cli_study *study);
void cli_put_view(FILE *out, const cli_study *study);
void cli_put_pictures(FILE *out, const cli_study *study);
void cli_put_family(FILE *out, const cli_study *study, cli_family family);
void cli_put_quality(FILE *out, const cli_study *study);
void cli_put_verdicts(FILE *out, const cw_verdict *verdicts, size_t count);
void cli_put_looks(FILE *out, const cli_mesh_study *study);
void cli_put_print(FILE *out, const cli_study *study);

/* The scale of colours of errors, with ticks in millimetres and voxels. */
void cli_put_ramp(FILE *out, const cli_study *study);

/* Begins a view of three dimensions, adds a mesh to it, and ends it. colors: of the scale, as
 * "r,g,b r,g,b ...", from byte 0 to the highest. Meshes without bytes are left plain. */
void cli_put_view_begin(FILE *out);
void cli_put_view_mesh(FILE *out, const cli_packed *packed, const char *name,
                       const char *words);
void cli_put_view_end(FILE *out, const char *about);
void cli_put_error_colors(FILE *out, int stops);

/* Plots of a family: of errors against each cost that its points have. */
void cli_put_plots(FILE *out, const cli_study *study, cli_family family);
void cli_put_shapes(FILE *out, const cw_shapes *shapes);

/* The histogram of values, with a line at the level. */
void cli_put_histogram(FILE *out, const cw_statistics *values, double level);
size_t cli_family_groups(const cli_study *study, cli_family family, const char **groups,
                         size_t max);

#endif
