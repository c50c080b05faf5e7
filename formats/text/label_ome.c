/* Reads the names and colours of an image-label of OME-Zarr. */
#include "formats/text/label_ome.h"

#include "core/base/status.h"
#include "core/volume/label_table.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

cw_status cwi_json_read_whole(const json_t *json, const char *field, uint32_t max,
                              uint32_t *value, cw_error *err)
{
    const double number = json_is_number(json) ? json_number_value(json) : -1;
    if (!(number >= 0 && number <= max) || number != floor(number))
        return cwi_fail(err, CW_ERR_FORMAT, "'%s': a whole number from 0 to %u was expected",
                        field, max);
    *value = (uint32_t)number;
    return CW_OK;
}

char *cwi_json_text(const json_t *json)
{
    const char *text = json_string_value(json);
    return text && *text ? (char *)(uintptr_t)text : NULL;
}

static cw_status read_rgba(const json_t *rgba, const char *field, cw_label *label,
                           cw_error *err)
{
    cw_status st = CW_OK;
    if (json_is_null(rgba) || !rgba)
        return CW_OK;
    if (json_array_size(rgba) != 4)
        return cwi_fail(err, CW_ERR_FORMAT, "'%s': four numbers were expected as 'rgba'",
                        field);
    for (size_t c = 0; c < 4 && st == CW_OK; c++) {
        uint32_t value = 0;
        st = cwi_json_read_whole(json_array_get(rgba, c), field, 255, &value, err);
        label->color[c] = (uint8_t)value;
    }
    label->has_color = true;
    return st;
}

/* Finds a name among the properties of a label, whose keys are free. */
static char *find_name(const json_t *entry)
{
    static const char *const keys[] = {"name", "label", "class"};
    char *name = NULL;
    for (size_t n = 0; !name && n < sizeof keys / sizeof *keys; n++)
        name = cwi_json_text(json_object_get(entry, keys[n]));
    return name;
}

/* Reads a list of objects with a label-value. The same value twice is an error. */
static cw_status read_list(const json_t *image, const char *key, cw_label_table *table,
                           cw_error *err)
{
    const json_t *list = json_object_get(image, key);
    cw_status st = CW_OK;
    char field[60];
    if (list && !json_is_array(list) && !json_is_null(list))
        return cwi_fail(err, CW_ERR_FORMAT, "'%s': an array was expected", key);
    for (size_t n = 0; st == CW_OK && n < json_array_size(list); n++) {
        const json_t *entry = json_array_get(list, n);
        cw_label label = {.name = find_name(entry)};
        snprintf(field, sizeof field, "%s[%zu].label-value", key, n);
        st = cwi_json_read_whole(json_object_get(entry, "label-value"), field, UINT32_MAX,
                                 &label.value, err);
        snprintf(field, sizeof field, "%s[%zu].rgba", key, n);
        if (st == CW_OK)
            st = read_rgba(json_object_get(entry, "rgba"), field, &label, err);
        if (st == CW_OK)
            st = cwi_label_table_append(table, &label, err);
    }
    if (st == CW_OK && (st = cwi_label_table_sort(table, true, err)) == CW_ERR_FORMAT)
        return cwi_fail_in(err, st, key);
    return st;
}

/* Adds the names of properties to colours, and the labels that have no colour. */
static cw_status merge_names(const cw_label_table *names, cw_label_table *table, cw_error *err)
{
    const size_t color_count = table->count;
    cw_status st = CW_OK;
    for (size_t n = 0; n < names->count && st == CW_OK; n++) {
        const cw_label_table colors = {color_count, table->labels};
        cw_label label = names->labels[n];
        const cw_label *color = cw_label_find(&colors, 0, label.value);
        if (color && color->has_color) {
            memcpy(label.color, color->color, sizeof label.color);
            label.has_color = true;
        }
        if (!label.name && color)
            label.name = color->name;
        st = cwi_label_table_append(table, &label, err);
    }
    return st == CW_OK ? cwi_label_table_sort(table, false, err) : st;
}

cw_status cwi_label_ome_read(const json_t *image, cw_label_table *table, cw_error *err)
{
    cw_label_table names = {0};
    cw_status st = read_list(image, "colors", table, err);
    if (st == CW_OK)
        st = read_list(image, "properties", &names, err);
    if (st == CW_OK)
        st = merge_names(&names, table, err);
    cw_label_table_free(&names);
    return st;
}
