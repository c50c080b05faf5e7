/* Reads the attributes of N5: nodes, what they inherit, and arrays. */
#define _GNU_SOURCE /* fstatat */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/n5/n5.h"
#include "formats/volume/voxel_source.h"
#include "formats/zarr/zarr_decode.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const cwi_zarr_words words = {.file = CWI_N5_FILE,
                                     .attributes = CWI_N5_FILE,
                                     .type = "dataType",
                                     .shape = "dimensions",
                                     .frame = "resolution"};

/* --- nodes -------------------------------------------------------------------------------- */

/* Copies what attributes say of frames over what those of folders above say. Of two keys for the
 * same the nearer one holds. */
static bool inherit_keys(json_t *merged, const json_t *attributes)
{
    static const char *const keys[][2] = {{"resolution", "pixelResolution"},
                                          {"pixelResolution", "resolution"},
                                          {"downsamplingFactors", "scales"},
                                          {"scales", "downsamplingFactors"},
                                          {"axes", ""},
                                          {"units", ""},
                                          {"offset", ""}};
    for (size_t n = 0; n < sizeof keys / sizeof *keys; n++)
        if (json_object_get(attributes, keys[n][0]))
            json_object_del(merged, keys[n][1]);
    for (size_t n = 0; n < sizeof keys / sizeof *keys; n++) {
        json_t *item = json_object_get(attributes, keys[n][0]);
        if (item && json_object_set(merged, keys[n][0], item) != 0)
            return false;
    }
    return true;
}

/* Merges the attributes of all folders above a node, from the store's on, and its own. */
static cw_status merge_attributes(cwi_zarr_node *node, const cwi_input *in, cw_error *err)
{
    cw_status st = CW_OK;
    json_t *merged = json_object();
    bool fits = merged;
    node->attributes.root = merged;
    node->attrs = merged;
    for (size_t end = 0; st == CW_OK && fits && node->path[end];) {
        cwi_zarr_node above = {0};
        snprintf(above.path, sizeof above.path, "%.*s", (int)end, node->path);
        st = cwi_zarr_node_json(&above, in, CWI_N5_FILE, &above.meta, err);
        fits = st != CW_OK || inherit_keys(merged, above.meta.root);
        cwi_zarr_node_close(&above);
        end += node->path[end] == '/';
        end += strcspn(node->path + end, "/");
    }
    fits = fits && inherit_keys(merged, node->meta.root);
    return st == CW_OK && !fits ? cwi_fail_memory(err) : st;
}

static bool is_folder(const cwi_input *in, const char *path)
{
    struct stat info;
    return !*path || (fstatat(in->folder, path, &info,
                              in->allow_external ? 0 : AT_SYMLINK_NOFOLLOW) == 0 &&
                      S_ISDIR(info.st_mode));
}

/* Counts the levels s0, s1 ... of a group. */
static cw_status count_levels(cwi_zarr_node *node, const cwi_input *in, cw_error *err)
{
    cw_status st = CW_OK;
    for (int fd = 0; st == CW_OK && fd >= 0 && node->levels <= CWI_N5_LEVELS;) {
        char name[40], path[CWI_ZARR_KEY_BYTES];
        uint64_t size;
        snprintf(name, sizeof name, "s%zu/" CWI_N5_FILE, node->levels);
        st = cwi_zarr_join(node->path, name, path, err);
        fd = -1;
        if (st == CW_OK)
            st = cwi_input_find_side(in, path, &fd, &size, err);
        if (st == CW_OK && fd >= 0) {
            close(fd);
            node->levels++;
        }
    }
    return st == CW_OK && node->levels > CWI_N5_LEVELS
               ? cwi_fail(err, CW_ERR_LIMIT, "the group '%.200s' has more than %d levels",
                          node->path, CWI_N5_LEVELS)
               : st;
}

cw_status cwi_n5_open_node(cwi_zarr_node *node, const cwi_input *in, const char *path,
                           cw_error *err)
{
    *node = (cwi_zarr_node){.words = &words};
    cw_status st = cwi_zarr_join("", path, node->path, err);
    if (st == CW_OK)
        st = cwi_zarr_node_json(node, in, CWI_N5_FILE, &node->meta, err);
    if (st == CW_OK)
        st = merge_attributes(node, in, err);
    if (json_object_get(node->meta.root, "dimensions"))
        node->kind = CWI_ZARR_IS_ARRAY;
    else if (st == CW_OK && is_folder(in, node->path))
        node->kind = CWI_ZARR_IS_GROUP;
    if (st == CW_OK && node->kind == CWI_ZARR_IS_GROUP)
        st = count_levels(node, in, err);
    return st;
}

