/* Runs in a file: --config reads the options of a command, --save-config writes those of a run. */
#ifndef CLI_FRAMEWORK_RUN_CONFIG_H
#define CLI_FRAMEWORK_RUN_CONFIG_H

#include "cli/framework/options.h"

/* The words of a file, and those of the command line behind them. Zeroed: empty. */
typedef struct cli_words {
    int count;
    char **words;
    char **owned; /* those of the file */
    size_t owned_count;
} cli_words;

/* Puts the options of the file that --config names before the words, so that these have the last
 * word. Inputs of the file count when there are no others. Free it, also after failure.
 *
 * The file is a part of TOML: lines such as `iso = "bone"`, `open = true`, `lod = [50000, 5000]` and
 * `inputs = ["ct"]`; sections such as [extract] are of that command alone. A key `command` must be
 * the command's name.
 * Returns  CW_ERR_IO        it cannot be read
 *          CW_ERR_FORMAT    a line is of another form
 *          CW_ERR_ARGUMENT  the command has no option of that name, or it takes other values
 *          Errors name the file and the line. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_read_config(const cli_command *command, int count, char **words,
                                       cli_words *out, cw_error *err);
void cli_free_words(cli_words *words);

/* Writes the options that were said, args->said_count, to the file of --save-config, which cli_read_config() reads.
 * Returns CW_ERR_OUTPUT; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_save_config(const cli_command *command, const cli_common *args,
                                       const cli_said *said, cw_error *err);

#endif
