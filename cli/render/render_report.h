/* Report of render for --json FILE. */
#ifndef CLI_RENDER_RENDER_REPORT_H
#define CLI_RENDER_RENDER_REPORT_H

#include "cli/inputs/label_scene.h"
#include "cli/render/scene_options.h"

/* One picture of a run. */
typedef struct cli_shot {
    char *path;
    size_t step; /* of the series */
    double turn_deg;
    double seconds; /* to draw, show and write it */
    cw_camera camera;
    bool written, compared;
    cw_comparison measured; /* when it is */
} cli_shot;

typedef struct cli_render_report {
    const cli_volume *volume; /* NULL: none was read */
    cw_mode mode;
    const char *backend;
    const cw_scene *scene; /* NULL: it did not come to one */
    const cw_transfer *transfer;
    const cli_label_scene *labels; /* without labels: none were drawn */
    const cli_shot *shots;
    size_t shot_count, triangles;
    double seconds;
} cli_render_report;

/* Writes it to a file, or the standard output for "-". Returns the status of the run, or why
 * the report could not be written when the run itself went well. */
CW_NODISCARD cw_status cli_render_report_write(const char *path,
                                               const cli_render_report *report,
                                               cw_status status, cw_error *err);

#endif
