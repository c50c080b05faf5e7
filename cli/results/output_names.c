/* Makes the names of outputs from templates, and checks that no output is an input, another
 * output or the report. */
#define _GNU_SOURCE /* dev_t, ino_t */
#include "cli/results/output_names.h"

#include "cli/framework/name_template.h"
#include "cli/framework/quantity.h"
#include "cli/framework/standard_streams.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Identity of the file at a path. */
typedef struct identity {
    bool exists;
    dev_t device;
    ino_t inode;
} identity;

static identity identify_file(const char *path)
{
    struct stat info;
    if (stat(path, &info) != 0)
        return (identity){0};
    return (identity){true, info.st_dev, info.st_ino};
}

static bool same_identity(const identity *a, const identity *b)
{
    return a->exists && b->exists && a->device == b->device && a->inode == b->inode;
}

static bool same_file(const char *a, const char *b)
{
    const identity x = identify_file(a), y = identify_file(b);
    return same_identity(&x, &y);
}

cw_status cli_check_output(const char *output, const char *const *inputs, size_t input_count,
                           cw_error *err)
{
    for (size_t i = 0; i < input_count; i++)
        if (!cli_is_standard(output) && !cli_is_standard(inputs[i]) &&
            same_file(output, inputs[i]))
            return cwi_fail(err, CW_ERR_OUTPUT,
                            "%s: is the input; inputs are never overwritten, give another -o",
                            output);
    return CW_OK;
}

static cw_status fail_same(const char *a, const char *b, cw_error *err)
{
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "%s and %s are the same file; each output needs its own", a, b);
}

cw_status cli_check_apart(const char *a, const char *b, cw_error *err)
{
    return strcmp(a, b) != 0 && !same_file(a, b) ? CW_OK : fail_same(a, b, err);
}

static cw_status check_levels(const cli_numbers *levels, cw_error *err)
{
    for (size_t n = 0; n < levels->count; n++)
        for (size_t m = 0; m < n; m++)
            if (levels->value[m] == levels->value[n] && levels->level[m] == levels->level[n])
                return cwi_fail(err, CW_ERR_ARGUMENT, "--iso lists %s twice",
                                cli_level_text(levels->level[n], levels->value[n]));
    return CW_OK;
}

/* Where the extension of a name begins. */
static const char *end_of_name(const char *text)
{
    const char *slash = strrchr(text, '/'), *dot = strrchr(text, '.');
    return dot && (!slash || dot > slash) ? dot : text + strlen(text);
}

/* "out-{level}.glb" for the user who wrote "out.glb". */
static cw_status ask_for(const char *what, const char *text, const char *why, cw_error *err)
{
    const char *end = end_of_name(text), *width = strcmp(what, "step") == 0 ? ":04d" : "";
    if (cli_is_standard(text))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s: standard output takes one file; give -o a name that holds {%s}",
                        why, what);
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "%s: the output must hold {%s}, as in '%.*s-{%s%s}%s'", why, what,
                    (int)(end - text), text, what, width, end);
}

static cw_status reserve_names(cli_outputs *outputs, size_t count, char **stem,
                               const char *input, cw_error *err)
{
    outputs->path = calloc(count ? count : 1, sizeof *outputs->path);
    *stem = cli_stem(input);
    if (outputs->path && *stem)
        return CW_OK;
    return cwi_fail_memory(err);
}

/* The next name, of the parts as they are now. */
static cw_status add_output(cli_outputs *outputs, const char *text, cli_part *parts,
                            size_t part_count, cw_error *err)
{
    return cli_fill_template(text, parts, part_count, &outputs->path[outputs->count++], err);
}

enum { STEM, PARENT, LEVEL, STEP, PARTS };

static cw_status name_levels(cli_outputs *outputs, const char *text, const cli_moment *moment,
                             const cli_numbers *levels, cli_part parts[PARTS], cw_error *err)
{
    char number[24], *stem = cli_stem(moment->path), *parent = cli_parent(moment->path);
    cw_status st = stem && parent ? CW_OK : cwi_fail_memory(err);
    snprintf(number, sizeof number, "%zu", moment->number);
    parts[STEM].value = stem;
    parts[PARENT].value = parent;
    parts[STEP].value = number;
    for (size_t n = 0; n < levels->count && st == CW_OK; n++) {
        parts[LEVEL].value = cli_level_text(levels->level[n], levels->value[n]);
        st = add_output(outputs, text, parts, PARTS, err);
    }
    free(parent);
    free(stem);
    return st;
}

