/* The facts of a volume that the command info finds, and how they are printed. */
#ifndef CLI_INFO_INFO_FACTS_H
#define CLI_INFO_INFO_FACTS_H

#include "cli/info/info_label_predict.h"
#include "cli/info/info_labels.h"
#include "cli/info/info_predict.h"
#include "cli/info/info_scales.h"
#include "cli/info/info_within.h"
#include "cli/inputs/level_choice.h"

/* Between how many kinds of values levels are sought, and in how many bins. */
enum { CLI_INFO_LEVELS = 3, CLI_INFO_TISSUES = CLI_LEVEL_METAL - CLI_LEVEL_BONE + 1 };

/* As many as readers take. */
enum { CLI_INFO_COMPONENTS = 16 };

typedef struct cli_info_level {
    const char *name;
    double value;
    size_t triangles; /* of --levels */
} cli_info_level;

typedef struct cli_info_facts {
    cli_volume volume;
    cw_series series;    /* of a DICOM image; else no images */
    cw_statistics range; /* and the bins asked for */
    cli_info_level levels[CLI_INFO_LEVELS + 2 + CLI_INFO_TISSUES];
    int level_count;
    cli_label_facts labels;
    cli_scales scales;
    cli_within within;
    cli_predictions predictions;
    cli_label_prediction label_prediction;
    double read_seconds; /* of the volume, or of the part that was read */
    cw_array *arrays;    /* of a file that has several; else NULL */
    size_t array_count;
    double (*ranges)[2]; /* array_count x CLI_INFO_COMPONENTS: of those that are read */
} cli_info_facts;

/* Returns true if the range of an array's values was read. */
bool cli_info_is_reached(const cli_info_facts *facts, size_t array);

/* Prints the facts, with the triangles of levels where they were counted. step: of the values */
void cli_print_info(const cli_info_facts *facts, size_t step, bool predicted);
void cli_json_info(const cli_info_facts *facts, bool predicted);

/* Prints the series of a folder. notes: what their reader found */
void cli_print_series(const cli_volume *notes, const cw_series *series, size_t count);
void cli_json_all_series(const cli_volume *notes, const cw_series *series, size_t count);

#endif
