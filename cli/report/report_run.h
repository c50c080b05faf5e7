/* The command report between its files: options, and a run of one of its kinds. */
#ifndef CLI_REPORT_REPORT_RUN_H
#define CLI_REPORT_REPORT_RUN_H

#include "cli/results/output_names.h"
#include "cli/study/label_study.h"
#include "cli/study/mesh_study.h"
#include "cli/study/series_study.h"

/* The command (cmd_report.c). */
extern const cli_command cli_report_command;

typedef struct cli_report_args {
    cli_common common;
    cli_input input;
    const char *output, *json, *csv, *budget, *title, *source, *mesh_reader, *labels, *names;
    cli_number iso;
    cli_sizes dims;
    cli_steps steps;
    int inside, progress;
} cli_report_args;

typedef struct cli_report_run {
    cli_report_args *args;
    cli_volume volume;
    char *input_words, *make_words;
    char field_path[64], title[512];
    cli_outputs files; /* the page */
    cli_study study;
    cli_mesh_study mesh;     /* in place of it, with --source, */
    cli_label_study labels;  /* or of labels, */
    cli_series_study series; /* or of a series */
} cli_report_run;

/* Fails for a mesh without a source. */
CW_NODISCARD cw_status cli_report_check_kind(const cli_report_args *args, cw_error *err);

/* Whether the inputs are the steps of a series. */
bool cli_report_is_series(const cli_report_args *args);

/* Finds the word for all labels, where nobody said which, of a map of labels. labels: set to
 * that or to those of the options; NULL: it is no such map. */
CW_NODISCARD cw_status cli_report_find_labels(cli_report_run *run, const char **labels,
                                              cw_error *err);

/* The reports that compare no settings. */
CW_NODISCARD cw_status cli_report_mesh(cli_report_run *run, cw_error *err);
CW_NODISCARD cw_status cli_report_labels(cli_report_run *run, const char *labels,
                                         cw_error *err);
CW_NODISCARD cw_status cli_report_series(cli_report_run *run, cw_error *err);

#endif
