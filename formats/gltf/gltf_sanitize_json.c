/* Sanitizes JSON for tinygltf, which trusts its input: limits nesting and renames unneeded
 * keys. */
#include "core/base/status.h"
#include "formats/gltf/gltf_scene.h"

#include <string.h>

enum {
    EXTENSION_DEPTH = 4, /* {"nodes": [{"extensions": { */
    PRIMITIVE_DEPTH = 5, /* {"meshes": [{"primitives": [{ */
    MAX_DEPTH = 64,
    MAX_STRUCTURE = 32 << 20
};

/* Returns the end of a string, given the place of its first quote: behind the last one. */
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

static bool is_wanted(const char *key, size_t length, bool keeps_look)
{
    static const char *const expected[] = {
        "asset",  "scene",     "scenes",      "nodes",
        "meshes", "accessors", "bufferViews", "extensionsRequired",
        "skins"};
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++)
        if (strlen(expected[i]) == length && memcmp(key, expected[i], length) == 0)
            return true;
    static const char look[] = "materials";
    return keeps_look && length == strlen(look) && memcmp(key, look, length) == 0;
}

/* Renames a key of the outermost object, with its quotes, in the same number of bytes. */
static void rename_key(char *key, size_t size, bool keeps_look)
{
    static const char buffers[] = "\"buffers\"", instead[] = "\"extras\" ";
    if (size == strlen(buffers) && memcmp(key, buffers, size) == 0)
        memcpy(key, instead, size);
    else if (size > 2 && !is_wanted(key + 1, size - 2, keeps_look))
        memset(key + 1, '_', size - 2);
}

static bool is_number(const char *json, size_t size, size_t at)
{
    while (at < size && strchr(" \t\r\n:", json[at]) && json[at])
        at++;
    return at < size && (json[at] == '-' || (json[at] >= '0' && json[at] <= '9'));
}

/* Renames the key of a primitive's indices to "extras". This hides indices compressed by Draco,
 * which tinygltf would refuse. `end` is the place behind the key. */
static void hide_indices(char *json, size_t size, size_t at, size_t end)
{
    static const char indices[] = "\"indices\"", extras[] = "\"extras\"";
    if (end - at == strlen(indices) && memcmp(json + at, indices, end - at) == 0 &&
        is_number(json, size, end))
        memcpy(json + at, "\"extras\" ", end - at);
    else if (end - at == strlen(extras) && memcmp(json + at, extras, end - at) == 0)
        memset(json + at + 1, '_', end - at - 2);
}

/* Renames the extension of levels to CWI_GLTF_HIDDEN_LOD. tinygltf refuses a whole file for a
 * node whose levels are no list, from 2.9 on. */
static void hide_levels(char *json, size_t at, size_t end)
{
    static const char levels[] = "\"MSFT_lod\"";
    if (end - at == strlen(levels) && memcmp(json + at, levels, end - at) == 0)
        memcpy(json + at + 1, CWI_GLTF_HIDDEN_LOD, strlen(CWI_GLTF_HIDDEN_LOD));
}

cw_status cwi_gltf_blind(char *json, size_t size, bool keeps_look, cw_error *err)
{
    size_t depth = 0, structure = 0;
    for (size_t i = 0; i < size; i++) {
        if (json[i] == '"') {
            const size_t end = string_end(json, size, i);
            if (depth == 1 && is_key(json, size, end))
                rename_key(json + i, end - i, keeps_look);
            if (depth == EXTENSION_DEPTH && is_key(json, size, end))
                hide_levels(json, i, end);
            if (depth == PRIMITIVE_DEPTH && is_key(json, size, end))
                hide_indices(json, size, i, end);
            i = end - 1;
        } else {
            depth += json[i] == '{' || json[i] == '[';
            depth -= depth && (json[i] == '}' || json[i] == ']');
        }
        if (depth > MAX_DEPTH)
            return cwi_fail(err, CW_ERR_FORMAT, "the JSON nests deeper than %d", MAX_DEPTH);
        if (++structure > MAX_STRUCTURE)
            return cwi_fail(err, CW_ERR_LIMIT,
                            "the JSON has more than %d MiB beside its strings",
                            MAX_STRUCTURE >> 20);
    }
    return CW_OK;
}
