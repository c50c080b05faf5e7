/* The driver of Neuroglancer's precomputed volumes: names, dialect and reader. */
#define _GNU_SOURCE /* close, memmem */
#include "formats/precomputed/precomputed_format.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/precomputed/precomputed.h"

#include <string.h>
#include <unistd.h>

static bool has_text(const unsigned char *head, size_t size, const char *text)
{
    return memmem(head, size, text, strlen(text)) != NULL;
}

/* Recognises a JSON object with a type of Neuroglancer, or with several keys of its volumes. */
static bool sniff(const unsigned char *head, size_t size)
{
    static const char *const keys[] = {"\"scales\"",      "\"data_type\"",  "\"num_channels\"",
                                       "\"chunk_sizes\"", "\"resolution\"", "\"voxel_offset\""};
    enum { ENOUGH = 3 };
    size_t at = 0, found = 0;
    while (at < size && strchr(" \t\r\n", head[at]) && head[at])
        at++;
    if (at == size || head[at] != '{')
        return false;
    for (size_t n = 0; n < sizeof keys / sizeof *keys; n++)
        found += has_text(head, size, keys[n]);
    return found >= ENOUGH ||
           (has_text(head, size, "\"@type\"") && has_text(head, size, "\"neuroglancer_"));
}

static bool is_store(const cwi_input *folder)
{
    unsigned char head[CWI_SNIFF_BYTES];
    uint64_t size;
    size_t got = 0;
    int fd = -1;
    if (cwi_input_find_side(folder, CWI_PRECOMPUTED_FILE, &fd, &size, NULL) != CW_OK || fd < 0)
        return false;
    const bool is_read = cwi_input_read_at(fd, 0, head, sizeof head, &got, NULL) == CW_OK;
    close(fd);
    return is_read && sniff(head, got);
}

static bool is_image(const cwi_zarr_node *node)
{
    return node->levels > 0;
}

static size_t count_levels(const cwi_zarr_node *image)
{
    return image->levels;
}

static cw_status find_level_path(const cwi_zarr_node *image, size_t number,
                                 char path[CWI_ZARR_KEY_BYTES], cw_error *err)
{
    const json_t *scale = json_array_get(json_object_get(image->meta.root, "scales"), number);
    const char *key = cwi_zarr_text(scale, "key");
    cw_status st = key && *key ? cwi_zarr_join("", key, path, err)
                               : cwi_zarr_fail(err, scale, "key", "the path of a folder");
    return st == CW_OK ? CW_OK : cwi_zarr_fail_in(err, st, image, false);
}

static cw_status make_level_frame(const cwi_zarr_node *image, size_t number,
                                  const cwi_zarr_node *level, const cwi_zarr_array *array,
                                  cwi_zarr_frame *frame, cw_error *err)
{
    (void)image, (void)number;
    cw_status st = cwi_precomputed_frame(level, array, frame, err);
    return st == CW_OK ? CW_OK : cwi_zarr_fail_in(err, st, level, false);
}

/* Keeps how the chunks of the chosen scale are stored. */
static cw_status keep_storage(cwi_zarr *z, cw_error *err)
{
    cwi_zarr_node node;
    cwi_chunk_storage *storage = cwi_alloc_zeroed(1, sizeof *storage);
    z->extra = storage;
    if (!storage)
        return cwi_fail_memory(err);
    cw_status st = cwi_precomputed_open_node(&node, &z->in, z->array.path, err);
    if (st == CW_OK)
        st = cwi_precomputed_storage(node.scale, storage, err);
    z->array.is_sharded = storage->is_sharded;
    z->array.shard_count = 1;
    cwi_zarr_node_close(&node);
    return st;
}

static const cwi_zarr_dialect dialect = {
    .noun = "Neuroglancer",
    .files = CWI_PRECOMPUTED_FILE,
    .expected = CWI_PRECOMPUTED_FILE,
    .open_node = cwi_precomputed_open_node,
    .parse_array = cwi_precomputed_parse,
    .array_frame = cwi_precomputed_frame,
    .is_image = is_image,
    .level_count = count_levels,
    .level_path = find_level_path,
    .level_frame = make_level_frame,
    .read_facts = cwi_precomputed_facts,
    .prepare = keep_storage,
    .load_chunk = cwi_precomputed_load,
    .read_index = cwi_minishard_read,
};

static cw_status read_store(const cwi_input *in, const cw_read_desc *desc, cw_volume *volume,
                            cw_error *err)
{
    return cwi_zarr_read_as(&dialect, in, desc, volume, err);
}

static cw_status list_levels(const cwi_input *in, const cw_read_desc *desc, cw_level **levels,
                             size_t *count, cw_error *err)
{
    return cwi_zarr_levels_as(&dialect, in, desc, levels, count, err);
}

const cwi_format_driver cwi_format_precomputed = {
    .name = "precomputed",
    .extensions = "",
    .about = "Neuroglancer volumes: info and chunks in a folder, in several sizes",
    .volume = {.sniff = sniff,
               .is_store = is_store,
               .read_file = read_store,
               .list_levels = list_levels},
};
