/* Lets standard input and output stand in the place of files. */
#define _GNU_SOURCE /* F_DUPFD_CLOEXEC */
#include "cli/framework/standard_streams.h"

#include "cli/framework/batch.h"
#include "cli/framework/console.h"
#include "core/base/status.h"
#include "core/files/stored_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static struct {
    cw_stored_file *input;
    uint64_t written;
    bool pipe_closed;
} streams;

bool cli_is_standard(const char *path)
{
    return path && strcmp(path, "-") == 0;
}

static const char *temporary_folder(void)
{
    const char *folder = getenv("TMPDIR");
    return folder && *folder ? folder : "/tmp";
}

const char *cli_temporary_beside(const char *output)
{
    static char path[4096];
    if (!cli_is_standard(output))
        return output;
    snprintf(path, sizeof path, "%s/-", temporary_folder());
    return path;
}

/* --- input -------------------------------------------------------------------------------- */

static cw_status read_input(void *user, void *to, size_t capacity, size_t *got, cw_error *err)
{
    (void)user;
    for (;;) {
        const ssize_t n = read(STDIN_FILENO, to, capacity);
        if (cli_interrupted())
            return cwi_fail(err, CW_ERR_CANCELLED, "interrupted");
        if (n < 0 && errno != EINTR)
            return cwi_fail(err, CW_ERR_IO, "cannot be read: %s", strerror(errno));
        *got = n > 0 ? (size_t)n : 0;
        if (n >= 0)
            return CW_OK;
    }
}

/* Keeps standard input: a file as it is, a stream in a temporary file, in memory where no folder
 * takes one. */
static cw_status keep_input(cw_error *err)
{
    struct stat info;
    const bool is_file = fstat(STDIN_FILENO, &info) == 0 && S_ISREG(info.st_mode) &&
                         lseek(STDIN_FILENO, 0, SEEK_CUR) == 0;
    const char *folder = temporary_folder();
    if (isatty(STDIN_FILENO))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "-: standard input is a terminal; a pipe or a file was expected");
    if (!is_file)
        return cw_stored_file_open(
            &(cw_byte_source){.name = "-",
                              .read = read_input,
                              .folder = access(folder, W_OK) == 0 ? folder : NULL},
            &streams.input, err);
    const int fd = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (fd < 0)
        return cwi_fail(err, CW_ERR_IO, "-: cannot be opened: %s", strerror(errno));
    cw_status st = cwi_stored_file_adopt(fd, (uint64_t)info.st_size, "-", &streams.input, err);
    if (st != CW_OK)
        close(fd);
    return st;
}

const cw_stored_file *cli_stored_input(const char *path)
{
    return cli_is_standard(path) ? streams.input : NULL;
}

const char *cli_bytes_path(const char *path)
{
    static char text[40];
    if (!cli_stored_input(path))
        return path;
    snprintf(text, sizeof text, "/proc/self/fd/%d", streams.input->fd);
    return text;
}

void cli_streams_close(void)
{
    cw_stored_file_close(streams.input);
    streams.input = NULL;
}

/* --- output ------------------------------------------------------------------------------- */

cw_status cli_fail_standard(cw_error *err)
{
    streams.pipe_closed = streams.pipe_closed || errno == EPIPE;
    return cwi_fail(err, CW_ERR_OUTPUT, "the standard output cannot be written: %s",
                    strerror(errno));
}

bool cli_pipe_is_closed(void)
{
    return streams.pipe_closed;
}

cw_status cli_write_standard(const void *bytes, size_t size, cw_error *err)
{
    const char *from = bytes;
    while (size) {
        const ssize_t n = write(STDOUT_FILENO, from, size);
        if (cli_interrupted())
            return cwi_fail(err, CW_ERR_CANCELLED, "interrupted");
        if (n < 0 && errno != EINTR)
            return cli_fail_standard(err);
        from += n > 0 ? n : 0;
        size -= n > 0 ? (size_t)n : 0;
        streams.written += n > 0 ? (uint64_t)n : 0;
    }
    return CW_OK;
}

static cw_status take_bytes(void *user, const void *bytes, size_t size, cw_error *err)
{
    (void)user;
    return cli_write_standard(bytes, size, err);
}

const cw_byte_sink *cli_output_sink(const char *path)
{
    static cw_byte_sink sink = {.write = take_bytes};
    if (!cli_is_standard(path))
        return NULL;
    sink.folder = access(temporary_folder(), W_OK) == 0 ? temporary_folder() : NULL;
    return &sink;
}

static bool find_size(const char *path, uint64_t streamed, double *bytes)
{
    struct stat info;
    *bytes = 0;
    if (cli_is_standard(path))
        *bytes = (double)streamed;
    else if (stat(path, &info) == 0 && S_ISREG(info.st_mode))
        *bytes = (double)info.st_size;
    return *bytes > 0;
}

bool cli_find_input_size(const char *path, double *bytes)
{
    return find_size(path, cw_stored_file_size(streams.input), bytes);
}

bool cli_find_output_size(const char *path, double *bytes)
{
    return find_size(path, streams.written, bytes);
}

/* --- the command line --------------------------------------------------------------------- */

static bool is_among(cli_values values, const cli_values *list, size_t count)
{
    for (size_t n = 0; n < count; n++)
        if (values == list[n])
            return true;
    return false;
}

static bool reads_files(cli_values values)
{
    static const cli_values kinds[] = {CLI_VALUES_VOLUME, CLI_VALUES_MESH, CLI_VALUES_SCENE,
                                       CLI_VALUES_STUDY};
    return is_among(values, kinds, sizeof kinds / sizeof *kinds);
}

