/* Runs a command once for each of its inputs, in processes of their own. */
#define _GNU_SOURCE /* strndup */
#include "cli/framework/batch.h"

#include "cli/framework/console.h"
#include "cli/framework/json_writer.h"
#include "cli/framework/name_template.h"
#include "cli/framework/temp_folder.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <errno.h>
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* One input, and the process that works on it. */
/* Options of files beside the output, which each input has of its own. */
static const char *const beside[] = {"table", "defects", "preview"};
enum { BESIDE = sizeof beside / sizeof *beside };

typedef struct job {
    const char *input;
    char *output;         /* its name, with '*' for what is known only later; NULL: none */
    char *beside[BESIDE]; /* their names; NULL: not asked for */
    pid_t child;          /* 0: not started, or ended */
    FILE *out, *err;      /* of the child; NULL: those of this process */
    double start, seconds;
    int exit_code;
    bool is_skipped, is_started, is_ended, is_reported;
} job;

typedef struct batch_run {
    const cli_command *command;
    cli_common *args;
    cw_status (*run)(const cli_command *command, cli_common *args, cw_error *err);
    const char **inputs;
    glob_t *globs; /* own the inputs that patterns stand for */
    size_t glob_count;
    job *jobs;
    size_t count, capacity, next, reported, running, failed;
    FILE *lines;
    char *folder; /* for reports on their way into the lines; NULL: none */
} batch_run;

enum { REPORT_BYTES = 4096 };

bool cli_is_batch(const cli_batch *b)
{
    return b->is_batch || b->jobs > 0 || b->skip_existing || b->keep_going || b->json_lines;
}

/* Finds the field of an option by its name; NULL where the command does not have it. */
static void *find_field(const batch_run *r, const char *name, const cli_kind *kind)
{
    for (size_t n = 0; n < r->command->option_count; n++) {
        const cli_option *o = &r->command->options[n];
        if (o->kind == kind && strcmp(o->name, name) == 0)
            return (char *)r->args + o->offset;
    }
    return NULL;
}

/* --- inputs ------------------------------------------------------------------------------ */

static cw_status add_job(batch_run *r, const char *input, cw_error *err)
{
    if (r->count == r->capacity) {
        const size_t capacity = r->capacity ? 2 * r->capacity : 64;
        job *grown = realloc(r->jobs, capacity * sizeof *grown);
        if (!grown)
            return cwi_fail_memory(err);
        r->jobs = grown;
        r->capacity = capacity;
    }
    r->jobs[r->count++] = (job){.input = input};
    return CW_OK;
}

/* Adds the files that a pattern stands for; a file of that very name stands for itself. */
static cw_status add_input(batch_run *r, const char *input, cw_error *err)
{
    if (access(input, F_OK) == 0 || !strpbrk(input, "*?["))
        return add_job(r, input, err);
    glob_t *g = &r->globs[r->glob_count++];
    if (glob(input, 0, NULL, g) != 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s: no file matches the pattern", input);
    cw_status st = CW_OK;
    for (size_t n = 0; n < g->gl_pathc && st == CW_OK; n++)
        st = add_job(r, g->gl_pathv[n], err);
    return st;
}

static cw_status list_jobs(batch_run *r, cw_error *err)
{
    cw_status st = CW_OK;
    r->globs = calloc(r->args->input_count, sizeof *r->globs);
    if (!r->globs)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < r->args->input_count && st == CW_OK; n++)
        st = add_input(r, r->args->inputs[n], err);
    return st;
}

static bool is_stdout(const char *path)
{
    return path && strcmp(path, "-") == 0;
}

/* --- outputs ----------------------------------------------------------------------------- */

/* Writes the output's name with {stem} and {parent} filled in, and '*' for other fields. */
static char *fill_output(const char *text, const char *input)
{
    char *stem = cli_stem(input), *parent = cli_parent(input), *name = NULL;
    size_t size;
    FILE *out = stem && parent ? open_memstream(&name, &size) : NULL;
    for (const char *c = text; out && *c; c++) {
        const char *end = *c == '{' && c[1] != '{' ? strchr(c, '}') : NULL;
        if (!end)
            fputc(*c, out);
        else if (strncmp(c, "{stem}", 6) == 0)
            fputs(stem, out);
        else if (strncmp(c, "{parent}", 8) == 0)
            fputs(parent, out);
        else
            fputc('*', out);
        c = end ? end : c + (*c == '{' && c[1] == '{');
    }
    if (out)
        fclose(out);
    free(stem);
    free(parent);
    return name;
}

