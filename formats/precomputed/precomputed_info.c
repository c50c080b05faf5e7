/* Reads `info`: scales, types, places, and how chunks are stored. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/precomputed/precomputed.h"
#include "formats/volume/voxel_source.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { SPACE = 3, MAX_SHIFT = 64, MAX_MINISHARD_BITS = 32 };
static const double MM_PER_NM = 1e-6, MAX_WHOLE = 9007199254740992.0;
static const char TYPE[] = "neuroglancer_multiscale_volume";

static const cwi_zarr_words words = {.file = CWI_PRECOMPUTED_FILE,
                                     .attributes = CWI_PRECOMPUTED_FILE,
                                     .type = "data_type",
                                     .shape = "size",
                                     .frame = "resolution",
                                     .at_root = true};

/* --- nodes -------------------------------------------------------------------------------- */

/* Puts the number of a scale in front of a message. */
static cw_status fail_in_scale(const cwi_zarr_node *node, cw_status status, cw_error *err)
{
    const json_t *scales = json_object_get(node->meta.root, "scales");
    char subject[40];
    for (size_t n = 0; n < json_array_size(scales); n++)
        if (json_array_get(scales, n) == node->scale) {
            snprintf(subject, sizeof subject, "scales[%zu]", n);
            return cwi_fail_in(err, status, subject);
        }
    return status;
}

/* Refuses what is no volume: meshes, skeletons, tables. */
static cw_status check_document(const json_t *root, cw_error *err)
{
    const char *type = cwi_zarr_text(root, "@type");
    if (type && strncmp(type, "neuroglancer_", 13) == 0 && strcmp(type, TYPE) != 0)
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "'@type' is \"%.60s\"%s; \"%s\" was expected: name the folder of a volume", type,
            strstr(type, "mesh") || strstr(type, "multilod") ? ", which is a mesh and no volume"
                                                             : "",
            TYPE);
    if (type && strcmp(type, TYPE) != 0)
        return cwi_zarr_fail(err, root, "@type", "\"neuroglancer_multiscale_volume\"");
    const size_t count = json_array_size(json_object_get(root, "scales"));
    if (count < 1)
        return cwi_zarr_fail(err, root, "scales", "a list of scales");
    return count <= CWI_ZARR_LEVELS
               ? CW_OK
               : cwi_fail(err, CW_ERR_LIMIT, "'scales' lists %zu; at most %d are read", count,
                          CWI_ZARR_LEVELS);
}

cw_status cwi_precomputed_open_node(cwi_zarr_node *node, const cwi_input *in, const char *path,
                                    cw_error *err)
{
    *node = (cwi_zarr_node){.words = &words};
    cw_status st = cwi_zarr_join("", path, node->path, err);
    if (st == CW_OK)
        st = cwi_zarr_json_open(&node->meta, in, CWI_PRECOMPUTED_FILE, err);
    if (st != CW_OK || !node->meta.root)
        return st;
    st = check_document(node->meta.root, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, CWI_PRECOMPUTED_FILE);
    const json_t *scales = json_object_get(node->meta.root, "scales");
    if (!*node->path) {
        node->kind = CWI_ZARR_IS_GROUP;
        node->levels = json_array_size(scales);
    }
    for (size_t n = 0; *node->path && n < json_array_size(scales) && !node->scale; n++) {
        const char *key = cwi_zarr_text(json_array_get(scales, n), "key");
        if (key && strcmp(key, node->path) == 0) {
            node->scale = json_array_get(scales, n);
            node->kind = CWI_ZARR_IS_ARRAY;
        }
    }
    return CW_OK;
}

/* --- storage ------------------------------------------------------------------------------ */

/* Reads a list of three numbers. */
static cw_status read_three(const json_t *object, const char *key, double out[SPACE],
                            cw_error *err)
{
    const json_t *list = json_object_get(object, key);
    if (json_array_size(list) != SPACE)
        return cwi_zarr_fail(err, object, key, "a list of three numbers, x, y, z,");
    return cwi_zarr_numbers(object, key, SPACE, out, err);
}

static cw_status read_bits(const json_t *sharding, const char *key, unsigned max,
                           unsigned *bits, cw_error *err)
{
    const json_t *item = json_object_get(sharding, key);
    const double value = json_is_number(item) ? json_number_value(item) : -1;
    char expected[48];
    *bits = 0;
    if (value >= 0 && value <= max && value == floor(value)) {
        *bits = (unsigned)value;
        return CW_OK;
    }
    snprintf(expected, sizeof expected, "a whole number from 0 to %u", max);
    return cwi_zarr_fail(err, sharding, key, expected);
}