static cw_status check_told_apart(const char *text, const cli_series *series,
                                  const cli_numbers *levels, const cli_part parts[PARTS],
                                  cw_error *err)
{
    char why[64];
    snprintf(why, sizeof why, "--iso lists %zu levels", levels->count);
    if (levels->count > 1 && !parts[LEVEL].used)
        return ask_for("level", text, why, err);
    snprintf(why, sizeof why,
             series->files.count ? "%zu files are taken as the steps of a series, a mesh each"
                                 : "there are %zu steps",
             series->count);
    if (series->count > 1 && !parts[STEP].used && !(series->files.count && parts[STEM].used))
        return ask_for("step", text, why, err);
    return CW_OK;
}

cw_status cli_name_outputs(cli_outputs *outputs, const char *text, const cli_series *series,
                           const cli_numbers *levels, cw_error *err)
{
    cli_part parts[PARTS] = {[STEM] = {.name = "stem"},
                             [PARENT] = {.name = "parent"},
                             [LEVEL] = {.name = "level"},
                             [STEP] = {.name = "step", .number = true}};
    cw_status st = check_levels(levels, err);
    outputs->path = calloc(levels->count * series->count + 1, sizeof *outputs->path);
    if (st == CW_OK && !outputs->path)
        st = cwi_fail_memory(err);
    for (size_t n = 0; n < series->count && st == CW_OK; n++)
        st = name_levels(outputs, text, &series->moments[n], levels, parts, err);
    return st == CW_OK ? check_told_apart(text, series, levels, parts, err) : st;
}

/* As part of a file name: no folder, nothing hidden. */
static void to_file_name(const char *name, size_t number, char text[256])
{
    if (name)
        snprintf(text, 256, "%s", name);
    else
        snprintf(text, 256, "part%zu", number);
    for (char *c = text; *c; c++)
        if (*c == '/' || (c == text && *c == '.'))
            *c = '_';
}

cw_status cli_name_part_outputs(cli_outputs *outputs, const char *text, const char *input,
                                const cw_part *parts, size_t count, cw_error *err)
{
    char *stem = NULL, name[256], number[24], label[CW_LABEL_NUMBER] = "", layer[24] = "",
         why[64];
    char *parent = cli_parent(input);
    cw_status st = reserve_names(outputs, count, &stem, input, err);
    cli_part fields[] = {
        {.name = "stem", .value = stem},   {.name = "name", .value = name},
        {.name = "part", .value = number}, {.name = "label", .value = label, .number = true},
        {.name = "layer", .value = layer}, {.name = "parent", .value = parent}};
    const size_t field_count = count > 0 && parts[0].label ? 6 : 3;
    if (st == CW_OK && !parent)
        st = cwi_fail_memory(err);
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        to_file_name(parts[n].name, n + 1, name);
        snprintf(number, sizeof number, "%zu", n + 1);
        if (parts[n].label) {
            cw_label_number(parts[n].label, label);
            snprintf(layer, sizeof layer, "%u", parts[n].label->layer);
        }
        st = add_output(outputs, text, fields, field_count, err);
    }
    snprintf(why, sizeof why, "--split makes %zu files", count);
    if (st == CW_OK && count > 1 && !fields[1].used && !fields[2].used && !fields[3].used)
        st = ask_for("name", text, why, err);
    free(parent);
    free(stem);
    return st;
}

bool cli_is_gltf(const char *output, const char *format)
{
    const cw_format *f = cw_mesh_format(output, format);
    return f && (strcmp(f->name, "glb") == 0 || strcmp(f->name, "gltf") == 0);
}

cli_lod_files cli_lod_files_of(const char *output, const char *format)
{
    const cw_format *f = cw_mesh_format(output, format);
    return f && strcmp(f->name, "neuroglancer") == 0 ? CLI_LOD_TOGETHER
           : cli_is_gltf(output, format)             ? CLI_LOD_BOTH
                                                     : CLI_LOD_APART;
}

cw_status cli_check_lod(const cli_counts *lod, cw_error *err)
{
    for (size_t n = 0; n < lod->count; n++)
        if (!lod->n[n] || (n && lod->n[n] >= lod->n[n - 1]))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "--lod lists %zu triangles%s; each level needs at least 1, and "
                            "fewer than the one before",
                            lod->n[n], n ? " after a level with as many or fewer" : "");
    return CW_OK;
}

