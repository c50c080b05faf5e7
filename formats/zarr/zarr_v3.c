/* Reads the metadata of an array in version 3 of Zarr: zarr.json and its codecs. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/volume/voxel_source.h"
#include "formats/zarr/zarr_array.h"

#include <stdio.h>
#include <string.h>

/* --- type, grid and keys ------------------------------------------------------------------ */

/* Reads a name of a type, such as "uint16". */
static cw_status read_data_type(const json_t *meta, cwi_zarr_array *array, cw_error *err)
{
    static const struct {
        const char *name;
        char kind;
        size_t bytes;
    } types[] = {
        {"bool", 'b', 1},   {"int8", 'i', 1},    {"uint8", 'u', 1},   {"int16", 'i', 2},
        {"uint16", 'u', 2}, {"int32", 'i', 4},   {"uint32", 'u', 4},  {"int64", 'i', 8},
        {"uint64", 'u', 8}, {"float32", 'f', 4}, {"float64", 'f', 8}, {"float16", 'f', 2},
    };
    const char *text = cwi_zarr_text(meta, "data_type");
    if (!text)
        return cwi_zarr_fail(err, meta, "data_type", "a type such as \"uint16\"");
    snprintf(array->type_name, sizeof array->type_name, "%s", text);
    for (size_t n = 0; n < sizeof types / sizeof *types; n++)
        if (strcmp(text, types[n].name) == 0 &&
            cwi_zarr_set_type(array, types[n].kind, types[n].bytes))
            return CW_OK;
    return cwi_fail_type(err, "data_type", text);
}

/* Returns the configuration of an extension, which may be missing. */
static const json_t *find_configuration(const json_t *extension)
{
    return json_object_get(extension, "configuration");
}

/* Returns the name of an extension: an object with a name, or the name by itself. */
static const char *find_name(const json_t *extension)
{
    const char *name = cwi_zarr_text(extension, "name");
    return name ? name : json_string_value(extension);
}

static cw_status read_grid(const json_t *meta, cwi_zarr_array *array, cw_error *err)
{
    const json_t *grid = json_object_get(meta, "chunk_grid");
    const char *name = find_name(grid);
    if (!name || strcmp(name, "regular") != 0)
        return cwi_zarr_fail(err, meta, "chunk_grid", "an object named \"regular\"");
    return cwi_zarr_sizes(find_configuration(grid), "chunk_shape", array->rank, array->chunk,
                          err);
}

static cw_status read_key_encoding(const json_t *meta, cwi_zarr_array *array, cw_error *err)
{
    const json_t *encoding = json_object_get(meta, "chunk_key_encoding");
    const json_t *configuration = find_configuration(encoding);
    const char *name = find_name(encoding), *text = cwi_zarr_text(configuration, "separator");
    const bool is_default = name && strcmp(name, "default") == 0;
    if (!is_default && !(name && strcmp(name, "v2") == 0))
        return cwi_zarr_fail(err, meta, "chunk_key_encoding",
                             "an object named \"default\" or \"v2\"");
    array->has_prefix = is_default;
    array->separator = is_default ? '/' : '.';
    if (cwi_zarr_is_absent(configuration, "separator"))
        return CW_OK;
    if (!text || (strcmp(text, ".") != 0 && strcmp(text, "/") != 0))
        return cwi_zarr_fail(err, configuration, "separator", "\".\" or \"/\"");
    array->separator = text[0];
    return CW_OK;
}

/* --- codecs ------------------------------------------------------------------------------- */

/* Reads a permutation: a list, or "C" and "F" as earlier drafts had it. */
static cw_status read_permutation(const json_t *configuration, size_t rank,
                                  size_t permutation[CWI_ZARR_RANK], cw_error *err)
{
    const char *text = cwi_zarr_text(configuration, "order");
    double numbers[CWI_ZARR_RANK];
    unsigned found = 0;
    if (text && (strcmp(text, "C") == 0 || strcmp(text, "F") == 0)) {
        for (size_t d = 0; d < rank; d++)
            permutation[d] = text[0] == 'F' ? rank - 1 - d : d;
        return CW_OK;
    }
    cw_status st = cwi_zarr_numbers(configuration, "order", rank, numbers, err);
    for (size_t d = 0; st == CW_OK && d < rank; d++) {
        const bool is_axis = numbers[d] >= 0 && numbers[d] < (double)rank;
        permutation[d] = is_axis ? (size_t)numbers[d] : 0;
        found |= is_axis && numbers[d] == (double)permutation[d] ? 1U << permutation[d] : 0;
    }
    if (st == CW_OK && found != (1U << rank) - 1)
        return cwi_zarr_fail(err, configuration, "order", "each dimension once, from 0,");
    return st;
}

