/* Describes the job of an extraction in parts, and keeps the description in a folder. */
#define _GNU_SOURCE /* open_memstream */
#include "cli/extract/part_manifest.h"

#include "cli/framework/json_writer.h"
#include "cli/results/output_names.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/files/atomic_file.h"

#include <errno.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char schema[] = "cubewright-parts-1";

/* Bytes of a manifest at most. */
enum { MAX_TEXT = 1 << 16 };

void cli_free_manifest(cli_manifest *m)
{
    free(m->text);
    for (size_t n = 0; n < m->line_count; n++) {
        free(m->lines[n][0]);
        free(m->lines[n][1]);
    }
    *m = (cli_manifest){0};
}

/* Computes FNV-1a of the text. */
static uint64_t hash_text(const char *text)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (; *text; text++)
        hash = (hash ^ (unsigned char)*text) * UINT64_C(0x100000001b3);
    return hash;
}

/* Writes what tells the input from another: of a folder, its own facts alone. */
static void put_input(cli_json *j, const cli_volume *v)
{
    struct stat info = {0};
    const double dims[3] = {(double)v->view.dim[0], (double)v->view.dim[1],
                            (double)v->view.dim[2]};
    cli_json_open(j, "input", '{');
    cli_json_text(j, "path", cli_shown_path(v->path));
    cli_json_text(j, "format", v->format);
    if (stat(v->path, &info) == 0 && S_ISREG(info.st_mode)) {
        cli_json_count(j, "bytes", (size_t)info.st_size);
        cli_json_int(j, "modified", (int64_t)info.st_mtime);
    }
    cli_json_numbers(j, "dims", dims, 3);
    cli_json_text(j, "type", cw_type_name(v->view.type));
    cli_json_open(j, "affine", '[');
    for (int r = 0; r < 3; r++)
        cli_json_numbers(j, NULL, v->view.affine[r], 4);
    cli_json_close(j, ']');
    cli_json_number(j, "slope", v->view.slope);
    cli_json_number(j, "intercept", v->view.intercept);
    cli_json_close(j, '}');
}

static void put_job(cli_json *j, const cli_extract_run *run, size_t parts)
{
    cli_making making;
    cw_provenance lines[CLI_EXTRACT_PROVENANCE];
    const cli_made made = {.iso = run->args->iso.value[0]};
    const size_t count = cli_extract_provenance(run, 0, &making, lines);
    cli_json_open(j, NULL, '{');
    cli_json_text(j, "schema", schema);
    cli_json_text(j, "version", CW_VERSION);
    cli_json_count(j, "parts", parts);
    put_input(j, &run->input.volume);
    cli_json_open(j, "params", '{');
    cli_extract_put_params(j, run, &made);
    cli_json_close(j, '}');
    cli_json_open(j, "provenance", '[');
    for (size_t n = 0; n < count; n++) {
        cli_json_open(j, NULL, '[');
        cli_json_text(j, NULL, lines[n].key);
        cli_json_text(j, NULL, lines[n].value);
        cli_json_close(j, ']');
    }
    cli_json_close(j, ']');
    cli_json_close(j, '}');
}

static bool take_line(cli_manifest *m, json_t *pair)
{
    if (m->line_count == CLI_EXTRACT_PROVENANCE)
        return false;
    char **line = m->lines[m->line_count++];
    for (size_t n = 0; n < 2; n++) {
        const char *text = json_string_value(json_array_get(pair, n));
        line[n] = strdup(text ? text : "");
    }
    return line[0] && line[1] && *line[0];
}

static cw_status take_manifest(cli_manifest *m, json_t *root, cw_error *err)
{
    const char *name = json_string_value(json_object_get(root, "schema"));
    const json_int_t parts = json_integer_value(json_object_get(root, "parts"));
    json_t *lines = json_object_get(root, "provenance"), *pair;
    size_t n;
    if (!name || strcmp(name, schema) != 0)
        return cwi_fail(err, CW_ERR_FORMAT, "'schema' is '%.40s', not '%s'", name ? name : "",
                        schema);
    if (parts < 1)
        return cwi_fail(err, CW_ERR_FORMAT, "'parts' is %lld; it is 1 or more",
                        (long long)parts);
    m->parts = (size_t)parts;
    json_t *params = json_object_get(root, "params");
    m->iso = json_number_value(json_object_get(params, "iso"));
    m->open = json_is_true(json_object_get(params, "open"));
    const json_t *least = json_object_get(params, "min_volume_mm3");
    m->least_mm3 = json_number_value(least);
    if (least && !(json_is_number(least) && m->least_mm3 >= 0))
        return cwi_fail(err, CW_ERR_FORMAT, "'min_volume_mm3' is not a number of 0 or more");
    json_array_foreach(lines, n, pair) if (!take_line(m, pair)) return cwi_fail(
        err, CW_ERR_FORMAT, "'provenance' is no list of up to %d pairs of texts",
        CLI_EXTRACT_PROVENANCE);
    return CW_OK;
}

/* Takes the job, parts and provenance of the text. */
static cw_status take_text(cli_manifest *m, cw_error *err)
{
    json_error_t why;
    json_t *root = json_loads(m->text, JSON_REJECT_DUPLICATES, &why);
    m->job = hash_text(m->text);
    cw_status st = root ? take_manifest(m, root, err)
                        : cwi_fail(err, CW_ERR_FORMAT, "line %d: %s", why.line, why.text);
    json_decref(root);
    return st;
}