/* "out.glb" is "out-lod{lod}.glb"; free it with free(). */
static char *with_lod(const char *text)
{
    static const char what[] = "-lod{lod}";
    const size_t head = (size_t)(end_of_name(text) - text);
    char *name = malloc(strlen(text) + sizeof what);
    if (name)
        sprintf(name, "%.*s%s%s", (int)head, text, what, text + head);
    return name;
}

bool cli_holds_lod(const char *text)
{
    return strstr(text, "{lod}");
}

cw_status cli_name_lod_outputs(cli_outputs *outputs, const char *text, const char *input,
                               size_t levels, cli_lod_files files, cw_error *err)
{
    enum { LOD = 1, FIELDS = 3 };
    char *stem = NULL, *parent = cli_parent(input), *plain = NULL, *made = NULL,
         number[24] = "0";
    cw_status st = reserve_names(outputs, levels + 1, &stem, input, err);
    cli_part parts[FIELDS] = {{.name = "stem", .value = stem},
                              [LOD] = {.name = "lod", .value = number},
                              {.name = "parent", .value = parent}};
    if (st == CW_OK && !parent)
        st = cwi_fail_memory(err);
    if (st == CW_OK && cli_is_standard(text))
        st = cwi_fail(err, CW_ERR_ARGUMENT,
                      "--lod makes several files, and standard output takes one; give -o a "
                      "name");
    if (st == CW_OK) /* only to see whether there is a {lod} in it */
        st = cli_fill_template(text, parts, FIELDS, &plain, err);
    const bool apart = parts[LOD].used;
    if (st == CW_OK && apart && files == CLI_LOD_TOGETHER)
        st = cwi_fail(err, CW_ERR_ARGUMENT,
                      "this format holds all levels of --lod in one output; '%s' holds {lod}",
                      text);
    if (st == CW_OK && !apart && !(made = with_lod(text)))
        st = cwi_fail_memory(err);
    for (size_t n = 0; n < levels && st == CW_OK && files != CLI_LOD_TOGETHER; n++) {
        snprintf(number, sizeof number, "%zu", n);
        st = add_output(outputs, apart ? text : made, parts, FIELDS, err);
    }
    if (st == CW_OK && !apart && files != CLI_LOD_APART)
        st = add_output(outputs, text, parts, FIELDS, err);
    free(made);
    free(plain);
    free(parent);
    free(stem);
    return st;
}

cw_status cli_name_output(cli_outputs *outputs, const char *text, const char *input,
                          cw_error *err)
{
    char *stem = NULL, *parent = cli_parent(input);
    cw_status st = reserve_names(outputs, 1, &stem, input, err);
    cli_part parts[] = {{.name = "stem", .value = stem}, {.name = "parent", .value = parent}};
    if (st == CW_OK && !parent)
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = add_output(outputs, text, parts, 2, err);
    free(parent);
    free(stem);
    return st;
}

void cli_free_outputs(cli_outputs *outputs)
{
    for (size_t n = 0; n < outputs->count; n++)
        free(outputs->path[n]);
    free(outputs->path);
    *outputs = (cli_outputs){0};
}

/* Each output needs its own file, by name and by link. */
static cw_status check_all_apart(const cli_outputs *outputs, cw_error *err)
{
    cw_status st = CW_OK;
    identity *identities = calloc(outputs->count ? outputs->count : 1, sizeof *identities);
    if (!identities)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < outputs->count && st == CW_OK; n++) {
        identities[n] = identify_file(outputs->path[n]);
        for (size_t m = 0; m < n && st == CW_OK; m++)
            if (same_identity(&identities[m], &identities[n]) ||
                strcmp(outputs->path[m], outputs->path[n]) == 0)
                st = fail_same(outputs->path[m], outputs->path[n], err);
    }
    free(identities);
    return st;
}

cw_status cli_check_writable(const char *path, const cw_write_desc *desc, cw_error *err)
{
    cw_write_desc d = *desc;
    d.sink = cli_output_sink(path);
    return cw_mesh_write_check(path, &d, err);
}

cw_status cli_check_outputs(const cli_outputs *outputs, const char *const *inputs,
                            size_t input_count, const cw_write_desc *desc, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < outputs->count && st == CW_OK; n++)
        st = cli_check_output(outputs->path[n], inputs, input_count, err);
    if (st == CW_OK)
        st = check_all_apart(outputs, err);
    for (size_t n = 0; n < outputs->count && st == CW_OK; n++)
        st = cli_check_writable(outputs->path[n], desc, err);
    return st;
}