/* Changes an order of dimensions by a transposition. */
static cw_status apply_transpose(const json_t *configuration, size_t rank,
                                 size_t order[CWI_ZARR_RANK], cw_error *err)
{
    size_t permutation[CWI_ZARR_RANK], before[CWI_ZARR_RANK];
    cw_status st = read_permutation(configuration, rank, permutation, err);
    memcpy(before, order, sizeof before);
    for (size_t d = 0; st == CW_OK && d < rank; d++)
        order[d] = before[permutation[d]];
    return st;
}

static cw_status read_endian(const json_t *configuration, size_t size, cwi_zarr_chain *chain,
                             cw_error *err)
{
    const char *text = cwi_zarr_text(configuration, "endian");
    if (!text && size == 1)
        return CW_OK;
    chain->big_endian = text && strcmp(text, "big") == 0;
    return chain->big_endian || (text && strcmp(text, "little") == 0)
               ? CW_OK
               : cwi_zarr_fail(err, configuration, "endian", "\"little\" or \"big\"");
}

static cw_status read_codecs(const json_t *object, const char *key, cwi_zarr_array *array,
                             cw_error *err);

/* Reads the codecs of a shard's index, whose size must be known before it is read. */
static cw_status read_index_codecs(const json_t *configuration, cwi_zarr_chain *chain,
                                   cw_error *err)
{
    const json_t *list = json_object_get(configuration, "index_codecs");
    cw_status st = CW_OK;
    if (json_array_size(list) < 1)
        return cwi_zarr_fail(err, configuration, "index_codecs", "a list of codecs");
    for (size_t n = 0; st == CW_OK && n < json_array_size(list); n++) {
        const json_t *codec = json_array_get(list, n);
        const char *name = find_name(codec);
        if (n == 0 && name && strcmp(name, "bytes") == 0)
            st = read_endian(find_configuration(codec), 8, chain, err);
        else if (n > 0 && name && strcmp(name, "crc32c") == 0)
            st = cwi_zarr_add_codec(chain, "index_codecs", name, err);
        else
            st = cwi_zarr_fail(err, configuration, "index_codecs",
                               "\"bytes\", perhaps with \"crc32c\" behind it,");
    }
    return st;
}

static cw_status read_location(const json_t *configuration, cwi_zarr_array *array,
                               cw_error *err)
{
    const char *text = cwi_zarr_text(configuration, "index_location");
    array->index_at_start = text && strcmp(text, "start") == 0;
    return cwi_zarr_is_absent(configuration, "index_location") || array->index_at_start ||
                   (text && strcmp(text, "end") == 0)
               ? CW_OK
               : cwi_zarr_fail(err, configuration, "index_location", "\"start\" or \"end\"");
}

/* Reads the inner chunks of shards; a shard must hold whole ones. */
static cw_status read_inner(const json_t *configuration, cwi_zarr_array *array, cw_error *err)
{
    size_t sizes[CWI_ZARR_RANK], bytes;
    cw_status st = cwi_zarr_sizes(configuration, "chunk_shape", array->rank, sizes, err);
    array->shard_count = 1;
    for (size_t d = 0; st == CW_OK && d < array->rank; d++) {
        const size_t dimension = array->order[d];
        if (array->chunk[dimension] % sizes[d])
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'chunk_shape' of the inner chunks is %zu at %zu; a divisor of the "
                            "shard's %zu was expected",
                            sizes[d], d, array->chunk[dimension]);
        array->inner[dimension] = sizes[d];
        if (!cwi_size_mul(array->shard_count, array->chunk[dimension] / sizes[d],
                          &array->shard_count))
            array->shard_count = SIZE_MAX / 32;
    }
    if (st == CW_OK && (!cwi_size_mul(array->shard_count, 16, &bytes) || bytes > INT32_MAX))
        return cwi_fail(err, CW_ERR_LIMIT,
                        "'chunk_shape' asks for %zu inner chunks of a shard; at most 2^27 are "
                        "read",
                        array->shard_count);
    memcpy(array->shard_order, array->order, sizeof array->shard_order);
    return st;
}