static cw_status read_gzip(const json_t *sharding, const char *key, bool *is_gzip,
                           cw_error *err)
{
    const char *text = cwi_zarr_text(sharding, key);
    *is_gzip = text && strcmp(text, "gzip") == 0;
    return cwi_zarr_is_absent(sharding, key) || *is_gzip || (text && strcmp(text, "raw") == 0)
               ? CW_OK
               : cwi_zarr_fail(err, sharding, key, "\"raw\" or \"gzip\"");
}

static cw_status read_sharding(const json_t *sharding, cwi_chunk_storage *s, cw_error *err)
{
    const char *type = cwi_zarr_text(sharding, "@type"),
               *hash = cwi_zarr_text(sharding, "hash");
    s->is_sharded = true;
    if (!type || strcmp(type, "neuroglancer_uint64_sharded_v1") != 0)
        return cwi_zarr_fail(err, sharding, "@type", "\"neuroglancer_uint64_sharded_v1\"");
    s->is_hashed = hash && strcmp(hash, "murmurhash3_x86_128") == 0;
    if (!s->is_hashed && !(hash && strcmp(hash, "identity") == 0))
        return cwi_zarr_fail(err, sharding, "hash", "\"identity\" or \"murmurhash3_x86_128\"");
    cw_status st = read_bits(sharding, "preshift_bits", MAX_SHIFT, &s->preshift_bits, err);
    if (st == CW_OK)
        st = read_bits(sharding, "minishard_bits", MAX_MINISHARD_BITS, &s->minishard_bits, err);
    if (st == CW_OK)
        st = read_bits(sharding, "shard_bits", MAX_SHIFT - s->minishard_bits, &s->shard_bits,
                       err);
    if (st == CW_OK)
        st = read_gzip(sharding, "minishard_index_encoding", &s->index_is_gzip, err);
    return st == CW_OK ? read_gzip(sharding, "data_encoding", &s->data_is_gzip, err) : st;
}

static cw_status read_encoding(const json_t *scale, cwi_chunk_storage *s, cw_error *err)
{
    const char *text = cwi_zarr_text(scale, "encoding");
    s->has_blocks = text && strcasecmp(text, "compressed_segmentation") == 0;
    if (s->has_blocks)
        return cwi_zarr_sizes(scale, "compressed_segmentation_block_size", SPACE, s->block,
                              err);
    return text && strcasecmp(text, "raw") == 0
               ? CW_OK
               : cwi_zarr_fail(err, scale, "encoding",
                               "\"raw\" or \"compressed_segmentation\"");
}

cw_status cwi_precomputed_storage(const json_t *scale, cwi_chunk_storage *s, cw_error *err)
{
    double offset[SPACE] = {0};
    *s = (cwi_chunk_storage){0};
    cw_status st = read_encoding(scale, s, err);
    if (st == CW_OK && !cwi_zarr_is_absent(scale, "voxel_offset"))
        st = read_three(scale, "voxel_offset", offset, err);
    for (int a = 0; st == CW_OK && a < SPACE; a++) {
        if (!(fabs(offset[a]) <= MAX_WHOLE) || offset[a] != floor(offset[a]))
            return cwi_zarr_fail(err, scale, "voxel_offset", "a list of three whole numbers");
        s->offset[a] = (int64_t)offset[a];
    }
    if (st == CW_OK && !cwi_zarr_is_absent(scale, "sharding"))
        if ((st = read_sharding(json_object_get(scale, "sharding"), s, err)) != CW_OK)
            return cwi_fail_in(err, st, "sharding");
    return st;
}

/* --- arrays ------------------------------------------------------------------------------- */

static cw_status read_type(const json_t *root, cwi_zarr_array *array, cw_error *err)
{
    static const struct {
        const char *name;
        char kind;
        size_t bytes;
    } types[] = {{"uint8", 'u', 1},  {"int8", 'i', 1},   {"uint16", 'u', 2},
                 {"int16", 'i', 2},  {"uint32", 'u', 4}, {"int32", 'i', 4},
                 {"uint64", 'u', 8}, {"int64", 'i', 8},  {"float32", 'f', 4}};
    const char *text = cwi_zarr_text(root, "data_type");
    if (!text)
        return cwi_zarr_fail(err, root, "data_type", "a type such as \"uint16\"");
    snprintf(array->type_name, sizeof array->type_name, "%s", text);
    for (size_t n = 0; n < sizeof types / sizeof *types; n++)
        if (strcasecmp(text, types[n].name) == 0 &&
            cwi_zarr_set_type(array, types[n].kind, types[n].bytes))
            return CW_OK;
    return cwi_fail_type(err, "data_type", text);
}

