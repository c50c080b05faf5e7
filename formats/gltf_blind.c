/* JSON, made fit for a library that trusts it. */
#include "core/status.h"
#include "formats/gltf_scene.h"

#include <string.h>

enum { MOST_DEPTH = 64, MOST_STRUCTURE = 32 << 20 };

/* The end of a string that starts at its first quote: behind the last one. */
static size_t string_end(const char *json, size_t size, size_t at)
{
    for (at++; at < size && json[at] != '"'; at++)
        at += json[at] == '\\';
    return at < size ? at + 1 : size;
}

static bool is_key(const char *json, size_t size, size_t at)
{
    while (at < size && strchr(" \t\r\n", json[at]) && json[at])
        at++;
    return at < size && json[at] == ':';
}

static bool is_wanted(const char *key, size_t length)
{
    static const char *const wanted[] = {
        "asset",  "scene",     "scenes",      "nodes",
        "meshes", "accessors", "bufferViews", "extensionsRequired"};
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
        if (strlen(wanted[i]) == length && memcmp(key, wanted[i], length) == 0)
            return true;
    return false;
}

/* A key of the outermost object, with its quotes: in the same number of bytes. */
static void rename_key(char *key, size_t size)
{
    static const char buffers[] = "\"buffers\"", instead[] = "\"extras\" ";
    if (size == strlen(buffers) && memcmp(key, buffers, size) == 0)
        memcpy(key, instead, size);
    else if (size > 2 && !is_wanted(key + 1, size - 2))
        memset(key + 1, '_', size - 2);
}

cw_status cwi_gltf_blind(char *json, size_t size, cw_error *err)
{
    size_t depth = 0, structure = 0;
    for (size_t i = 0; i < size; i++) {
        if (json[i] == '"') {
            const size_t end = string_end(json, size, i);
            if (depth == 1 && is_key(json, size, end))
                rename_key(json + i, end - i);
            i = end - 1;
        } else {
            depth += json[i] == '{' || json[i] == '[';
            depth -= depth && (json[i] == '}' || json[i] == ']');
        }
        if (depth > MOST_DEPTH)
            return cw_fail(err, CW_ERR_FORMAT, "the JSON nests deeper than %d", MOST_DEPTH);
        if (++structure > MOST_STRUCTURE)
            return cw_fail(err, CW_ERR_LIMIT,
                           "the JSON has more than %d MiB beside its strings",
                           MOST_STRUCTURE >> 20);
    }
    return CW_OK;
}
