/* Reads JSON files of up to 1 MiB, and checks their schema and keys. */
#include "viewer/settings/json.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_BYTES = 1 << 20 };

static cw_status read_bytes(FILE *file, char **bytes, size_t *size, cw_error *err)
{
    *bytes = cwi_alloc_array(MAX_BYTES + 1, 1);
    if (!*bytes)
        return cwi_fail_memory(err);
    *size = fread(*bytes, 1, MAX_BYTES + 1, file);
    if (ferror(file))
        return cwi_fail(err, CW_ERR_IO, "cannot be read: %s", strerror(errno));
    if (*size > MAX_BYTES)
        return cwi_fail(err, CW_ERR_FORMAT, "is larger than settings are: at most 1 MiB");
    return CW_OK;
}

cw_status cwi_json_read(const char *path,
                        cw_status (*parse)(const char *bytes, size_t size, void *out,
                                           cw_error *err),
                        void *out, cw_error *err)
{
    char *bytes = NULL;
    size_t size = 0;
    FILE *file = fopen(path, "rb");
    if (!file)
        return cwi_fail(err, CW_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
    cw_status st = read_bytes(file, &bytes, &size, err);
    if (st == CW_OK)
        st = parse(bytes, size, out, err);
    cwi_free(bytes);
    fclose(file);
    return st == CW_OK ? st : cwi_fail_in(err, st, path);
}

static bool is_known(const char *key, const char *const *keys)
{
    for (; *keys; keys++)
        if (strcmp(key, *keys) == 0)
            return true;
    return false;
}

/* Lists keys for an error, such as "schema, eye, target". */
static void list_keys(const char *const *keys, char *text, size_t size)
{
    size_t used = (size_t)snprintf(text, size, "schema");
    for (; *keys && used < size; keys++)
        used += (size_t)snprintf(text + used, size - used, ", %s", *keys);
}

static cw_status check_keys(json_t *root, const char *const *keys, cw_error *err)
{
    const char *key;
    json_t *value;
    char list[256];
    json_object_foreach(root, key, value)
    {
        if (strcmp(key, "schema") == 0 || is_known(key, keys))
            continue;
        list_keys(keys, list, sizeof list);
        return cwi_fail(err, CW_ERR_FORMAT, "'%.60s' is no key; there are %s", key, list);
    }
    return CW_OK;
}

static cw_status check_schema(const json_t *root, const char *schema, cw_error *err)
{
    const json_t *value = json_object_get(root, "schema");
    if (!json_is_string(value))
        return cwi_fail(err, CW_ERR_FORMAT, "'schema' was expected to be \"%s\"", schema);
    if (strcmp(json_string_value(value), schema) != 0)
        return cwi_fail(err, CW_ERR_FORMAT, "'schema' is \"%.60s\"; \"%s\" was expected",
                        json_string_value(value), schema);
    return CW_OK;
}

cw_status cwi_json_object(const char *bytes, size_t size, const char *schema,
                          const char *const *keys, json_t **root, cw_error *err)
{
    json_error_t why;
    *root = json_loadb(bytes, size, JSON_REJECT_DUPLICATES, &why);
    if (!*root)
        return cwi_fail(err, CW_ERR_FORMAT, "line %d, column %d: %s", why.line, why.column,
                        why.text);
    cw_status st = json_is_object(*root)
                       ? check_schema(*root, schema, err)
                       : cwi_fail(err, CW_ERR_FORMAT, "an object, {...}, was expected");
    if (st == CW_OK)
        st = check_keys(*root, keys, err);
    if (st != CW_OK) {
        json_decref(*root);
        *root = NULL;
    }
    return st;
}

cw_status cwi_json_number(const json_t *root, const char *key, double *value, cw_error *err)
{
    const json_t *number = json_object_get(root, key);
    if (number && !json_is_number(number))
        return cwi_fail(err, CW_ERR_FORMAT, "'%s' was expected to be a number", key);
    if (number)
        *value = json_number_value(number);
    return CW_OK;
}

/* Prints digits until the number reads back; with a point, as JSON has no -0 without one. */
static const char *print_shortest(char text[CWI_JSON_NUMBER], double value, bool single)
{
    if (value == floor(value) && fabs(value) < 1e15) {
        snprintf(text, CWI_JSON_NUMBER, "%.1f", value);
        return text;
    }
    for (int digits = 1; digits <= 17; digits++) {
        double same;
        const char *end = text;
        snprintf(text, CWI_JSON_NUMBER, "%.*g", digits, value);
        if (cwi_parse_double(&end, &same) &&
            (single ? (float)same == (float)value : same == value))
            break;
    }
    if (!strpbrk(text, ".e"))
        snprintf(text + strlen(text), 3, ".0");
    return text;
}

const char *cwi_json_double(char text[CWI_JSON_NUMBER], double value)
{
    return print_shortest(text, value, false);
}

const char *cwi_json_float(char text[CWI_JSON_NUMBER], float value)
{
    return print_shortest(text, (double)value, true);
}