/* A file that a job writes. */
typedef struct written {
    const char *path;
    const job *by;
} written;

static int compare_outputs(const void *a, const void *b)
{
    return strcmp(((const written *)a)->path, ((const written *)b)->path);
}

/* Fails when two inputs would write the same file. */
static cw_status check_outputs(const batch_run *r, int which, const char *text, cw_error *err)
{
    cw_status st = CW_OK;
    written *sorted = calloc(r->count, sizeof *sorted);
    if (!sorted)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < r->count; n++)
        sorted[n] =
            (written){which < 0 ? r->jobs[n].output : r->jobs[n].beside[which], &r->jobs[n]};
    qsort(sorted, r->count, sizeof *sorted, compare_outputs);
    for (size_t n = 1; n < r->count && st == CW_OK; n++)
        if (strcmp(sorted[n - 1].path, sorted[n].path) == 0)
            st =
                cwi_fail(err, CW_ERR_ARGUMENT,
                         "%s: the output of %s and of %s would be the same file; {stem} stands "
                         "for the name of an input, {parent} for that of its folder",
                         text, sorted[n - 1].by->input, sorted[n].by->input);
    free(sorted);
    return st;
}

/* Names the files beside outputs. */
static cw_status name_beside(batch_run *r, cw_error *err)
{
    cw_status st = CW_OK;
    for (int b = 0; b < BESIDE && st == CW_OK; b++) {
        char *const *text = find_field(r, beside[b], CLI_TEXT);
        if (!text || !*text || is_stdout(*text))
            continue;
        for (size_t n = 0; n < r->count; n++) {
            r->jobs[n].beside[b] = fill_output(*text, r->jobs[n].input);
            if (!r->jobs[n].beside[b])
                return cwi_fail_memory(err);
        }
        st = check_outputs(r, b, *text, err);
    }
    return st;
}

static cw_status name_outputs(batch_run *r, cw_error *err)
{
    char *const *text = find_field(r, "output", CLI_TEXT);
    if (!text || !*text)
        return r->args->batch.skip_existing
                   ? cwi_fail(err, CW_ERR_ARGUMENT, "--skip-existing needs an output: -o FILE")
                   : CW_OK;
    for (size_t n = 0; n < r->count; n++) {
        r->jobs[n].output = fill_output(*text, r->jobs[n].input);
        if (!r->jobs[n].output)
            return cwi_fail_memory(err);
    }
    return check_outputs(r, -1, *text, err);
}

/* Returns true if all files of a job exist. */
static bool has_output(const job *j)
{
    glob_t g;
    for (int b = 0; b < BESIDE; b++)
        if (j->beside[b] && access(j->beside[b], F_OK) != 0)
            return false;
    if (access(j->output, F_OK) == 0)
        return true;
    const bool is = glob(j->output, GLOB_NOSORT, NULL, &g) == 0;
    globfree(&g);
    return is;
}

/* --- processes --------------------------------------------------------------------------- */

/* Gives a child its share of threads, unless they were stated, and of memory. */
static void share_resources(const batch_run *r)
{
    const size_t jobs = r->args->batch.jobs;
    size_t *threads = find_field(r, "threads", CLI_COUNT);
    const size_t processors = (size_t)sysconf(_SC_NPROCESSORS_ONLN);
    if (jobs > 1 && threads && *threads == 0)
        *threads = processors > jobs ? processors / jobs : 1;
    r->args->processes = jobs;
}

/* Makes the name of a job's report in the temporary folder. */
static void name_report(const batch_run *r, const job *j, char path[REPORT_BYTES])
{
    snprintf(path, REPORT_BYTES, "%s/%zu.json", r->folder, (size_t)(j - r->jobs));
}

/* Works on an input: the child's whole life. What it prints goes to files, if there are any. */
static void work_as_child(const batch_run *r, const job *j)
{
    cw_error err = {0};
    char path[REPORT_BYTES];
    const char **report = find_field(r, "json", CLI_TEXT);
    bool *prints_report = find_field(r, "json", CLI_FLAG);
    if (j->out)
        dup2(fileno(j->out), STDOUT_FILENO);
    if (j->err)
        dup2(fileno(j->err), STDERR_FILENO);
    if (is_stdout(r->args->batch.json_lines))
        dup2(STDERR_FILENO, STDOUT_FILENO);
    if (r->lines)
        name_report(r, j, path);
    if (r->lines && report)
        *report = path;
    if (r->lines && prints_report && freopen(path, "w", stdout))
        *prints_report = true;
    for (int b = 0; b < BESIDE; b++)
        if (j->beside[b])
            *(const char **)find_field(r, beside[b], CLI_TEXT) = j->beside[b];
    share_resources(r);
    r->args->inputs[0] = j->input;
    r->args->input_count = 1;
    r->args->batch = (cli_batch){0};
    const cw_status st = r->run(r->command, r->args, &err);
    fflush(NULL);
    _exit(cw_status_exit_code(st));
}

