/* The command bench: its options, the checks of its arguments, and the list of its cases. */
#define _GNU_SOURCE /* open_memstream */
#include "cli/bench/bench.h"
#include "cli/framework/commands.h"
#include "cli/framework/console.h"
#include "cli/inputs/synthetic_input.h"
#include "cli/results/output_names.h"
#include "cli/results/run_report.h"
#include "core/base/atomic_file.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "core/volume/volume.h"

#include <stdlib.h>
#include <string.h>

typedef struct bench_args {
    cli_common common;
    cli_input input;
    const char *fields, *json, *csv;
    cli_counts sizes;
    cli_number iso;
    size_t repeat, peer_timeout;
    bool peers;
    int inside, progress;
} bench_args;

enum { MIN_SIZE = 8, MAX_SIZE = 1024 };

static const bench_args defaults = {
    .repeat = 5, .peer_timeout = 60, .sizes = {.count = 3, .n = {64, 128, 256}}};

static const cli_option options[] = {
    {"fields", 'f', CLI_TEXT, "NAME,...|all",
     "Fields of 'make' whose surface is known exactly (all; with files: none)",
     offsetof(bench_args, fields), CLI_VALUES_FIELD},
    {"sizes", 0, CLI_COUNTS, "N,...", "Samples along each axis, of fields (64,128,256)",
     offsetof(bench_args, sizes)},
    {"iso", 'i', CLI_LEVEL, "V",
     "Isovalue of files: a number, or a name as for 'extract' (otsu)",
     offsetof(bench_args, iso)},
    {"inside", 0, CLI_CHOICE, CLI_INSIDE_CHOICES,
     "Which values are inside the solid, of files (auto: above; in level sets below)",
     offsetof(bench_args, inside)},
    {"repeat", 'n', CLI_COUNT, "N", "Number of runs, of which the median is taken (5)",
     offsetof(bench_args, repeat)},
    CLI_HEADED("Comparison with other programs"),
    {"peers", 0, CLI_FLAG, NULL,
     "Run VTK, scikit-image, OpenVDB, meshoptimizer and draco_encoder as well (off)",
     offsetof(bench_args, peers)},
    {"peer-timeout", 0, CLI_COUNT, "SECONDS", "Time limit of a peer for one answer (60)",
     offsetof(bench_args, peer_timeout)},
    CLI_HEADED("Output files"),
    {"json", 0, CLI_TEXT, "FILE", "Write the facts as JSON; - is the standard output",
     offsetof(bench_args, json), CLI_VALUES_JSON},
    {"csv", 0, CLI_TEXT, "FILE",
     "Write a table with a row for each result; - is the standard output",
     offsetof(bench_args, csv), CLI_VALUES_CSV},
    CLI_INPUT_OPTIONS(bench_args),
    CLI_PROGRESS_OPTION(bench_args),
};

/* --- what is asked for -------------------------------------------------------------------- */

static cw_status take_field(const char *name, bool wanted[CW_FIELD_COUNT], cw_error *err)
{
    cw_field field;
    const bool found = cw_field_find(name, &field);
    const char *nearest = cli_nearest_field(name);
    if (found)
        wanted[field] = true;
    else if (nearest)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--fields: '%s' is not a field; did you mean '%s'?", name, nearest);
    return found ? CW_OK
                 : cwi_fail(err, CW_ERR_ARGUMENT,
                            "--fields: '%s' is not a field with a known surface; 'cubewright "
                            "make --list' lists those first",
                            name);
}

static cw_status choose_fields(const bench_args *args, bool wanted[CW_FIELD_COUNT],
                               cw_error *err)
{
    const char *text = args->fields ? args->fields : args->common.input_count ? NULL : "all";
    const bool all = text && strcmp(text, "all") == 0;
    cw_status st = CW_OK;
    for (int f = 0; f < CW_FIELD_COUNT; f++)
        wanted[f] = all;
    for (const char *at = all ? NULL : text; at && st == CW_OK;) {
        char name[64];
        const size_t length = strcspn(at, ",");
        snprintf(name, sizeof name, "%.*s", length < 60 ? (int)length : 60, at);
        st = take_field(name, wanted, err);
        at = at[length] ? at + length + 1 : NULL;
    }
    return st;
}

/* It can be written: that is found out before hours of work. */
static cw_status check_output(const bench_args *args, const char *path, cw_error *err)
{
    cwi_outfile *file = NULL;
    cw_status st = cli_check_output(path, args->common.inputs, args->common.input_count, err);
    if (st != CW_OK)
        return st;
    st = cwi_outfile_open(&file, path, false, err);
    cwi_outfile_abort(&file);
    return st == CW_OK ? st : cwi_fail_in(err, st, path);
}