cw_status cli_describe_job(const cli_extract_run *run, size_t parts, cli_manifest *m,
                           cw_error *err)
{
    size_t size;
    *m = (cli_manifest){0};
    FILE *out = open_memstream(&m->text, &size);
    if (!out)
        return cwi_fail_memory(err);
    cli_json j = {.out = out, .first = true};
    put_job(&j, run, parts);
    const bool failed = ferror(out) || fputc('\n', out) == EOF;
    if (fclose(out) != 0 || failed)
        return cwi_fail_memory(err);
    return take_text(m, err);
}

static cw_status name_manifest(const char *folder, char path[CLI_FRAGMENT_PATH], cw_error *err)
{
    const int length = snprintf(path, CLI_FRAGMENT_PATH, "%s/manifest.json", folder);
    return length < CLI_FRAGMENT_PATH
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT, "the path of --manifest is too long");
}

cw_status cli_name_fragment(const char *folder, size_t part, size_t parts,
                            char path[CLI_FRAGMENT_PATH], cw_error *err)
{
    const int length =
        snprintf(path, CLI_FRAGMENT_PATH, "%s/part-%zu-of-%zu.cwpart", folder, part + 1, parts);
    return length < CLI_FRAGMENT_PATH
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT, "the path of --manifest is too long");
}

cw_status cli_check_joined_output(const char *output, const char *folder, size_t parts,
                                  cw_error *err)
{
    char path[CLI_FRAGMENT_PATH];
    const char *const inputs[] = {path};
    struct stat info;
    if (stat(output, &info) != 0) /* nothing stands there yet */
        return CW_OK;
    cw_status st = name_manifest(folder, path, err);
    if (st == CW_OK)
        st = cli_check_output(output, inputs, 1, err);
    for (size_t part = 0; part < parts && st == CW_OK; part++) {
        st = cli_name_fragment(folder, part, parts, path, err);
        if (st == CW_OK)
            st = cli_check_output(output, inputs, 1, err);
    }
    return st;
}

static cw_status read_text(const char *path, char **text, cw_error *err)
{
    struct stat info;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode)) /* reading a pipe may never end */
        return cwi_fail(err, CW_ERR_IO, "%s: it is a folder, pipe or device, not a file", path);
    FILE *file = fopen(path, "rb");
    *text = file ? calloc(1, MAX_TEXT + 1) : NULL;
    if (!file || !*text) {
        const int why = errno;
        if (file)
            fclose(file);
        return cwi_fail(err, CW_ERR_IO, "%s: %s", path, strerror(why));
    }
    const size_t size = fread(*text, 1, MAX_TEXT + 1, file);
    const bool failed = ferror(file);
    fclose(file);
    if (!failed && size <= MAX_TEXT)
        return CW_OK;
    free(*text);
    *text = NULL;
    return failed
               ? cwi_fail(err, CW_ERR_IO, "%s: it cannot be read", path)
               : cwi_fail(err, CW_ERR_FORMAT, "%s: it has more than %d bytes", path, MAX_TEXT);
}

/* Returns the first line of `there` that `here` has in another form. */
static void find_difference(const char *here, const char *there, char line[120])
{
    size_t same = 0, start = 0;
    for (; here[same] && here[same] == there[same]; same++)
        if (there[same] == '\n')
            start = same + 1;
    while (there[start] == ' ')
        start++;
    snprintf(line, 120, "%.*s", (int)strcspn(there + start, "\n"), there + start);
}

cw_status cli_settle_manifest(const char *folder, const cli_manifest *m, cw_error *err)
{
    char path[CLI_FRAGMENT_PATH], *there, line[120];
    cwi_outfile *file = NULL;
    if (mkdir(folder, 0777) != 0 && errno != EEXIST)
        return cwi_fail(err, CW_ERR_OUTPUT, "%s: %s", folder, strerror(errno));
    cw_status st = name_manifest(folder, path, err);
    if (st == CW_OK && access(path, F_OK) != 0) {
        st = cwi_outfile_open(&file, path, true, err);
        if (st == CW_OK)
            st = cwi_outfile_write(file, m->text, strlen(m->text), err);
        if (st == CW_OK)
            st = cwi_outfile_commit(&file, err);
        cwi_outfile_abort(&file);
        if (st == CW_OK || access(path, F_OK) != 0) /* else another part was faster */
            return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
        st = CW_OK;
    }
    if (st == CW_OK)
        st = read_text(path, &there, err);
    if (st != CW_OK)
        return st;
    if (strcmp(there, m->text) != 0) {
        find_difference(m->text, there, line);
        st = cwi_fail(err, CW_ERR_ARGUMENT,
                      "%s: it is of another job, where this stands: %s; another folder, or an "
                      "empty one, is needed",
                      path, line);
    }
    free(there);
    return st;
}

cw_status cli_read_manifest(const char *folder, cli_manifest *m, cw_error *err)
{
    char path[CLI_FRAGMENT_PATH];
    *m = (cli_manifest){0};
    cw_status st = name_manifest(folder, path, err);
    if (st == CW_OK)
        st = read_text(path, &m->text, err);
    if (st != CW_OK)
        return st;
    st = take_text(m, err);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}

const char *cli_count_parts(size_t parts, char text[CLI_PARTS_TEXT])
{
    snprintf(text, CLI_PARTS_TEXT, "%zu part%s", parts, parts == 1 ? "" : "s");
    return text;
}
