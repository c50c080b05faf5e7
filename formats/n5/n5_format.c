/* The driver of N5: its names, its dialect and its reader. */
#include "formats/n5/n5_format.h"

#include "core/base/status.h"
#include "formats/n5/n5.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

static bool is_named_n5(const char *path)
{
    size_t length = strlen(path);
    while (length > 1 && path[length - 1] == '/')
        length--;
    return length > 3 && strncasecmp(path + length - 3, ".n5", 3) == 0;
}

/* Returns true for a folder that is named so, whose attributes are those of N5 or damaged, or
 * that has the finest level of an image. */
static bool is_store(const cwi_input *folder)
{
    static const char *const keys[] = {"n5",     "dimensions", "downsamplingFactors",
                                       "scales", "multiScale", "pixelResolution"};
    cwi_zarr_json json = {0};
    bool found = is_named_n5(folder->path) || cwi_zarr_has_file(folder, "s0/" CWI_N5_FILE);
    if (found || !cwi_zarr_has_file(folder, CWI_N5_FILE))
        return found;
    found = cwi_zarr_json_open(&json, folder, CWI_N5_FILE, NULL) != CW_OK;
    for (size_t n = 0; n < sizeof keys / sizeof *keys; n++)
        found = found || json_object_get(json.root, keys[n]);
    cwi_zarr_json_close(&json);
    return found;
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
    char name[24];
    snprintf(name, sizeof name, "s%zu", number);
    return cwi_zarr_join(image->path, name, path, err);
}

/* Notes what is not read. */
static cw_status read_facts(cwi_zarr *z, const cwi_zarr_node *image, cwi_zarr_found *found,
                            cw_error *err)
{
    (void)z, (void)err;
    if (json_object_get(image->meta.root, "affineTransform"))
        snprintf(found->note, sizeof found->note,
                 "its 'affineTransform' is left out: only scales and offsets are read");
    return CW_OK;
}

static const cwi_zarr_dialect dialect = {
    .noun = "N5",
    .files = CWI_N5_FILE,
    .expected = CWI_N5_FILE,
    .open_node = cwi_n5_open_node,
    .parse_array = cwi_n5_parse,
    .array_frame = cwi_n5_array_frame,
    .is_image = is_image,
    .level_count = count_levels,
    .level_path = find_level_path,
    .level_frame = cwi_n5_level_frame,
    .read_facts = read_facts,
    .load_chunk = cwi_n5_load_block,
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

const cwi_format_driver cwi_format_n5 = {
    .name = "n5",
    .extensions = ".n5",
    .about = "N5: blocks in a folder, in several sizes",
    .volume = {.extensions = ".n5 " CWI_N5_FILE,
               .is_store = is_store,
               .read_file = read_store,
               .list_levels = list_levels},
};
