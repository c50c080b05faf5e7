/* Fills the parts in braces of an output's name, such as {stem} and {step:04d}. */
#define _GNU_SOURCE /* strndup */
#include "cli/framework/name_template.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static cw_status unknown_part(const char *text, const char *name, size_t length,
                              const cli_part *parts, size_t part_count, cw_error *err)
{
    char names[128] = "";
    size_t used = 0;
    for (size_t p = 0; p < part_count && used < sizeof names; p++)
        used += (size_t)snprintf(names + used, sizeof names - used, "%s{%s}", p ? ", " : "",
                                 parts[p].name);
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "%s: {%.*s} is unknown; known are %s, and {{ for a brace", text,
                    (int)length, name, names);
}

/* Up to the brace: nothing, or ":04d", as many digits as that; -1 for anything else. */
static int width_of(const char *text, bool number)
{
    int width, used = 0;
    if (*text == '}')
        return 0;
    const bool read = sscanf(text, ":%2dd%n", &width, &used) == 1 && text[1] == '0';
    return number && read && used > 0 && text[used] == '}' ? width : -1;
}

static cw_status put_value(FILE *out, const char *text, const char *width, cli_part *part,
                           cw_error *err)
{
    const int digits = width_of(width, part->number);
    if (digits < 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s: after {%s a } was expected%s", text,
                        part->name, part->number ? ", or a width as in {step:04d}" : "");
    for (int length = (int)strlen(part->value); length < digits; length++)
        fputc('0', out);
    fputs(part->value, out);
    part->used = true;
    return CW_OK;
}

static cw_status put_part(FILE *out, const char *text, const char *name, size_t length,
                          cli_part *parts, size_t part_count, cw_error *err)
{
    const char *colon = memchr(name, ':', length);
    const size_t bare = colon ? (size_t)(colon - name) : length;
    for (size_t p = 0; p < part_count; p++)
        if (strlen(parts[p].name) == bare && strncmp(parts[p].name, name, bare) == 0)
            return put_value(out, text, name + bare, &parts[p], err);
    return unknown_part(text, name, length, parts, part_count, err);
}

static cw_status fill_template(FILE *out, const char *text, cli_part *parts, size_t part_count,
                               cw_error *err)
{
    cw_status st = CW_OK;
    for (const char *c = text; *c && st == CW_OK; c++) {
        if (*c != '{') {
            fputc(*c, out);
        } else if (c[1] == '{') {
            fputc(*c++, out);
        } else {
            const char *end = strchr(c, '}');
            if (!end)
                return cwi_fail(err, CW_ERR_ARGUMENT,
                                "%s: '%s' has no closing brace; {{ stands for a brace", text,
                                c);
            st = put_part(out, text, c + 1, (size_t)(end - c - 1), parts, part_count, err);
            c = end;
        }
    }
    return st;
}

cw_status cli_fill_template(const char *text, cli_part *parts, size_t part_count, char **out,
                            cw_error *err)
{
    size_t size;
    FILE *stream = cwi_text_open(out, &size);
    cw_status st = stream ? fill_template(stream, text, parts, part_count, err) : CW_OK;
    if (!cwi_text_close(stream, out) && st == CW_OK)
        st = cwi_fail_memory(err);
    if (st != CW_OK) {
        free(*out);
        *out = NULL;
    }
    return st;
}

/* The end of a path without the slashes behind a folder's name. */
static const char *end_of_path(const char *path)
{
    const char *end = path + strlen(path);
    while (end > path + 1 && end[-1] == '/')
        end--;
    return end;
}

/* Where the last name of a path begins. */
static const char *last_name(const char *path)
{
    const char *name = end_of_path(path);
    while (name > path && name[-1] != '/')
        name--;
    return name;
}

char *cli_stem(const char *path)
{
    if (strcmp(path, "-") == 0)
        return strdup("stdin");
    const char *name = last_name(path);
    size_t length = (size_t)(end_of_path(path) - name);
    if (length > 3 && strncasecmp(name + length - 3, ".gz", 3) == 0)
        length -= 3;
    for (size_t dot = length; dot > 1; dot--)
        if (name[dot - 1] == '.')
            return strndup(name, dot - 1);
    return strndup(name, length);
}

char *cli_parent(const char *path)
{
    const char *end = last_name(path);
    while (end > path && end[-1] == '/')
        end--;
    const char *start = end;
    while (start > path && start[-1] != '/')
        start--;
    return end > start ? strndup(start, (size_t)(end - start)) : strdup(".");
}