/* Outputs that are one file of bytes. */
static bool writes_file(cli_values values)
{
    static const cli_values kinds[] = {CLI_VALUES_VOLUME_OUTPUT, CLI_VALUES_MESH_OUTPUT,
                                       CLI_VALUES_PNG};
    return is_among(values, kinds, sizeof kinds / sizeof *kinds);
}

static bool writes_text(cli_values values)
{
    static const cli_values kinds[] = {CLI_VALUES_JSON, CLI_VALUES_JSON_LINES, CLI_VALUES_CSV,
                                       CLI_VALUES_HTML};
    return is_among(values, kinds, sizeof kinds / sizeof *kinds);
}

/* Outputs that stand beside others, or name files. */
static bool needs_path(cli_values values)
{
    return values == CLI_VALUES_DEFECTS || values == CLI_VALUES_PVD;
}

static const cli_given_option *find_given(const cli_given_option *options, size_t count,
                                          const char *name)
{
    const cli_given_option *found = NULL; /* the last one counts */
    for (size_t n = 0; n < count; n++)
        if (!options[n].off && strcmp(options[n].option->name, name) == 0)
            found = &options[n];
    return found;
}

/* Returns true for an option whose last value is "-". */
static bool is_dash(const cli_given_option *o, const cli_given_option *options, size_t count)
{
    return o->option->kind == CLI_TEXT && cli_is_standard(o->value) &&
           find_given(options, count, o->option->name) == o;
}

/* Returns an option as it is typed: "-o", "--json". text: room for it */
static const char *as_typed(const cli_given_option *o, char text[40])
{
    snprintf(text, 40, o->option->letter ? "-%.1s" : "--%.30s",
             o->option->letter ? &o->option->letter : o->option->name);
    return text;
}

/* Counts the names of files to read that are "-". */
static cw_status check_inputs(const cli_command *command, const cli_common *args,
                              const cli_given_option *options, size_t *count, cw_error *err)
{
    *count = 0;
    for (size_t n = 0; n < args->input_count && reads_files(command->inputs); n++)
        *count += cli_is_standard(args->inputs[n]);
    for (size_t n = 0; n < args->given_count; n++)
        *count += reads_files(options[n].option->values) &&
                  is_dash(&options[n], options, args->given_count);
    return *count < 2 ? CW_OK
                      : cwi_fail(err, CW_ERR_ARGUMENT,
                                 "-: standard input is one file, and %zu names are '-'; a file "
                                 "of that name is './-'",
                                 *count);
}

/* Returns true for formats that are text in any case. */
static bool is_text_format(const char *name)
{
    static const char *const names[] = {"obj", "off", "gltf", "gifti"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
        if (strcmp(name, names[n]) == 0)
            return true;
    return false;
}

/* Checks an option whose file goes to standard output. */
static cw_status check_bytes(const cli_given_option *o, const cli_given_option *options,
                             size_t count, cw_error *err)
{
    const cli_given_option *format = find_given(options, count, "format");
    const bool is_picture = o->option->values == CLI_VALUES_PNG;
    char name[40];
    if (!is_picture && !format)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s -: standard output has no extension that tells the format: "
                        "--format names it, such as %s",
                        as_typed(o, name),
                        o->option->values == CLI_VALUES_MESH_OUTPUT ? "stl, ply or glb"
                                                                    : "nrrd or nifti");
    const bool is_text =
        !is_picture && (is_text_format(format->value) || find_given(options, count, "ascii"));
    if (fcntl(STDOUT_FILENO, F_GETFD) < 0)
        return cwi_fail(err, CW_ERR_OUTPUT, "%s -: standard output is closed",
                        as_typed(o, name));
    if (isatty(STDOUT_FILENO) && !is_text)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s -: standard output is a terminal, and %s is binary; a pipe or a "
                        "file was expected",
                        as_typed(o, name), is_picture ? "PNG" : format->value);
    return CW_OK;
}

/* Finds the option, if any, whose file goes to standard output. */
static cw_status check_outputs(const cli_given_option *options, size_t count,
                               const cli_given_option **found, cw_error *err)
{
    const cli_given_option *file = NULL, *text = NULL;
    char first[40], second[40];
    for (size_t n = 0; n < count; n++) {
        const cli_given_option *o = &options[n];
        if (!is_dash(o, options, count))
            continue;
        if (needs_path(o->option->values))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "%s -: needs a file; standard output is for -o and --json",
                            as_typed(o, first));
        if (writes_file(o->option->values) && file)
            text = o;
        else if (writes_file(o->option->values))
            file = o;
        else if (writes_text(o->option->values))
            text = o;
    }
    *found = file;
    if (file && text)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s - and %s -: only one of them can use the standard output",
                        as_typed(file, first), as_typed(text, second));
    return file ? check_bytes(file, options, count, err) : CW_OK;
}

cw_status cli_streams_open(const cli_command *command, const cli_common *args,
                           const cli_given_option *options, cw_error *err)
{
    size_t inputs;
    const cli_given_option *output = NULL;
    cw_status st = check_inputs(command, args, options, &inputs, err);
    if (st == CW_OK)
        st = check_outputs(options, args->given_count, &output, err);
    if (st != CW_OK)
        return st;
    if (cli_is_batch(&args->batch) && (inputs || output))
        return cwi_fail(err, CW_ERR_ARGUMENT, "-: --batch is for files, and standard %s is one",
                        inputs ? "input" : "output");
    if (output)
        cli_console_reserve_stdout("-");
    return inputs ? keep_input(err) : CW_OK;
}
