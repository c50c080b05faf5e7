/* Which steps of a time series a run is about: of one file, or each a file of its own. */
#ifndef CLI_INPUTS_TIME_SERIES_H
#define CLI_INPUTS_TIME_SERIES_H

#include "cli/inputs/volume_input.h"

/* One step. */
typedef struct cli_moment {
    const char *path; /* of its file */
    size_t step;      /* in that file */
    size_t number;    /* in the series, from 0: what {step} stands for */
    double time_s;    /* when the series is timed; else 0 */
} cli_moment;

/* A zeroed one is empty. */
typedef struct cli_series {
    bool given; /* steps were asked for, or there are several files; else one volume is meant */
    bool timed; /* the file says how far apart its steps are, or a list when each is */
    struct {
        char **path;
        size_t count; /* 0: the steps are those of one file */
    } files;
    cli_moment *moments; /* the steps that were asked for */
    size_t count;
} cli_series;

/* Finds them: files (also by patterns, a folder or a list) in natural order, a step each, or
 * the steps of the only one. One file without --steps is not looked at. Files must agree in
 * what cli_agree() says. Free it, also after failure, with cli_free_series(). Returns
 * CW_ERR_ARGUMENT for a step that is not there, and as cw_steps_list(); CW_ERR_FORMAT for files
 * that do not agree, naming one and in what it differs; as cw_volume_read() */
CW_NODISCARD cw_status cli_find_series(cli_series *series, const cli_common *common,
                                       const cli_input *input, const cli_steps *steps,
                                       cw_error *err);
void cli_free_series(cli_series *series);

/* Whether a file can be a step of the series that another begins: one step in it, as many
 * values a voxel, unit and frame named alike. Sizes, places and types may differ. Errors name
 * both. */
CW_NODISCARD cw_status cli_agree(const cw_volume *first, const char *first_path,
                                 const cw_volume *other, const char *other_path, cw_error *err);

#endif
