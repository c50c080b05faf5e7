/* Reads the names of the segments of a precomputed volume: its segment properties. */
#include "core/base/status.h"
#include "core/volume/label_table.h"
#include "formats/precomputed/precomputed.h"

#include <string.h>

/* Returns the names of segments: the values of the property of type "label". */
static const json_t *find_names(const json_t *inlined)
{
    const json_t *properties = json_object_get(inlined, "properties");
    for (size_t n = 0; n < json_array_size(properties); n++) {
        const json_t *property = json_array_get(properties, n);
        const char *type = cwi_zarr_text(property, "type");
        if (type && strcmp(type, "label") == 0)
            return json_object_get(property, "values");
    }
    return NULL;
}

static cw_status add_names(const json_t *inlined, cwi_zarr_found *found, cw_error *err)
{
    const json_t *ids = json_object_get(inlined, "ids"), *names = find_names(inlined);
    cw_status st = CW_OK;
    if (!json_is_array(ids))
        return cwi_zarr_fail(err, inlined, "ids", "a list of numbers as texts");
    if (names && json_array_size(names) != json_array_size(ids))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'values' lists %zu names; %zu were expected, as 'ids' lists",
                        json_array_size(names), json_array_size(ids));
    for (size_t n = 0; st == CW_OK && names && n < json_array_size(ids); n++) {
        const char *name = json_string_value(json_array_get(names, n));
        const char *id = json_string_value(json_array_get(ids, n));
        cw_label label = {.name = name && *name ? (char *)(uintptr_t)name : NULL};
        if (!id || !cw_label_parse(id, &label))
            return cwi_fail(
                err, CW_ERR_FORMAT,
                "'ids' has no number as a text at %zu; one of up to 64 bits was expected", n);
        if (label.name)
            st = cwi_label_table_append(found->labels, &label, err);
    }
    return st == CW_OK ? cwi_label_table_sort(found->labels, false, err) : st;
}

/* Reads the file `info` of the folder that "segment_properties" names; nothing where it is missing. */
static cw_status read_names(const cwi_zarr *z, const char *folder, cwi_zarr_found *found,
                            cw_error *err)
{
    char path[CWI_ZARR_KEY_BYTES];
    cwi_zarr_json json = {0};
    cw_status st = cwi_zarr_join(folder, CWI_PRECOMPUTED_FILE, path, err);
    if (st == CW_OK)
        st = cwi_zarr_json_open(&json, &z->in, path, err);
    if (st == CW_OK && json.root) {
        st = add_names(json_object_get(json.root, "inline"), found, err);
        if (st != CW_OK)
            cwi_fail_in(err, st, path);
    }
    cwi_zarr_json_close(&json);
    return st;
}

cw_status cwi_precomputed_facts(cwi_zarr *z, const cwi_zarr_node *image, cwi_zarr_found *found,
                                cw_error *err)
{
    const json_t *root = image->meta.root;
    const char *type = cwi_zarr_text(root, "type");
    const char *folder = cwi_zarr_text(root, "segment_properties");
    const bool is_segmentation = type && strcmp(type, "segmentation") == 0;
    if (!is_segmentation && !(type && strcmp(type, "image") == 0))
        return cwi_zarr_fail_in(
            err, cwi_zarr_fail(err, root, "type", "\"image\" or \"segmentation\""), image,
            false);
    if (!is_segmentation)
        return CW_OK;
    z->shape.known |= CW_KNOWN_LABELS;
    if (z->array.stored == CWI_STORED_I64)
        z->array.type = CW_U32;
    return found->labels && folder && *folder ? read_names(z, folder, found, err) : CW_OK;
}