static cw_status start_job(batch_run *r, job *j, cw_error *err)
{
    const cli_batch *b = &r->args->batch;
    if (b->jobs > 1) {
        j->out = tmpfile();
        j->err = tmpfile();
    }
    if (b->jobs > 1 && (!j->out || !j->err))
        return cwi_fail(err, CW_ERR_OUTPUT, "a temporary file cannot be made: %s",
                        strerror(errno));
    fflush(NULL);
    j->start = cli_seconds();
    j->is_started = true;
    j->child = fork();
    if (j->child == 0)
        work_as_child(r, j);
    if (j->child < 0) {
        j->child = 0;
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no process for %s: %s", j->input,
                        strerror(errno));
    }
    r->running++;
    return CW_OK;
}

/* Waits until one of the children ends. */
static void wait_for_job(batch_run *r)
{
    int status;
    const pid_t child = wait(&status);
    if (child < 0 && errno == EINTR)
        return;
    for (size_t n = 0; n < r->next; n++) {
        job *j = &r->jobs[n];
        if (j->child == 0 || (child > 0 && j->child != child))
            continue;
        j->child = 0;
        j->is_ended = true;
        j->seconds = cli_seconds() - j->start;
        j->exit_code = child > 0 && WIFEXITED(status) ? WEXITSTATUS(status)
                                                      : cw_status_exit_code(CW_ERR_BACKEND);
        r->failed += j->exit_code != 0;
        r->running--;
        if (child > 0)
            return;
    }
}

/* --- results ----------------------------------------------------------------------------- */

static void copy_file(FILE *from, FILE *to)
{
    char bytes[1 << 14];
    size_t size;
    rewind(from);
    while ((size = fread(bytes, 1, sizeof bytes, from)) > 0)
        fwrite(bytes, 1, size, to);
    fflush(to);
}

/* Copies JSON without its line breaks and indentation, which are between its parts alone. */
static void copy_compact(FILE *from, FILE *to)
{
    bool is_indent = false;
    for (int c; (c = fgetc(from)) != EOF;) {
        is_indent = c == '\n' || (is_indent && c == ' ');
        if (!is_indent)
            fputc(c, to);
    }
}

/* Returns the status of an exit code: the first of the table. */
static const char *name_exit(int code)
{
    for (int status = 0; status < CW_STATUS_COUNT; status++)
        if (cw_status_exit_code((cw_status)status) == code)
            return cw_status_name((cw_status)status);
    return cw_status_name(CW_ERR_BACKEND);
}

/* Writes the line of a job, and removes its report. */
static void write_line(const batch_run *r, const job *j)
{
    char path[REPORT_BYTES], *text;
    size_t size;
    name_report(r, j, path);
    FILE *report = fopen(path, "r"), *memory = open_memstream(&text, &size);
    if (memory) {
        cli_json json = {.out = memory};
        cli_json_open(&json, NULL, '{');
        cli_json_text(&json, "input", j->input);
        cli_json_text(&json, "status", j->is_skipped ? "skipped" : name_exit(j->exit_code));
        cli_json_int(&json, "exit", j->exit_code);
        cli_json_number(&json, "seconds", rint(j->seconds * 1e3) / 1e3);
        fclose(memory);
        FILE *head = fmemopen(text, size, "r");
        if (head)
            copy_compact(head, r->lines);
        if (head)
            fclose(head);
        free(text);
    }
    if (report) {
        fputs(",\"report\": ", r->lines);
        copy_compact(report, r->lines);
        fclose(report);
        unlink(path);
    }
    fputs("}\n", r->lines);
    fflush(r->lines);
}

/* Tells of the jobs that have ended, in order. */
static void tell_jobs(batch_run *r)
{
    for (; r->reported < r->count && r->jobs[r->reported].is_ended; r->reported++) {
        job *j = &r->jobs[r->reported];
        if (j->out)
            copy_file(j->out, stdout);
        if (j->err)
            copy_file(j->err, stderr);
        if (j->is_skipped)
            cli_say("%s: skipped, for its output exists: %s", j->input, j->output);
        if (r->lines)
            write_line(r, j);
        if (j->out)
            fclose(j->out);
        if (j->err)
            fclose(j->err);
        j->out = j->err = NULL;
    }
}

