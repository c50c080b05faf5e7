/* The command join: makes one file of the fragments that 'extract --part' made. */
#include "cli/extract/part_join.h"
#include "cli/framework/commands.h"
#include "cli/framework/console.h"
#include "core/base/status.h"

typedef struct join_args {
    cli_common common;
    cli_input input;
    const char *output, *format, *name;
    bool local, no_clobber, check;
    int progress;
} join_args;

static const join_args defaults = {.check = true};

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE",
     "Mesh to write, in the format of its extension; - is the standard output (with --format)",
     offsetof(join_args, output), CLI_VALUES_MESH_OUTPUT},
    {"format", 0, CLI_TEXT, "NAME", "Format to write; names as in 'formats' (by extension)",
     offsetof(join_args, format), CLI_VALUES_MESH_WRITER},
    {"name", 0, CLI_TEXT, "TEXT", "Name of the object inside the file (the file's)",
     offsetof(join_args, name)},
    {"local", 0, CLI_FLAG, NULL,
     "Write coordinates relative to the mesh's origin, which is printed (off: world)",
     offsetof(join_args, local)},
    {"no-clobber", 0, CLI_FLAG, NULL, "Fail if the output exists (off: replace it)",
     offsetof(join_args, no_clobber)},
    {"check", 0, CLI_FLAG, NULL, "Measure the mesh: closed, manifold (on; --no-check)",
     offsetof(join_args, check)},
    CLI_HEADED(CLI_LIMITS),
    CLI_MEMORY_OPTION(join_args),
    CLI_PROGRESS_OPTION(join_args),
};

static cw_status run_join(void *p, cw_error *err)
{
    const join_args *args = p;
    const char *folder = args->common.inputs[0];
    const double start = cli_seconds();
    cli_manifest m = {0};
    char text[CLI_PARTS_TEXT];
    if (!args->output)
        return cwi_fail(err, CW_ERR_ARGUMENT, "join needs an output: -o FILE");
    cli_console_start(&args->common, (cli_progress_mode)args->progress);
    const cw_write_desc desc = {.format = args->format,
                                .name = args->name,
                                .local = args->local,
                                .no_clobber = args->no_clobber};
    cw_status st = cli_check_writable(args->output, &desc, err);
    if (st == CW_OK)
        st = cli_read_manifest(folder, &m, err);
    if (st == CW_OK)
        st = cli_check_joined_output(args->output, folder, m.parts, err);
    if (st == CW_OK)
        st = cli_join_parts(folder,
                            &(cli_joined){.output = args->output,
                                          .from = cli_count_parts(m.parts, text),
                                          .desc = &desc,
                                          .manifest = &m,
                                          .input = &args->input,
                                          .check = args->check,
                                          .start = start},
                            err);
    cli_free_manifest(&m);
    return st;
}

const cli_command cli_join = {
    .name = "join",
    .usage = "DIR -o MESH [options]",
    .about = "Join the parts of a surface that 'extract --part' made to one file",
    .page = cli_page_join,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .min_inputs = 1,
    .max_inputs = 1,
    .inputs = CLI_VALUES_FOLDER,
    .size = sizeof(join_args),
    .defaults = &defaults,
    .run = run_join,
};