/* --- arrays ------------------------------------------------------------------------------- */

static cw_status read_dimensions(const json_t *meta, cwi_zarr_array *array, cw_error *err)
{
    const json_t *list = json_object_get(meta, "dimensions");
    array->rank = json_array_size(list);
    if (!json_is_array(list))
        return cwi_zarr_fail(err, meta, "dimensions", "a list of sizes");
    if (array->rank < 1 || array->rank > CWI_ZARR_RANK) {
        const size_t rank = array->rank;
        array->rank = 0;
        return cwi_fail(err, CW_ERR_FORMAT, "'dimensions' lists %zu sizes; 1 to %d are read",
                        rank, CWI_ZARR_RANK);
    }
    return cwi_zarr_sizes(meta, "dimensions", array->rank, array->shape, err);
}

static cw_status read_type(const json_t *meta, cwi_zarr_array *array, cw_error *err)
{
    const char *text = cwi_zarr_text(meta, "dataType");
    char kind = '\0';
    unsigned bits = 0;
    if (!text)
        return cwi_zarr_fail(err, meta, "dataType", "a type such as \"uint16\"");
    snprintf(array->type_name, sizeof array->type_name, "%s", text);
    for (unsigned n = 8; n <= 64 && !bits; n *= 2) {
        char unsigned_name[16], signed_name[16], float_name[16];
        snprintf(unsigned_name, sizeof unsigned_name, "uint%u", n);
        snprintf(signed_name, sizeof signed_name, "int%u", n);
        snprintf(float_name, sizeof float_name, "float%u", n);
        kind = strcmp(text, unsigned_name) == 0 ? 'u'
               : strcmp(text, signed_name) == 0 ? 'i'
               : strcmp(text, float_name) == 0  ? 'f'
                                                : '\0';
        bits = kind ? n : 0;
    }
    return bits && cwi_zarr_set_type(array, kind, bits / 8)
               ? CW_OK
               : cwi_fail_type(err, "dataType", text);
}

/* Reads the compression: an object with its type, or that type as the first version had it. */
static cw_status read_compression(const json_t *meta, cwi_zarr_array *array, cw_error *err)
{
    static const struct {
        const char *name;
        cwi_zarr_codec codec;
    } codecs[] = {{"gzip", CWI_ZARR_GZIP},   {"zlib", CWI_ZARR_ZLIB},
                  {"zstd", CWI_ZARR_ZSTD},   {"lz4", CWI_ZARR_LZ4_FRAMES},
                  {"blosc", CWI_ZARR_BLOSC}, {"bzip2", CWI_ZARR_BZ2}};
    const json_t *compression = json_object_get(meta, "compression");
    const char *type = cwi_zarr_text(compression, "type");
    if (!type && !compression)
        type = cwi_zarr_text(meta, "compressionType");
    if (!type)
        return cwi_zarr_fail(err, meta, "compression", "an object with a 'type'");
    if (strcmp(type, "raw") == 0)
        return CW_OK;
    for (size_t n = 0; n < sizeof codecs / sizeof *codecs; n++)
        if (strcmp(type, codecs[n].name) == 0) {
            array->chain.codecs[array->chain.count++] = codecs[n].codec;
            return cwi_zarr_codec_check(codecs[n].codec, err);
        }
    return cwi_fail(
        err, CW_ERR_FORMAT,
        "'compression' is '%.40s'; those that are read are raw, gzip, zlib, zstd, lz4, "
        "blosc, bzip2",
        type);
}

cw_status cwi_n5_parse(const cwi_zarr_node *node, cwi_zarr_array *array, cw_error *err)
{
    const json_t *meta = node->meta.root;
    cw_status st = read_dimensions(meta, array, err);
    if (st == CW_OK)
        st = read_type(meta, array, err);
    if (st == CW_OK)
        st = cwi_zarr_sizes(meta, "blockSize", array->rank, array->chunk, err);
    if (st == CW_OK)
        st = read_compression(meta, array, err);
    if (st == CW_OK && json_is_true(json_object_get(meta, "isLabelMultiset")))
        st = cwi_zarr_fail(err, meta, "isLabelMultiset",
                           "false, as sets of labels in a voxel are not read,");
    array->chain.big_endian = true;
    array->separator = '/';
    for (size_t d = 0; d < array->rank; d++) {
        array->order[d] = array->rank - 1 - d;
        array->inner[d] = array->chunk[d] < array->shape[d] ? array->chunk[d] : array->shape[d];
    }
    return st == CW_OK ? cwi_zarr_set_chunk_bytes(array, "blockSize", err) : st;
}
