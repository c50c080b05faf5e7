/* Runs a command once for each of its inputs, in processes of their own. */
#ifndef CLI_FRAMEWORK_BATCH_H
#define CLI_FRAMEWORK_BATCH_H

#include "cli/framework/options.h"

/* Rows of the options of batches, for a command's table. */
#define CLI_BATCH_OPTIONS(args)                                                                \
    CLI_HEADED("Batches"),                                                                     \
        {"batch",                                                                              \
         0,                                                                                    \
         CLI_FLAG,                                                                             \
         NULL,                                                                                 \
         "Run the command for each input by itself; the options below imply it (off)",         \
         CLI_BATCH_ROW(args, is_batch)},                                                       \
        {"jobs",                                                                               \
         0,                                                                                    \
         CLI_COUNT,                                                                            \
         "N",                                                                                  \
         "Inputs to work on at the same time; they share threads and --memory (1)",            \
         CLI_BATCH_ROW(args, jobs)},                                                           \
        {"skip-existing",                                                                      \
         0,                                                                                    \
         CLI_FLAG,                                                                             \
         NULL,                                                                                 \
         "Skip inputs whose output exists (off)",                                              \
         CLI_BATCH_ROW(args, skip_existing)},                                                  \
        {"keep-going",                                                                         \
         0,                                                                                    \
         CLI_FLAG,                                                                             \
         NULL,                                                                                 \
         "Go on with other inputs after one failed (off)",                                     \
         CLI_BATCH_ROW(args, keep_going)},                                                     \
    {                                                                                          \
        "json-lines", 0, CLI_TEXT, "FILE",                                                     \
            "Write a line of JSON for each input: its status, time and report",                \
            CLI_BATCH_ROW(args, json_lines), CLI_VALUES_JSON_LINES                             \
    }
#define CLI_BATCH_ROW(args, field)                                                             \
    offsetof(args, common) + offsetof(cli_common, batch) + offsetof(cli_batch, field)

/* Returns true if the options ask for a batch. */
bool cli_is_batch(const cli_batch *batch);

/* Runs the command for each input. Patterns such as 'sub-*.nii' stand for the files that match.
 * What the runs print comes out whole, in the order of the inputs.
 *
 * args     as cli_parse() filled them in; the output may hold {stem} and {parent}
 * run      runs the command for the only input that args then have, and prints its error;
 *          called in a process of its own
 * Returns  CW_ERR_BATCH      some inputs failed: how many, of how many
 *          CW_ERR_ARGUMENT   --json with a file, which each input would write; two inputs with
 *                            the same output; a pattern that matches nothing
 *          CW_ERR_OUTPUT     of --json-lines; CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cli_batch_run(const cli_command *command, cli_common *args,
                                     cw_status (*run)(const cli_command *command,
                                                      cli_common *args, cw_error *err),
                                     cw_error *err);

#endif
