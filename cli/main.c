/* Runs the command that the first argument names, limits its memory, and turns its status
 * into an exit code. */
#include "cli/command_table.h"
#include "cli/framework/batch.h"
#include "cli/framework/commands.h"
#include "cli/framework/console.h"
#include "cli/framework/option_rules.h"
#include "cli/framework/run_config.h"
#include "cli/framework/stack_space.h"
#include "cli/framework/standard_streams.h"
#include "cli/help/help_search.h"
#include "cli/inputs/volume_input.h"
#include "cli/results/output_names.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/base/thread_pool.h"

#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Makes the allocator give back what is freed: arrays beyond a size go to the system at once, and
 * small ones share one heap. Kept for later, they add a tenth to what is in use. */
static void keep_no_freed_memory(void)
{
#ifdef __GLIBC__
    enum { LARGE = 1 << 20 };
    mallopt(M_MMAP_THRESHOLD, LARGE);
    mallopt(M_ARENA_MAX, 1);
#endif
}

/* Where a command has --memory, it is a limit to the whole process: what it has taken by now,
 * and what stacks and buffers will, comes off. Less than CLI_MIN_MEMORY is a limit to voxels and surface
 * only, for the program itself does not fit. */
static void limit_memory(const cli_command *command, const cli_common *args)
{
    enum { STACKS_AND_BUFFERS = 6 << 20 };
    for (size_t n = 0; n < command->option_count; n++) {
        const cli_option *o = &command->options[n];
        cli_input input = {0};
        if (o->kind == CLI_HEADING || strcmp(o->name, "memory") != 0)
            continue;
        memcpy(&input.memory, (const char *)args + o->offset, sizeof input.memory);
        if (input.memory)
            keep_no_freed_memory();
        const size_t requested = cli_memory_limit(&input),
                     limit = requested > CLI_MIN_MEMORY ? requested : CLI_MIN_MEMORY;
        const size_t spent = cli_peak_bytes() + STACKS_AND_BUFFERS;
        cw_memory_limit(limit > spent ? limit - spent : 1);
    }
}

/* Gives a process of a batch its share of the memory. */
static void share_memory(const cli_command *command, cli_common *args)
{
    for (size_t n = 0; n < command->option_count && args->processes > 1; n++) {
        const cli_option *o = &command->options[n];
        cli_input input = {0};
        char *field = (char *)args + o->offset;
        if (o->kind == CLI_HEADING || strcmp(o->name, "memory") != 0)
            continue;
        memcpy(&input.memory, field, sizeof input.memory);
        input.memory = cli_memory_limit(&input) / args->processes;
        memcpy(field, &input.memory, sizeof input.memory);
    }
}

/* Tells memory that ran out from memory that --memory does not allow. */
static void explain_memory(cw_error *err)
{
    char needed_text[CWI_MEMORY_TEXT], left_text[CWI_MEMORY_TEXT];
    size_t left;
    const size_t needed = cwi_memory_refused(&left);
    const cw_error first_error = *err;
    if (!needed || strstr(first_error.message, "were needed"))
        return;
    cwi_print_memory(needed, needed_text);
    cwi_print_memory(left, left_text);
    cwi_fail(err, first_error.status, "%.400s; %s were needed, and --memory leaves %s",
             first_error.message, needed_text, left_text);
}

static cw_status run_parsed(const cli_command *command, cli_common *args, cw_error *err)
{
    share_memory(command, args);
    limit_memory(command, args);
    cw_status st = command->run(args, err);
    if (st == CW_ERR_NO_MEMORY)
        explain_memory(err);
    cli_progress_end();
    if (cwi_granted_threads() > 0)
        cli_say("note: more threads were requested than can be had: %d", cwi_granted_threads());
    return st;
}

/* Runs the command for one input of a batch, in a process of its own. */
static cw_status run_in_batch(const cli_command *command, cli_common *args, cw_error *err)
{
    cw_status st = run_parsed(command, args, err);
    if (st != CW_OK)
        cli_say_error(err->message);
    return st;
}

/* Returns true for options that name an output. */
static bool names_output(const cli_option *o)
{
    static const cli_values outputs[] = {
        CLI_VALUES_VOLUME_OUTPUT, CLI_VALUES_MESH_OUTPUT, CLI_VALUES_DEFECTS,
        CLI_VALUES_JSON,          CLI_VALUES_JSON_LINES,  CLI_VALUES_CSV,
        CLI_VALUES_HTML,          CLI_VALUES_PNG,         CLI_VALUES_PVD};
    for (size_t n = 0; n < sizeof outputs / sizeof *outputs; n++)
        if (o->kind == CLI_TEXT && o->values == outputs[n])
            return true;
    return false;
}

