/* A series of volumes: the surface of each step, measured and drawn. */
#ifndef CLI_STUDY_SERIES_STUDY_H
#define CLI_STUDY_SERIES_STUDY_H

#include "cli/inputs/scene_source.h"
#include "cli/study/study.h"

/* Maximum of pictures, of steps spread evenly. */
enum { CLI_SERIES_PICTURES = 24 };

typedef struct cli_series_row {
    char why[CLI_WHY_CAPACITY]; /* there is no surface; empty: there is */
    double seconds;             /* of the extraction */
    size_t triangles, components;
    bool closed;
    double volume_mm3, area_mm2;
    cli_png drawn;
} cli_series_row;

typedef struct cli_series_study {
    cli_study study; /* of the level; its volume is that of the step at hand */
    cli_source source;
    cli_series_row *rows; /* of the source's steps; owned */
    double box[2][3];     /* around the surfaces of all steps */
    bool has_box;
} cli_series_study;

/* Measures and draws the surface of each step of the source, all from one place. A step
 * without a surface says so. Free with cli_free_series_study(), also after failure.
 * Returns  CW_ERR_EMPTY  no step has a surface; as cli_read_step() and cw_extract() */
CW_NODISCARD cw_status cli_study_series(cli_series_study *study, const cli_input *input,
                                        cw_error *err);
void cli_free_series_study(cli_series_study *study);

void cli_put_series_json(FILE *out, const void *study);

#endif
