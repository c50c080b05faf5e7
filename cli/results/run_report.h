/* The report of a run: what --json FILE holds. One schema for every command that makes
 * a mesh. */
#ifndef CLI_RESULTS_RUN_REPORT_H
#define CLI_RESULTS_RUN_REPORT_H

#include "cli/assets/orient_print.h"
#include "cli/inputs/time_series.h"
#include "cli/results/printability.h"

#include <cubewright/atlas.h>
#include <cubewright/check.h>
#include <cubewright/pipeline.h>

#include <stdio.h>

typedef struct cli_step {
    const char *name;
    size_t made; /* which mesh it is about; nothing to go by before the first */
    double seconds;
    size_t peak_bytes, in, out;
} cli_step;

enum { CLI_MAX_WARNINGS = 3 }; /* about one mesh */

/* How far a mesh is from the one that it was made of, and that from it. */
typedef struct cli_comparison {
    bool made, has_field; /* there are the first two, the third */
    cw_mesh_comparison with_input;
    cw_distance to_field;
    bool has_full_field; /* that of what it was made of, by the same measure */
    cw_distance full_to_field;
    bool has_texture;            /* there is the next: of both meshes */
    cw_texture_distance texture; /* over all parts */
    double diagonal_mm;          /* of the input's box */
    double promised_mm;          /* 0: no error was promised */
    const char *other;           /* what it was made of; default: the input */
} cli_comparison;

enum { CLI_MAX_VIEWS = 64 }; /* of one mesh */

/* Measurements of a promise in one picture, against the full mesh. */
typedef struct cli_view_proof {
    double pixels; /* the farthest that was measured */
    double apart;  /* the share of pixels that look different: by more than 2/255 */
} cli_view_proof;

typedef struct cli_proof {
    bool made;
    size_t count; /* of views */
    double promised_pixels, promised_mm, mm;
    size_t full_triangles, full_bytes, bytes; /* of work, besides the voxels */
    double full_seconds;
    size_t culled;              /* triangles that no view sees, left out */
    size_t voxels, seen_voxels; /* of the bricks that views see; 0: not looked for */
    cli_view_proof views[CLI_MAX_VIEWS];
} cli_proof;

/* Comparison of the surface that --crop left with the whole one. */
typedef struct cli_crop_proof {
    bool made;
    size_t voxels, triangles,
        bytes; /* of the part, its caps left out; bytes: voxels and work */
    size_t whole_voxels, whole_triangles, whole_bytes;
    double seconds, whole_seconds; /* to extract */
    double apart_mm;               /* the farthest that two vertices are which should be one */
} cli_crop_proof;

/* One mesh of a run, as far as it has come. */
typedef struct cli_made {
    const char *path; /* where it goes */
    const char *name; /* of a part; NULL: it is the surface at an isovalue */
    double iso;
    const cli_moment *moment; /* of a time series; NULL: of the only step */
    bool timed;               /* it says when that is */
    bool measured, written, local, snapped;
    cw_quality quality;            /* when it is measured */
    bool shells;                   /* whether that tells which way shells face */
    const cw_crossings *crossings; /* NULL: not looked for */
    cw_snap_counts snap;           /* when it is snapped */
    cw_compression compression;
    cw_compressed compressed; /* when there is any */
    unsigned dropped;         /* what the file does not hold of it: cw_keeps flags */
    double origin[3];         /* when it is local: the places in the file are relative to it */
    cli_comparison compared;
    double pivot[3];         /* mm by which it was moved to its pivot */
    cw_orient_facts orient;  /* of --orient-print */
    double switch_m;         /* of a level: distance from which on its error is below a pixel */
    double least_mm3;        /* what components had to enclose */
    cw_pipeline_facts facts; /* of the stages that ran */
    cli_printed print;       /* of --profile print */
    cli_proof proof;
    cli_crop_proof crop;
    char warning[CLI_MAX_WARNINGS][512];
    size_t warning_count;
    cw_error error; /* with the status CW_OK: none */
} cli_made;

typedef struct cli_report {
    const char *path; /* of the report; "-" is stdout; NULL: none is written */
    const char *command;
    const cli_volume *input; /* NULL: not read */
    cli_made *made;
    size_t made_count;     /* meshes begun so far */
    const char *several;   /* what the list of meshes is called; NULL: one was asked for */
    const char *main_step; /* the one with the settings; default: that named as the command */
    /* Writes the settings of the main step, for one mesh. */
    void (*params)(cli_json *j, const void *args, const cli_made *made);
    /* Writes what only this command has to say, behind the input; NULL: nothing. */
    void (*facts)(cli_json *j, const void *args);
    const void *args;
    cli_step *steps;
    size_t step_count, step_room;
    double step_start;
} cli_report;

enum { CLI_STEPS_PER_MESH = 24 }; /* of one mesh */

/* Grows the capacity to that many meshes, before their first step. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_report_reserve(cli_report *report, size_t meshes, cw_error *err);

/* Names of the properties of meshes that formats may not keep. Positions have a warning of
 * their own. */
extern const struct cli_kept {
    unsigned flag; /* cw_keeps */
    const char *name;
} cli_kept[];
extern const size_t cli_kept_count;

/* The next mesh of a run: steps and warnings from now on are about it. */
cli_made *cli_report_next(cli_report *report, const char *path, double iso);

/* Times a step, from one call to the other. -v prints it. */
void cli_report_begin(cli_report *report);
void cli_report_end(cli_report *report, const char *name, size_t in, size_t out);

/* Ends the step in which a volume was read and changed: as "read", and each change by itself. */
void cli_report_read(cli_report *report, const cli_volume *volume);

/* Says it of the latest mesh on stderr, unless quiet, and keeps it for the report. */
void cli_report_warn(cli_report *report, const char *format, ...) CW_PRINTF(2, 3);

/* A run of a command that makes or checks meshes. */
typedef struct cli_run {
    const cli_common *common;
    int progress;     /* cli_progress_mode */
    const char *json; /* of the command line; the body sets report->path once it is checked */
    size_t meshes;    /* the report begins with capacity for these; default: 1 */
    cw_status (*body)(void *state, cw_error *err);
    void *state; /* of the body */
} cli_run;

/* Starts the console, runs the body, writes the report if it has a path, and frees the report.
 * Returns the status of the body, or why the report could not be written when the body
 * succeeded. */
CW_NODISCARD cw_status cli_run_reported(const cli_run *run, cli_report *report, cw_error *err);

/* Writes the text of a report to a file, or the standard output for "-". CW_ERR_OUTPUT */
CW_NODISCARD cw_status cli_report_save(const char *path, const char *text, size_t size,
                                       cw_error *err);

/* The same of what `put` prints of something; nothing without a path. Also CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_report_make(const char *path,
                                       void (*put)(FILE *out, const void *what),
                                       const void *what, cw_error *err);

#endif
