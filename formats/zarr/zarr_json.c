/* Parses the JSON documents of a Zarr store, and reads their members with checks. */
#define _GNU_SOURCE /* close */
#include "formats/zarr/zarr_json.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MAX_JSON_BYTES = 16 << 20, JSON_FACTOR = 32 };

static cw_status parse_text(cwi_zarr_json *json, const char *text, size_t size, cw_error *err)
{
    json_error_t why;
    const size_t bytes = JSON_FACTOR * size;
    if (!cwi_memory_take(bytes))
        return cwi_fail_memory(err);
    json->root = json_loadb(text, size, JSON_DECODE_INT_AS_REAL, &why);
    if (json->root)
        json->taken = bytes;
    else
        cwi_memory_give(bytes);
    if (!json->root && json_error_code(&why) == json_error_out_of_memory)
        return cwi_fail_memory(err);
    if (!json->root)
        return cwi_fail(err, CW_ERR_FORMAT, "line %d, column %d: %s", why.line, why.column,
                        why.text);
    return json_is_object(json->root)
               ? CW_OK
               : cwi_fail(err, CW_ERR_FORMAT, "an object was expected as the document");
}

static cw_status load_file(cwi_zarr_json *json, int fd, uint64_t size, cw_error *err)
{
    size_t got;
    if (size > MAX_JSON_BYTES)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "the file has %llu bytes; metadata have 16 MiB at most",
                        (unsigned long long)size);
    char *text = cwi_alloc_array((size_t)size, 1);
    if (!text)
        return cwi_fail_memory(err);
    cw_status st = cwi_input_read_at(fd, 0, text, (size_t)size, &got, err);
    if (st == CW_OK)
        st = parse_text(json, text, got, err);
    cwi_free(text);
    return st;
}

cw_status cwi_zarr_json_open(cwi_zarr_json *json, const cwi_input *in, const char *name,
                             cw_error *err)
{
    uint64_t size = 0;
    int fd;
    *json = (cwi_zarr_json){0};
    cw_status st = cwi_input_find_side(in, name, &fd, &size, err);
    if (st == CW_OK && fd >= 0) {
        st = load_file(json, fd, size, err);
        close(fd);
    }
    if (st == CW_OK)
        return CW_OK;
    cwi_zarr_json_close(json);
    return cwi_fail_in(err, st, name);
}

void cwi_zarr_json_close(cwi_zarr_json *json)
{
    json_decref(json->root);
    cwi_memory_give(json->taken);
    *json = (cwi_zarr_json){0};
}

bool cwi_zarr_has_file(const cwi_input *in, const char *name)
{
    uint64_t size;
    int fd = -1;
    if (cwi_input_find_side(in, name, &fd, &size, NULL) != CW_OK || fd < 0)
        return false;
    close(fd);
    return true;
}

const char *cwi_zarr_text(const json_t *object, const char *key)
{
    return json_string_value(json_object_get(object, key));
}

bool cwi_zarr_is_absent(const json_t *object, const char *key)
{
    const json_t *item = json_object_get(object, key);
    return !item || json_is_null(item);
}

cw_status cwi_zarr_fail(cw_error *err, const json_t *object, const char *key,
                        const char *expected)
{
    const json_t *item = json_object_get(object, key);
    char text[64] = "missing";
    if (item) {
        const size_t size =
            json_dumpb(item, text, sizeof text - 1, JSON_ENCODE_ANY | JSON_COMPACT);
        text[size < sizeof text ? size : sizeof text - 1] = '\0';
    }
    return cwi_fail(err, CW_ERR_FORMAT, "'%s' is %s; %s was expected", key, text, expected);
}

cw_status cwi_zarr_numbers(const json_t *object, const char *key, size_t count, double *out,
                           cw_error *err)
{
    const json_t *list = json_object_get(object, key);
    if (!json_is_array(list))
        return cwi_zarr_fail(err, object, key, "a list of numbers");
    if (json_array_size(list) != count)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'%s' lists %zu numbers; %zu were expected, one a dimension", key,
                        json_array_size(list), count);
    for (size_t n = 0; n < count; n++) {
        const json_t *item = json_array_get(list, n);
        if (!json_is_number(item))
            return cwi_zarr_fail(err, object, key, "a list of numbers");
        out[n] = json_number_value(item);
    }
    return CW_OK;
}

cw_status cwi_zarr_sizes(const json_t *object, const char *key, size_t count, size_t *out,
                         cw_error *err)
{
    const json_t *list = json_object_get(object, key);
    double value;
    for (size_t n = 0; n < json_array_size(list) && n < count; n++) {
        const json_t *item = json_array_get(list, n);
        value = json_is_number(item) ? json_number_value(item) : -1;
        if (!(value >= 1 && value <= 9007199254740992.0) || value != floor(value))
            return cwi_zarr_fail(err, object, key, "a list of whole numbers from 1 to 2^53");
        out[n] = (size_t)value;
    }
    if (json_array_size(list) == count)
        return CW_OK;
    if (!json_is_array(list))
        return cwi_zarr_fail(err, object, key, "a list of whole numbers from 1 to 2^53");
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'%s' lists %zu numbers; %zu were expected, one a dimension", key,
                    json_array_size(list), count);
}