static cw_status read_sharding(const json_t *configuration, cwi_zarr_array *array,
                               cw_error *err)
{
    if (array->is_sharded)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'codecs' puts shards into shards, which are not read");
    array->is_sharded = true;
    cw_status st = read_inner(configuration, array, err);
    if (st == CW_OK)
        st = read_index_codecs(configuration, &array->index_chain, err);
    if (st == CW_OK)
        st = read_location(configuration, array, err);
    return st == CW_OK ? read_codecs(configuration, "codecs", array, err) : st;
}

/* Reads codecs: transpositions, then one that makes bytes, then those of bytes. */
static cw_status read_codecs(const json_t *object, const char *key, cwi_zarr_array *array,
                             cw_error *err)
{
    const json_t *list = json_object_get(object, key);
    bool has_bytes = false, has_shards = false;
    cw_status st = CW_OK;
    if (json_array_size(list) < 1)
        return cwi_zarr_fail(err, object, key, "a list of codecs");
    for (size_t n = 0; st == CW_OK && n < json_array_size(list); n++) {
        const json_t *codec = json_array_get(list, n), *configuration;
        const char *name = find_name(codec);
        configuration = find_configuration(codec);
        if (!name)
            return cwi_zarr_fail(err, object, key, "a list of objects with a 'name'");
        if (has_shards)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'%s' names '%.40s' behind shards, which are read only as they are",
                            key, name);
        if (!has_bytes && strcmp(name, "transpose") == 0) {
            st = apply_transpose(configuration, array->rank, array->order, err);
        } else if (!has_bytes && (strcmp(name, "bytes") == 0 || strcmp(name, "endian") == 0)) {
            st = read_endian(configuration, array->stored_bytes, &array->chain, err);
            has_bytes = true;
        } else if (!has_bytes && strcmp(name, "sharding_indexed") == 0) {
            st = read_sharding(configuration, array, err);
            has_bytes = has_shards = true;
        } else if (has_bytes) {
            st = cwi_zarr_add_codec(&array->chain, key, name, err);
        } else {
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'%s' names '%.40s'; 'transpose', 'bytes' or 'sharding_indexed' "
                            "was expected first",
                            key, name);
        }
    }
    if (st == CW_OK && !has_bytes)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'%s' has no codec that makes bytes; 'bytes' was expected", key);
    return st;
}

/* Refuses storage transformers. No other one has been defined. */
static cw_status refuse_transformers(const json_t *meta, cw_error *err)
{
    return json_array_size(json_object_get(meta, "storage_transformers")) == 0
               ? CW_OK
               : cwi_zarr_fail(err, meta, "storage_transformers", "an empty list");
}

cw_status cwi_zarr_parse_v3(const json_t *meta, cwi_zarr_array *array, cw_error *err)
{
    if (json_number_value(json_object_get(meta, "zarr_format")) != 3)
        return cwi_zarr_fail(err, meta, "zarr_format", "3");
    cw_status st = cwi_zarr_set_shape(meta, array, err);
    if (st == CW_OK)
        st = read_data_type(meta, array, err);
    if (st == CW_OK)
        st = read_grid(meta, array, err);
    if (st == CW_OK)
        st = read_key_encoding(meta, array, err);
    memcpy(array->inner, array->chunk, sizeof array->inner);
    for (size_t d = 0; d < array->rank; d++)
        array->order[d] = d;
    if (st == CW_OK)
        st = read_codecs(meta, "codecs", array, err);
    if (st == CW_OK)
        st = refuse_transformers(meta, err);
    if (st == CW_OK)
        st = cwi_zarr_set_fill(meta, array, err);
    cwi_zarr_set_names(array, json_object_get(meta, "dimension_names"));
    return st == CW_OK ? cwi_zarr_set_chunk_bytes(array, "chunk_shape", err) : st;
}