static cw_status check_outputs(const bench_args *args, cw_error *err)
{
    const char *const files[] = {args->json, args->csv};
    cw_status st = CW_OK;
    for (size_t n = 0; n < 2 && st == CW_OK; n++)
        if (files[n] && strcmp(files[n], "-") != 0)
            st = check_output(args, files[n], err);
    if (st != CW_OK || !args->json || !args->csv)
        return st;
    if (strcmp(args->json, "-") == 0 && strcmp(args->csv, "-") == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--json and --csv: only one of them can use the standard output");
    return cli_check_apart(args->json, args->csv, err);
}

static cw_status check_args(const bench_args *args, cw_error *err)
{
    for (size_t n = 0; n < args->sizes.count; n++)
        if (args->sizes.n[n] < MIN_SIZE || args->sizes.n[n] > MAX_SIZE)
            return cwi_fail(err, CW_ERR_ARGUMENT, "--sizes: %d to %d were expected, not %zu",
                            MIN_SIZE, MAX_SIZE, args->sizes.n[n]);
    if (args->repeat < 1 || args->repeat > CLI_BENCH_MAX_RUNS)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--repeat: 1 to %d was expected, not %zu",
                        CLI_BENCH_MAX_RUNS, args->repeat);
    if (args->peer_timeout < 1 || args->peer_timeout > 86400)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--peer-timeout: 1 to 86400 seconds were expected, not %zu",
                        args->peer_timeout);
    if (args->iso.given && !args->common.input_count)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--iso is for files; fields have their own");
    return check_outputs(args, err);
}

/* So is what cannot be read. */
static cw_status check_files(const bench_args *args, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < args->common.input_count && st == CW_OK; n++) {
        const char *path = args->common.inputs[n];
        cw_volume shape;
        st = cli_read_shape(path, &args->input, &shape, err);
        if (st == CW_OK && cwi_volume_expect_even(&shape, "bench", err) != CW_OK)
            st = cwi_fail_in(err, CW_ERR_UNSUPPORTED, path);
    }
    return st;
}

static cw_status list_cases(const bench_args *args, cli_bench *b, cw_error *err)
{
    bool wanted[CW_FIELD_COUNT];
    cw_status st = choose_fields(args, wanted, err);
    if (st != CW_OK)
        return st;
    b->cases =
        calloc(args->common.input_count + CW_FIELD_COUNT * args->sizes.count, sizeof *b->cases);
    if (!b->cases)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for what is measured");
    for (size_t n = 0; n < args->common.input_count; n++) {
        const char *path = args->common.inputs[n];
        b->cases[b->case_count++] =
            (cli_bench_case){.path = path, .name = cli_shown_path(path)};
    }
    for (int f = 0; f < CW_FIELD_COUNT; f++)
        for (size_t n = 0; n < args->sizes.count && wanted[f]; n++) {
            const size_t size = args->sizes.n[n];
            b->cases[b->case_count++] = (cli_bench_case){.field = (cw_field)f,
                                                         .name = cw_field_name((cw_field)f),
                                                         .dim = {size, size, size}};
        }
    return CW_OK;
}

/* --- the run ------------------------------------------------------------------------------ */

static cw_status bench_cases(const bench_args *args, cli_bench *b, cw_error *err)
{
    cw_status st = check_args(args, err);
    if (st == CW_OK)
        st = list_cases(args, b, err);
    if (st == CW_OK)
        st = check_files(args, err);
    if (st == CW_OK)
        st = cli_bench_run(b, err);
    if (st == CW_OK)
        st = cli_report_make(args->json, cli_bench_put_json, b, err);
    return st == CW_OK ? cli_report_make(args->csv, cli_bench_put_csv, b, err) : st;
}

static cw_status run_bench(void *p, cw_error *err)
{
    bench_args *args = p;
    cli_bench *b = calloc(1, sizeof *b);
    if (!b)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for a bench");
    b->input = &args->input;
    b->iso = args->iso;
    b->inside = args->inside;
    b->with_peers = args->peers;
    b->repeat = args->repeat;
    b->limit_s = (double)args->peer_timeout;
    b->threads = cwi_threads((int)args->input.threads);
    cli_console_start(&args->common, (cli_progress_mode)args->progress);
    cli_console_reserve_stdout(args->json);
    cli_console_reserve_stdout(args->csv);
    cw_status st = bench_cases(args, b, err);
    cli_bench_free(b);
    free(b);
    return st;
}

const cli_command cli_bench_command = {
    .name = "bench",
    .usage = "[VOLUME...] [options]",
    .about = "Measure speed and error, also of other programs",
    .page = cli_page_bench,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .max_inputs = 64,
    .inputs = CLI_VALUES_VOLUME,
    .size = sizeof(bench_args),
    .defaults = &defaults,
    .run = run_bench,
};
