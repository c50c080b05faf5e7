/* The command help: prints the overview, the exit codes, a page of help, or the results of a
 * search. */
#include "cli/framework/commands.h"
#include "cli/help/help_search.h"
#include "core/base/status.h"

#include <stdio.h>
#include <string.h>

typedef struct help_args {
    cli_common common;
    const char *search;
} help_args;

static void print_overview(void)
{
    puts("cubewright COMMAND [options] INPUT... -o OUTPUT\n"
         "Turns volumes (CT, MR, micro-CT, simulations) into surfaces.\n\nCommands");
    for (size_t n = 0; cli_commands[n]; n++)
        printf("  %-10s%s\n", cli_commands[n]->name, cli_commands[n]->about);
    puts(
        "\nHelp\n"
        "  cubewright COMMAND -h           the options of a command, with defaults in "
        "brackets\n"
        "  cubewright help COMMAND         an explanation, with examples\n"
        "  cubewright help --search WORD   options and commands for a word, such as threshold\n"
        "  cubewright help exit            the exit codes\n\n"
        "Try it without data\n"
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

static cw_status run_help(void *p, cw_error *err)
{
    const help_args *args = p;
    if (args->search)
        return cli_search(args->search, err);
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
    .run = run_help,
};
