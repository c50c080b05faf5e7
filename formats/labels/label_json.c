/* Reads tables of labels in JSON: those of niivue and MRIcroGL, the image-label of OME-Zarr, and the labels
 * of nnU-Net's dataset.json. */
#include "core/base/status.h"
#include "core/volume/label_table.h"
#include "formats/labels/label_file.h"
#include "formats/text/label_ome.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- niivue: arrays of channels, and of names -------------------------------------------- */

enum { RED, GREEN, BLUE, ALPHA, VALUE, NAMES, ARRAY_COUNT };
static const char *const array_names[ARRAY_COUNT] = {"R", "G", "B", "A", "I", "labels"};

static bool is_niivue(const cwi_label_file *file)
{
    const json_t *labels = json_object_get(file->json, "labels");
    return json_is_array(labels) && json_object_get(file->json, "R");
}

static cw_status check_arrays(json_t *const arrays[ARRAY_COUNT], cw_error *err)
{
    const size_t count = json_array_size(arrays[NAMES]);
    for (int a = 0; a < ARRAY_COUNT; a++) {
        if (!arrays[a] && (a == ALPHA || a == VALUE))
            continue;
        if (!json_is_array(arrays[a]))
            return cwi_fail(err, CW_ERR_FORMAT, "'%s' is missing, or no array", array_names[a]);
        if (json_array_size(arrays[a]) != count)
            return cwi_fail(err, CW_ERR_FORMAT, "'%s' has %zu entries; 'labels' has %zu",
                            array_names[a], json_array_size(arrays[a]), count);
    }
    return CW_OK;
}

static cw_status read_entry(json_t *const arrays[ARRAY_COUNT], size_t n, cw_label *label,
                            cw_error *err)
{
    const json_t *name = json_array_get(arrays[NAMES], n);
    cw_status st = CW_OK;
    char field[40];
    *label = (cw_label){.value = (uint32_t)n, .color = {0, 0, 0, 255}, .has_color = true};
    for (int a = 0; a < NAMES && st == CW_OK; a++) {
        uint32_t value = 0;
        if (!arrays[a])
            continue;
        snprintf(field, sizeof field, "%s[%zu]", array_names[a], n);
        st = cwi_json_read_whole(json_array_get(arrays[a], n), field,
                                 a == VALUE ? UINT32_MAX : 255, &value, err);
        if (a == VALUE)
            label->value = value;
        else
            label->color[a] = (uint8_t)value;
    }
    if (st == CW_OK && !json_is_string(name) && !json_is_null(name))
        return cwi_fail(err, CW_ERR_FORMAT, "'labels[%zu]': a text was expected", n);
    label->name = cwi_json_text(name);
    return st;
}

static cw_status read_niivue(cwi_label_file *file, cw_label_table *table, cw_error *err)
{
    json_t *arrays[ARRAY_COUNT];
    for (int a = 0; a < ARRAY_COUNT; a++)
        arrays[a] = json_object_get(file->json, array_names[a]);
    cw_status st = check_arrays(arrays, err);
    for (size_t n = 0; st == CW_OK && n < json_array_size(arrays[NAMES]); n++) {
        cw_label label;
        st = read_entry(arrays, n, &label, err);
        if (st == CW_OK)
            st = cwi_label_table_append(table, &label, err);
    }
    return st == CW_OK ? cwi_label_table_sort(table, false, err) : st;
}

/* --- OME-Zarr: colours and properties of label values ------------------------------------ */

/* Returns the image-label of version 0.4 (.zattrs), or of 0.5 (zarr.json). */
static json_t *find_image_label(const json_t *root)
{
    const json_t *ome = json_object_get(json_object_get(root, "attributes"), "ome");
    json_t *found = json_object_get(root, "image-label");
    return found ? found : json_object_get(ome, "image-label");
}

static bool is_ome_zarr(const cwi_label_file *file)
{
    return json_is_object(find_image_label(file->json));
}

static cw_status read_ome_zarr(cwi_label_file *file, cw_label_table *table, cw_error *err)
{
    return cwi_label_ome_read(find_image_label(file->json), table, err);
}

/* --- nnU-Net: numbers of names, or names of numbers ---------------------------------------- */

static bool is_nnunet(const cwi_label_file *file)
{
    const json_t *labels = json_object_get(file->json, "labels");
    return json_is_object(labels) && json_object_size(labels) > 0;
}

/* Reads a member: "liver": 3, or "3": "liver" of version 1. A list of numbers is a region of labels that
 * have names of their own: left out. */
static cw_status read_member(const char *key, const json_t *member, cw_label *label,
                             cw_error *err)
{
    char field[80];
    snprintf(field, sizeof field, "labels.%.60s", key);
    *label = (cw_label){.name = (char *)(uintptr_t)key};
    if (!json_is_string(member))
        return cwi_json_read_whole(member, field, UINT32_MAX, &label->value, err);
    label->name = cwi_json_text(member);
    return cwi_label_is_whole(key) && strlen(key) < 11
               ? cwi_label_whole(key, UINT32_MAX, 1, field, &label->value, err)
               : cwi_fail(err, CW_ERR_FORMAT,
                          "'%s': a number was expected, of the label that is named '%.40s'",
                          field, json_string_value(member));
}

static cw_status read_nnunet(cwi_label_file *file, cw_label_table *table, cw_error *err)
{
    json_t *labels = json_object_get(file->json, "labels"), *member;
    const char *key;
    cw_status st = CW_OK;
    json_object_foreach(labels, key, member)
    {
        cw_label label;
        if (json_is_array(member))
            continue;
        st = read_member(key, member, &label, err);
        if (st == CW_OK)
            st = cwi_label_table_append(table, &label, err);
        if (st != CW_OK)
            return st;
    }
    return cwi_label_table_sort(table, false, err);
}

const cwi_label_format cwi_label_nnunet = {"nnunet", NULL, is_nnunet, read_nnunet};
const cwi_label_format cwi_label_niivue = {"niivue", NULL, is_niivue, read_niivue};
const cwi_label_format cwi_label_ome_zarr = {"ome-zarr", NULL, is_ome_zarr, read_ome_zarr};
