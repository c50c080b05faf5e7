/* The command help: prints the overview, the exit codes, a page of help, the results of a
 * search, a manual page, or a script for the completion of a shell. */
#include "cli/completion/completion.h"
#include "cli/framework/commands.h"
#include "cli/help/help_search.h"
#include "cli/help/man_page.h"
#include "core/base/status.h"

#include <stdio.h>
#include <string.h>

typedef struct help_args {
    cli_common common;
    const char *search, *manual;
    int shell;
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
        "  cubewright help exit            the exit codes\n"
        "  cubewright help environment     variables of the environment, and files\n"
        "  cubewright help library         the library for C and C++\n\n"
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

static const cli_topic *find_topic(const char *name)
{
    for (const cli_topic *t = cli_topics; t->name; t++)
        if (strcmp(t->name, name) == 0)
            return t;
    return NULL;
}

static cw_status print_page(const char *name, cw_error *err)
{
    const cli_topic *topic = find_topic(name);
    const cli_command *command = topic ? NULL : cli_find_command(name, err);
    if (topic && topic->page)
        fputs(topic->page, stdout);
    else if (topic)
        print_exit_codes();
    else if (command)
        cli_print_help(command, true);
    return topic || command ? CW_OK : CW_ERR_ARGUMENT;
}

static cw_status run_help(void *p, cw_error *err)
{
    static void (*const shells[])(void) = {cli_complete_bash, cli_complete_zsh,
                                           cli_complete_fish};
    const help_args *args = p;
    if (args->search)
        return cli_search(args->search, err);
    if (args->manual)
        return cli_print_manual(args->manual, err);
    if (cli_is_given(&cli_help, &args->common, "completion"))
        shells[args->shell]();
    else if (args->common.input_count == 0)
        print_overview();
    else
        return print_page(args->common.inputs[0], err);
    return CW_OK;
}

static const cli_option options[] = {
    {"search", 's', CLI_TEXT, "WORD", "Find commands and options by a word or its synonyms",
     offsetof(help_args, search)},
    {"man", 0, CLI_TEXT, "NAME",
     "Print a manual page in roff: of a command, of cubewright, or of the library",
     offsetof(help_args, manual), CLI_VALUES_MANUAL},
    {"completion", 0, CLI_CHOICE, "bash/zsh/fish",
     "Print a script that completes words of the command line", offsetof(help_args, shell)},
};

const cli_command cli_help = {
    .name = "help",
    .usage = "[COMMAND|TOPIC] [options]",
    .about = "Explain a command, list the exit codes, or search the help",
    .page = cli_page_help,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .max_inputs = 1,
    .inputs = CLI_VALUES_TOPIC,
    .size = sizeof(help_args),
    .run = run_help,
};