/* The file of --save-config is an output, too. */
static cw_status check_save(const cli_common *args, const cli_given_option *options,
                            cw_error *err)
{
    cw_status st = cli_check_output(args->save_config, args->inputs, args->input_count, err);
    for (size_t n = 0; n < args->given_count && st == CW_OK; n++)
        if (names_output(options[n].option))
            st = cli_check_apart(args->save_config, options[n].value, err);
    return st;
}

/* Runs what the words ask for. */
static cw_status run_words(const cli_command *command, const cli_words *words, cli_common *args,
                           const char **inputs, cw_error *err)
{
    if (command->defaults)
        memcpy(args, command->defaults, command->size);
    size_t max_count = 1; /* letters of flags may be together in a word */
    for (int n = 0; n < words->count; n++)
        max_count += strlen(words->words[n]);
    args->given_options = calloc(max_count, sizeof *args->given_options);
    if (!args->given_options)
        return cwi_fail_memory(err);
    cli_given_option *const options = args->given_options;
    args->config_inputs = words->inputs;
    args->config_input_count = words->input_count;
    cw_status st = cli_parse(command, words->count, words->words, args, inputs, err);
    args->given_options = NULL; /* the window parses more options later */
    cli_keep_run(command, args, options);
    cli_console_start(args, CLI_PROGRESS_AUTO);
    if (st == CW_OK && !args->help)
        st = cli_check_rules(command, args, err);
    if (st == CW_OK && !args->help)
        st = cli_streams_open(command, args, options, err);
    if (st == CW_OK && args->save_config)
        st = check_save(args, options, err);
    if (st == CW_OK && args->help)
        cli_print_help(command, false);
    else if (st == CW_OK && cli_is_batch(&args->batch))
        st = cli_batch_run(command, args, run_in_batch, err);
    else if (st == CW_OK)
        st = run_parsed(command, args, err);
    if (st == CW_OK && args->save_config)
        st = cli_save_config(args->save_config, err);
    cli_streams_close();
    free(options);
    return st;
}

static cw_status run_command(const cli_command *command, int count, char **words, cw_error *err)
{
    cli_words all;
    cw_status st = cli_read_config(command, count, words, &all, err);
    cli_common *args = calloc(1, command->size);
    const char **inputs = calloc((size_t)all.count + all.input_count + 1, sizeof *inputs);
    if (st == CW_OK && args && inputs)
        st = run_words(command, &all, args, inputs, err);
    else if (st == CW_OK)
        st = cwi_fail_memory(err);
    cli_progress_end();
    free(args);
    free(inputs);
    cli_free_words(&all);
    return st;
}

/* -h, --help and --version in the place of a command are that command. */
static const char *command_name(const char *word)
{
    if (strcmp(word, "-h") == 0 || strcmp(word, "--help") == 0)
        return "help";
    return strcmp(word, "--version") == 0 ? "version" : word;
}

/* Batch systems and shells say by OMP_NUM_THREADS how many threads a program should use. A list is
 * for nested loops, which we run on one thread. */
static void read_default_threads(void)
{
    const char *text = getenv("OMP_NUM_THREADS");
    const long threads = text ? strtol(text, NULL, 10) : 0;
    if (threads > 0)
        cwi_set_default_threads(threads < CWI_MAX_THREADS ? (int)threads : CWI_MAX_THREADS);
}

int main(int argc, char **argv)
{
    cw_error err = {0};
    cw_status st = CW_ERR_ARGUMENT;
    cli_commands = cli_command_table;
    cli_find_word = cli_search_word;
    cli_reserve_stack();
    cli_catch_signals();
    read_default_threads();
    const cli_command *command =
        cli_find_command(argc > 1 ? command_name(argv[1]) : "help", &err);
    if (command)
        st = run_command(command, argc > 1 ? argc - 2 : 0, argv + (argc > 1 ? 2 : 1), &err);
    if (st == CW_OK && (fflush(stdout) != 0 || ferror(stdout)))
        st = cli_fail_standard(&err);
    if (st != CW_OK && !cli_pipe_is_closed())
        cli_say_error(err.message);
    return cw_status_exit_code(st);
}
