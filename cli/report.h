/* The report of a run: what --json FILE holds. One schema for every command that makes a mesh.
 */
#ifndef CLI_REPORT_H
#define CLI_REPORT_H

#include "cli/input.h"

#include <cubewright/extract.h>
#include <cubewright/quality.h>

enum { CLI_MAX_STEPS = 8 };

typedef struct cli_step {
    const char *name;
    double seconds;
    size_t peak_bytes, in, out;
} cli_step;

typedef struct cli_report {
    const char *path; /* of the report; "-" is stdout; NULL: none is written */
    const char *command;
    const cli_volume *input;    /* NULL: not read */
    const cw_quality *quality;  /* NULL: not measured */
    const cw_snap_counts *snap; /* NULL: not snapped */
    const char *output;         /* NULL: not written */
    const double *local_origin; /* the output's places are relative to it; NULL: the world's */
    char warning[512];          /* "": none */
    void (*params)(cli_json *j, const void *args); /* writes the settings of the main step */
    const void *args;
    cli_step steps[CLI_MAX_STEPS];
    size_t step_count;
    double step_start;
} cli_report;

/* Times a step, from one call to the other. -v prints it. */
void cli_report_begin(cli_report *report);
void cli_report_end(cli_report *report, const char *name, size_t in, size_t out);

/* Says it on stderr, unless quiet, and keeps it for the report. */
void cli_report_warn(cli_report *report, const char *format, ...) CW_PRINTF(2, 3);

/* Writes the report of a run that ended so, if one was asked for. Returns that status, or why
 * the report could not be written when the run itself went well. */
cw_status cli_report_write(const cli_report *report, cw_status status, cw_error *err);

#endif
