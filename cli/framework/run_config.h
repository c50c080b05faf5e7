/* Runs in a file: --config reads the options of a command, --save-config writes those of a run,
 * and each report holds its run. */
#ifndef CLI_FRAMEWORK_RUN_CONFIG_H
#define CLI_FRAMEWORK_RUN_CONFIG_H

#include "cli/framework/json_writer.h"
#include "cli/framework/options.h"

/* The words of a file, and those of the command line behind them. Zeroed: empty. */
typedef struct cli_words {
    int count;
    char **words;
    size_t owned_count;  /* the first are those of the file */
    const char **inputs; /* of the file; they count where the words have none */
    size_t input_count;
    struct json_t *root; /* of the file, which holds the inputs' texts */
} cli_words;

/* Puts the options of the file that --config names before the words, so that these have the last
 * word. Free it, also after failure.
 *
 * The file is JSON: a report with its `run`, or a run alone:
 *
 *     {"command": "extract", "inputs": ["ct.nrrd"], "options": {"iso": [50, 300], "open": true}}
 *
 * Each field may be left out. Values are those of the command line as texts, numbers, true or
 * false, and lists.
 * Returns  CW_ERR_IO        it cannot be read
 *          CW_ERR_FORMAT    it is not JSON
 *          CW_ERR_ARGUMENT  it is a run of another command, the command has no option of that
 *                           name, or it takes other values
 *          Errors name the file and the field. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_read_config(const cli_command *command, int count, char **words,
                                       cli_words *out, cw_error *err);
void cli_free_words(cli_words *words);

/* Keeps what this process was asked for; all are borrowed. options: args->given_count options */
void cli_keep_run(const cli_command *command, const cli_common *args,
                  const cli_given_option *options);

/* Begins a report: opens its object, and writes the schema, the version and the run. */
void cli_json_begin(cli_json *j, const char *schema);

/* Writes the run to a file. Returns CW_ERR_OUTPUT; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_save_config(const char *path, cw_error *err);

#endif