static cw_status run_jobs(batch_run *r, cw_error *err)
{
    const cli_batch *b = &r->args->batch;
    const size_t jobs = b->jobs ? b->jobs : 1;
    cw_status st = CW_OK;
    while ((r->next < r->count || r->running) && st == CW_OK) {
        const bool goes_on = !cli_interrupted() && (!r->failed || b->keep_going);
        if (r->next < r->count && r->running < jobs && goes_on) {
            job *j = &r->jobs[r->next++];
            j->is_skipped = b->skip_existing && has_output(j);
            j->is_ended = j->is_skipped;
            st = j->is_skipped ? CW_OK : start_job(r, j, err);
        } else if (r->running) {
            wait_for_job(r);
        } else {
            break;
        }
        tell_jobs(r);
    }
    while (r->running)
        wait_for_job(r);
    tell_jobs(r);
    return st;
}

/* --- the batch --------------------------------------------------------------------------- */

static cw_status check_options(const batch_run *r, cw_error *err)
{
    const char *const *json = find_field(r, "json", CLI_TEXT);
    const char *lines = r->args->batch.json_lines;
    for (size_t n = 0; n < r->args->input_count; n++)
        if (lines && strcmp(lines, r->args->inputs[n]) == 0)
            return cwi_fail(err, CW_ERR_OUTPUT, "%s: is an input; inputs are never overwritten",
                            lines);
    if (json && *json)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--json is one report, and a batch makes one for each input: use "
                        "--json-lines");
    return CW_OK;
}

static cw_status open_lines(batch_run *r, cw_error *err)
{
    const char *path = r->args->batch.json_lines;
    cw_status st = path ? cli_scratch_make(&r->folder, err) : CW_OK;
    if (path && st == CW_OK)
        r->lines = is_stdout(path) ? stdout : fopen(path, "w");
    if (st != CW_OK)
        return st;
    return path && !r->lines ? cwi_fail(err, CW_ERR_OUTPUT, "%s: cannot be written: %s", path,
                                        strerror(errno))
                             : CW_OK;
}

static cw_status judge_batch(const batch_run *r, cw_error *err)
{
    size_t skipped = 0, ended = 0;
    for (size_t n = 0; n < r->count; n++) {
        skipped += r->jobs[n].is_skipped;
        ended += r->jobs[n].is_ended;
    }
    if (cli_interrupted())
        return cwi_fail(err, CW_ERR_CANCELLED, "interrupted after %zu of %zu inputs", ended,
                        r->count);
    if (r->failed)
        return cwi_fail(err, CW_ERR_BATCH, "%zu of %zu inputs failed%s", r->failed, r->count,
                        ended < r->count ? ", and the others were not begun (--keep-going)"
                                         : "");
    cli_say("%zu input%s: %zu done, %zu skipped", r->count, r->count == 1 ? "" : "s",
            ended - skipped, skipped);
    return CW_OK;
}

static void free_batch(batch_run *r)
{
    for (size_t n = 0; n < r->count; n++) {
        free(r->jobs[n].output);
        for (int b = 0; b < BESIDE; b++)
            free(r->jobs[n].beside[b]);
    }
    for (size_t n = 0; n < r->glob_count; n++)
        globfree(&r->globs[n]);
    free(r->globs);
    free(r->jobs);
    cli_scratch_remove(r->folder);
}

cw_status cli_batch_run(const cli_command *command, cli_common *args,
                        cw_status (*run)(const cli_command *command, cli_common *args,
                                         cw_error *err),
                        cw_error *err)
{
    batch_run r = {.command = command, .args = args, .run = run};
    cw_status st = check_options(&r, err);
    if (st == CW_OK)
        st = list_jobs(&r, err);
    if (st == CW_OK)
        st = name_outputs(&r, err);
    if (st == CW_OK)
        st = name_beside(&r, err);
    if (st == CW_OK)
        st = open_lines(&r, err);
    if (st == CW_OK)
        st = run_jobs(&r, err);
    if (st == CW_OK)
        st = judge_batch(&r, err);
    bool is_whole = !r.lines || !ferror(r.lines);
    if (r.lines && r.lines != stdout)
        is_whole = fclose(r.lines) == 0 && is_whole;
    if (!is_whole) {
        const cw_error why = *err;
        const bool failed = st != CW_OK;
        st = cwi_fail(err, failed ? st : CW_ERR_OUTPUT,
                      "%s%s%s: cannot be written, so the report is not whole",
                      failed ? why.message : "", failed ? "; " : "", args->batch.json_lines);
    }
    free_batch(&r);
    return st;
}