/* Reads the number of channels, which are a dimension of their own if there are several. */
static cw_status read_channels(const json_t *root, cwi_zarr_array *array, cw_error *err)
{
    const json_t *item = json_object_get(root, "num_channels");
    const double value = json_is_number(item) ? json_number_value(item) : -1;
    if (!(value >= 1 && value <= MAX_WHOLE) || value != floor(value))
        return cwi_zarr_fail(err, root, "num_channels", "a whole number from 1");
    array->rank = value > 1 ? SPACE + 1 : SPACE;
    array->shape[SPACE] = array->chunk[SPACE] = (size_t)value;
    return CW_OK;
}

/* Reads sizes of the volume and of its chunks; all kinds of chunks hold all voxels, and the first
 * is taken. */
static cw_status read_sizes(const json_t *scale, cwi_zarr_array *array, cw_error *err)
{
    const json_t *chunks = json_object_get(scale, "chunk_sizes");
    cw_status st = cwi_zarr_sizes(scale, "size", SPACE, array->shape, err);
    for (size_t a = 0; st == CW_OK && a < SPACE; a++) {
        const json_t *item = json_array_get(json_array_get(chunks, 0), a);
        const double value = json_is_number(item) ? json_number_value(item) : -1;
        if (!(value >= 1 && value <= MAX_WHOLE) || value != floor(value) ||
            json_array_size(json_array_get(chunks, 0)) != SPACE)
            return cwi_zarr_fail(err, scale, "chunk_sizes",
                                 "a list with three whole numbers from 1");
        array->chunk[a] = (size_t)value;
    }
    return st;
}

static cw_status read_scale(const cwi_zarr_node *node, cwi_zarr_array *array, cw_error *err)
{
    cwi_chunk_storage storage;
    cw_status st = read_sizes(node->scale, array, err);
    if (st == CW_OK)
        st = cwi_precomputed_storage(node->scale, &storage, err);
    for (size_t d = 0; st == CW_OK && d < array->rank; d++) {
        array->order[d] = array->rank - 1 - d;
        array->inner[d] = array->chunk[d] < array->shape[d] ? array->chunk[d] : array->shape[d];
    }
    if (st == CW_OK && storage.has_blocks &&
        (array->stored_bytes < 4 || array->is_signed || array->type == CW_F32))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "'encoding' is \"compressed_segmentation\" and 'data_type' %s; uint32 or "
            "uint64 was expected with it",
            array->type_name);
    if (st == CW_OK)
        st = cwi_zarr_set_chunk_bytes(array, "chunk_sizes", err);
    if (st == CW_OK && array->chunk_bytes > INT32_MAX)
        return cwi_fail(
            err, CW_ERR_LIMIT,
            "'chunk_sizes' asks for chunks of %zu bytes; those of 2 GiB at most are "
            "read",
            array->chunk_bytes);
    return st;
}

cw_status cwi_precomputed_parse(const cwi_zarr_node *node, cwi_zarr_array *array, cw_error *err)
{
    cw_status st = read_type(node->meta.root, array, err);
    if (st == CW_OK)
        st = read_channels(node->meta.root, array, err);
    if (st == CW_OK && (st = read_scale(node, array, err)) != CW_OK)
        return fail_in_scale(node, st, err);
    return st;
}

cw_status cwi_precomputed_frame(const cwi_zarr_node *node, const cwi_zarr_array *array,
                                cwi_zarr_frame *frame, cw_error *err)
{
    static const char names[][2] = {"x", "y", "z", "c"};
    double resolution[SPACE];
    cwi_chunk_storage storage;
    cwi_zarr_start_frame(array, frame);
    cw_status st = read_three(node->scale, "resolution", resolution, err);
    if (st == CW_OK)
        st = cwi_precomputed_storage(node->scale, &storage, err);
    for (size_t d = 0; st == CW_OK && d < array->rank; d++) {
        cwi_zarr_axis *axis = &frame->axes[d];
        axis->role = (cwi_role)d; /* x, y, z, components */
        snprintf(axis->name, sizeof axis->name, "%s", names[d]);
        if (d >= SPACE)
            continue;
        if (!(resolution[d] > 0 && isfinite(resolution[d])))
            return fail_in_scale(
                node,
                cwi_zarr_fail(err, node->scale, "resolution",
                              "a list of three numbers above 0, in nanometres,"),
                err);
        axis->unit = MM_PER_NM;
        axis->has_unit = true;
        frame->matrix[d][d] = resolution[d];
        frame->matrix[d][array->rank] = ((double)storage.offset[d] + 0.5) * resolution[d];
    }
    return st == CW_OK ? CW_OK : fail_in_scale(node, st, err);
}
