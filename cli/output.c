#include "cli/output.h"

#include "cli/quantity.h"
#include "cli/template.h"
#include "core/status.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static bool same_file(const char *a, const char *b)
{
    struct stat x, y;
    return stat(a, &x) == 0 && stat(b, &y) == 0 && x.st_dev == y.st_dev && x.st_ino == y.st_ino;
}

cw_status cli_check_output(const char *output, const char *const *inputs, size_t input_count,
                           cw_error *err)
{
    for (size_t i = 0; i < input_count; i++)
        if (same_file(output, inputs[i]))
            return cw_fail(err, CW_ERR_OUTPUT,
                           "%s: is the input; inputs are never overwritten, give another -o",
                           output);
    return CW_OK;
}

cw_status cli_check_apart(const char *a, const char *b, cw_error *err)
{
    if (strcmp(a, b) != 0 && !same_file(a, b))
        return CW_OK;
    return cw_fail(err, CW_ERR_ARGUMENT,
                   "%s and %s are the same file; each output needs its own", a, b);
}

static cw_status check_levels(const cli_numbers *levels, cw_error *err)
{
    for (size_t n = 0; n < levels->count; n++)
        for (size_t m = 0; m < n; m++)
            if (levels->value[m] == levels->value[n])
                return cw_fail(err, CW_ERR_ARGUMENT, "--iso lists %s twice",
                               cli_number_text(levels->value[n]));
    return CW_OK;
}

/* "out-{level}.glb" for the user who wrote "out.glb". */
static cw_status ask_for_level(const char *text, size_t levels, cw_error *err)
{
    const char *slash = strrchr(text, '/'), *dot = strrchr(text, '.');
    const char *end = dot && (!slash || dot > slash) ? dot : text + strlen(text);
    return cw_fail(
        err, CW_ERR_ARGUMENT,
        "--iso lists %zu levels: the output must hold {level}, as in '%.*s-{level}%s'", levels,
        (int)(end - text), text, end);
}

cw_status cli_name_outputs(cli_outputs *outputs, const char *text, const char *input,
                           const cli_numbers *levels, cw_error *err)
{
    char *stem = cli_stem(input);
    cli_part parts[] = {{.name = "stem", .value = stem}, {.name = "level"}};
    cw_status st = check_levels(levels, err);
    if (st == CW_OK && !stem)
        st = cw_fail(err, CW_ERR_NO_MEMORY, "no memory for the name of an output");
    for (size_t n = 0; n < levels->count && st == CW_OK; n++) {
        parts[1].value = cli_number_text(levels->value[n]);
        st = cli_fill_template(text, parts, 2, &outputs->path[n], err);
        outputs->count = n + 1;
    }
    if (st == CW_OK && levels->count > 1 && !parts[1].used)
        st = ask_for_level(text, levels->count, err);
    free(stem);
    return st;
}

void cli_free_outputs(cli_outputs *outputs)
{
    for (size_t n = 0; n < outputs->count; n++)
        free(outputs->path[n]);
    outputs->count = 0;
}

cw_status cli_check_outputs(const cli_outputs *outputs, const char *input,
                            const cw_write_desc *desc, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < outputs->count && st == CW_OK; n++) {
        st = cli_check_output(outputs->path[n], &input, 1, err);
        for (size_t m = 0; m < n && st == CW_OK; m++)
            st = cli_check_apart(outputs->path[m], outputs->path[n], err);
        if (st == CW_OK)
            st = cw_mesh_write_check(outputs->path[n], desc, err);
    }
    return st;
}
