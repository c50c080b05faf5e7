/* The driver of Zarr: its names, its dialect and its reader. */
#include "formats/zarr/zarr_format.h"

#include "formats/text/label_ome.h"
#include "formats/zarr/zarr_dialect.h"

#include <stdio.h>

#define FILES ".zarray .zgroup .zattrs .zmetadata zarr.json"

static bool is_store(const cwi_input *folder)
{
    return cwi_zarr_has_file(folder, "zarr.json") || cwi_zarr_has_file(folder, ".zarray") ||
           cwi_zarr_has_file(folder, ".zgroup");
}

/* Reads the labels of an image-label, and marks the volume as one. */
static cw_status read_labels(cwi_zarr *z, const cwi_zarr_node *node, cwi_zarr_found *found,
                             cw_error *err)
{
    const json_t *image = json_object_get(node->ome, "image-label");
    if (!json_is_object(image))
        return CW_OK;
    z->shape.known |= CW_KNOWN_LABELS;
    if (z->array.stored == CWI_STORED_I64)
        z->array.type = CW_U32;
    cw_status st = found->labels ? cwi_label_ome_read(image, found->labels, err) : CW_OK;
    return st == CW_OK ? CW_OK : cwi_zarr_fail_in(err, st, node, true);
}

/* Notes the images of labels that belong to an image. */
static void note_labels(const cwi_zarr *z, const cwi_zarr_node *image, cwi_zarr_found *found)
{
    cwi_zarr_node node = {0};
    char path[CWI_ZARR_KEY_BYTES];
    size_t used = 0;
    if (cwi_zarr_join(image->path, "labels", path, NULL) == CW_OK &&
        cwi_zarr_node_open(&node, &z->in, path, NULL) == CW_OK) {
        const json_t *list = json_object_get(node.ome, "labels");
        for (size_t n = 0; n < json_array_size(list) && used < 300; n++) {
            const char *name = json_string_value(json_array_get(list, n));
            used += (size_t)snprintf(
                found->note + used, sizeof found->note - used, "%s'%.40s/%.40s'",
                used ? ", " : "label maps of it, for desc->array: ", path, name ? name : "?");
        }
    }
    cwi_zarr_node_close(&node);
}

static cw_status read_facts(cwi_zarr *z, const cwi_zarr_node *image, cwi_zarr_found *found,
                            cw_error *err)
{
    const size_t images = json_array_size(json_object_get(image->ome, "multiscales"));
    cw_status st = read_labels(z, image, found, err);
    if (st == CW_OK)
        note_labels(z, image, found);
    if (st == CW_OK && images > 1 && !*found->note)
        snprintf(found->note, sizeof found->note,
                 "'multiscales' lists %zu images; the first is taken", images);
    return st;
}

static bool is_image(const cwi_zarr_node *node)
{
    return json_is_array(json_object_get(node->ome, "multiscales"));
}

static cw_status make_frame(const cwi_zarr_node *node, const cwi_zarr_array *array,
                            cwi_zarr_frame *frame, cw_error *err)
{
    (void)node, (void)err;
    cwi_zarr_plain_frame(array, frame);
    return CW_OK;
}

const cwi_zarr_dialect cwi_dialect_zarr = {
    .noun = "Zarr",
    .files = FILES,
    .expected = "zarr.json, .zarray or .zgroup",
    .open_node = cwi_zarr_node_open,
    .parse_array = cwi_zarr_parse,
    .array_frame = make_frame,
    .is_image = is_image,
    .level_count = cwi_zarr_level_count,
    .level_path = cwi_zarr_level_path,
    .level_frame = cwi_zarr_level_frame,
    .read_facts = read_facts,
    .load_chunk = cwi_zarr_load_chunk,
    .read_index = cwi_zarr_read_index,
};

static cw_status read_store(const cwi_input *in, const cw_read_desc *desc, cw_volume *volume,
                            cw_error *err)
{
    return cwi_zarr_read_as(&cwi_dialect_zarr, in, desc, volume, err);
}

static cw_status list_levels(const cwi_input *in, const cw_read_desc *desc, cw_level **levels,
                             size_t *count, cw_error *err)
{
    return cwi_zarr_levels_as(&cwi_dialect_zarr, in, desc, levels, count, err);
}

const cwi_format_driver cwi_format_zarr = {
    .name = "zarr",
    .extensions = ".zarr",
    .about = "Zarr 2 and 3 and OME-Zarr: chunks in a folder, in several sizes",
    .volume = {.extensions = ".zarr " FILES,
               .is_store = is_store,
               .read_file = read_store,
               .list_levels = list_levels},
};
