/* The values that options and inputs may have: names of tables, and extensions of files. */
#ifndef CLI_COMPLETION_VALUE_SETS_H
#define CLI_COMPLETION_VALUE_SETS_H

#include "cli/framework/options.h"

/* A set of values. Its names and its files are both offered. */
typedef struct cli_value_set {
    const char *name; /* of functions in scripts: lower case and '_' */
    const char *what; /* a word for it, such as "volume" */
    bool has_files;   /* offers files of the extensions; of any name without extensions */
    bool has_folders; /* folders are values; else they only lead to files */
    bool is_output;   /* a file that need not exist: extensions complete its name */
} cli_value_set;

/* The row of a set; of CLI_VALUES_ANY one without names and files. */
const cli_value_set *cli_value_set_of(cli_values values);

/* Returns the n-th name of a set, NULL after the last; *about says what it is, or is "". */
const char *cli_value_name(cli_values values, size_t n, const char **about);

enum { CLI_EXTENSIONS_SIZE = 512 };

/* Prints the extensions of a set's files, such as ".nrrd .nii.gz"; "" for any. */
void cli_value_extensions(cli_values values, char text[CLI_EXTENSIONS_SIZE]);

/* Returns the n-th fixed word of an option's values, and its length: each choice of a
 * CLI_CHOICE, or "off" of "off/L"; NULL after the last. */
const char *cli_option_word(const cli_option *option, size_t n, size_t *length);

/* Returns true if an option is followed by a value. */
bool cli_option_takes_value(const cli_option *option);

/* Returns true if --no-NAME is worth offering for an option. */
bool cli_option_is_negated(const cli_option *option);

#endif
