#include "cli/commands.h"
#include "core/status.h"

#include <cubewright/formats.h>

#include <stdio.h>
#include <string.h>
#include <strings.h>

typedef struct help_args {
    cli_common common;
    const char *search;
} help_args;

static void print_overview(void)
{
    puts("cubewright COMMAND [options] INPUT... -o OUTPUT\n"
         "Volumes (CT, MR, micro-CT, simulations) into surfaces.\n\nCommands");
    for (size_t n = 0; cli_commands[n]; n++)
        printf("  %-10s%s\n", cli_commands[n]->name, cli_commands[n]->about);
    puts("\n'cubewright COMMAND -h' lists a command's options, 'cubewright help COMMAND' says "
         "more,\n"
         "'cubewright help exit' lists exit codes, 'cubewright help --search WORD' looks in "
         "all.\n\n"
         "Try it without data:\n"
         "  cubewright make ct-head -o head.nrrd\n"
         "  cubewright extract head.nrrd --iso 300 -o skull.glb");
}

static void print_exit_codes(void)
{
    puts("Exit codes");
#define ROW(name, code, json, text) printf("  %3d  %-20s%s\n", code, json, text);
    CW_STATUS_TABLE(ROW)
#undef ROW
}

static bool contains(const char *text, const char *word)
{
    for (; text && *text; text++)
        if (strncasecmp(text, word, strlen(word)) == 0)
            return true;
    return false;
}

static size_t search_options(const char *command, const cli_option *options, size_t count,
                             const char *word)
{
    size_t found = 0;
    for (size_t n = 0; n < count; n++)
        if (options[n].kind != CLI_HEADING &&
            (contains(options[n].name, word) || contains(options[n].about, word) ||
             contains(options[n].value, word))) {
            printf("%s --%s%s%s: %s\n", command, options[n].name, options[n].value ? " " : "",
                   options[n].value ? options[n].value : "", options[n].about);
            found++;
        }
    return found;
}

static cw_status search(const char *word, cw_error *err)
{
    size_t found =
        search_options("every command", cli_common_options, cli_common_option_count, word);
    for (size_t n = 0; cli_commands[n]; n++) {
        const cli_command *c = cli_commands[n];
        if (contains(c->name, word) || contains(c->about, word) || contains(c->page, word)) {
            printf("%s: %s\n", c->name, c->about);
            found++;
        }
        found += search_options(c->name, c->options, c->option_count, word);
    }
    return found ? CW_OK
                 : cw_fail(err, CW_ERR_ARGUMENT, "nothing in the help mentions '%s'", word);
}

static cw_status run(void *p, cw_error *err)
{
    const help_args *args = p;
    if (args->search)
        return search(args->search, err);
    if (args->common.input_count == 0)
        print_overview();
    else if (strcmp(args->common.inputs[0], "exit") == 0)
        print_exit_codes();
    else {
        const cli_command *command = cli_find_command(args->common.inputs[0], err);
        if (!command)
            return CW_ERR_ARGUMENT;
        cli_print_help(command, true);
    }
    return CW_OK;
}

static const cli_option options[] = {
    {"search", 's', CLI_TEXT, "WORD", "Find commands and options by a word or its synonyms",
     offsetof(help_args, search)},
};

const cli_command cli_help = {
    .name = "help",
    .usage = "[COMMAND | exit]",
    .about = "Explain a command, list the exit codes, or search the help",
    .page = cli_page_help,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .max_inputs = 1,
    .size = sizeof(help_args),
    .run = run,
};
