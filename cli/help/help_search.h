/* Searches the help (help --search): finds options and commands by a word or a synonym. */
#ifndef CLI_HELP_SEARCH_H
#define CLI_HELP_SEARCH_H

#include "cli/framework/options.h"

#include <cubewright/core.h>

/* The command (cmd_help.c). */
extern const cli_command cli_help;

/* A row of the table of synonyms. Lists are parted by '|'. */
typedef struct cli_synonym {
    const char *words; /* lower case; a word of 4 letters or more also stands for longer ones */
    const char *name;  /* what it is called here; NULL: the same, or we do not have it */
    const char *terms; /* to look for: a text, or --option for that option alone */
    const char *note;  /* printed before the results; NULL: nothing */
} cli_synonym;

/* The last row has no words. */
extern const cli_synonym cli_synonyms[];

/* Prints what is found, each option once with the commands that have it. Every word of the
 * query must occur, by itself or as a synonym. CW_ERR_ARGUMENT: nothing is found. */
CW_NODISCARD cw_status cli_search(const char *query, cw_error *err);

/* Names what the search finds for a word that is no command, or no option of a command: see
 * cli_find_word. */
bool cli_search_word(const cli_command *command, const char *word, bool in_texts, char *names,
                     size_t size);

#endif
