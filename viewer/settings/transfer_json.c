/* Reads and writes transfer functions as JSON, by the schema "cubewright-transfer-1". */
#define _GNU_SOURCE /* fmemopen */
#include "viewer/settings/transfer_json.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/files/atomic_file.h"
#include "viewer/settings/json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char schema[] = "cubewright-transfer-1";

/* Takes the n-th point of a list: [value, second]. */
static cw_status take_point(const json_t *point, const char *list, size_t n, const char *second,
                            double *value, const json_t **other, cw_error *err)
{
    if (!json_is_array(point) || json_array_size(point) != 2 ||
        !json_is_number(json_array_get(point, 0)))
        return cwi_fail(err, CW_ERR_FORMAT, "point %zu of '%s': [value, %s] was expected", n,
                        list, second);
    *value = json_number_value(json_array_get(point, 0));
    *other = json_array_get(point, 1);
    return CW_OK;
}

/* Parses "#rrggbb". */
static bool parse_color(const json_t *text, float color[3])
{
    const char *hex = json_string_value(text);
    if (!hex || strlen(hex) != 7 || hex[0] != '#' ||
        strspn(hex + 1, "0123456789abcdefABCDEF") != 6)
        return false;
    const unsigned long rgb = strtoul(hex + 1, NULL, 16);
    for (int c = 0; c < 3; c++)
        color[c] = (float)(rgb >> (16 - 8 * c) & 255) / 255;
    return true;
}

static cw_status check_list(const json_t *list, const char *key, cw_error *err)
{
    if (list && !json_is_array(list))
        return cwi_fail(err, CW_ERR_FORMAT, "'%s' was expected to be a list, [...]", key);
    if (json_array_size(list) > CW_TRANSFER_POINTS)
        return cwi_fail(err, CW_ERR_FORMAT, "'%s' has %zu points; at most %d were expected",
                        key, json_array_size(list), CW_TRANSFER_POINTS);
    return CW_OK;
}

static cw_status take_colors(const json_t *root, cw_transfer *t, cw_error *err)
{
    const json_t *list = json_object_get(root, "colors"), *color = NULL;
    cw_status st = check_list(list, "colors", err);
    for (size_t n = 0; st == CW_OK && n < json_array_size(list); n++) {
        cw_color_point *p = &t->colors[t->color_count++];
        st = take_point(json_array_get(list, n), "colors", n, "\"#rrggbb\"", &p->value, &color,
                        err);
        if (st == CW_OK && !parse_color(color, p->color))
            st =
                cwi_fail(err, CW_ERR_FORMAT,
                         "point %zu of 'colors': a colour such as \"#ffeedd\" was expected", n);
    }
    return st;
}

static cw_status take_opacities(const json_t *root, const char *key, cw_opacity_point *points,
                                size_t *count, cw_error *err)
{
    const json_t *list = json_object_get(root, key), *opacity = NULL;
    cw_status st = check_list(list, key, err);
    for (size_t n = 0; st == CW_OK && n < json_array_size(list); n++) {
        cw_opacity_point *p = &points[(*count)++];
        st = take_point(json_array_get(list, n), key, n, "0 to 1", &p->value, &opacity, err);
        if (st != CW_OK)
            return st;
        const double fraction = json_is_number(opacity) ? json_number_value(opacity) : -1;
        if (!(fraction >= 0 && fraction <= 1))
            return cwi_fail(err, CW_ERR_FORMAT, "point %zu of '%s': 0 to 1 was expected", n,
                            key);
        p->opacity = (float)fraction;
    }
    return st;
}

static cw_status take_indices(const json_t *root, cw_transfer *t, cw_error *err)
{
    const json_t *list = json_object_get(root, "indices"), *index = NULL;
    cw_status st = check_list(list, "indices", err);
    for (size_t n = 0; st == CW_OK && n < json_array_size(list); n++) {
        cw_index_point *p = &t->indices[t->index_count++];
        st = take_point(json_array_get(list, n), "indices", n, "index", &p->value, &index, err);
        if (st == CW_OK && !json_is_number(index))
            st = cwi_fail(err, CW_ERR_FORMAT, "point %zu of 'indices': a number was expected",
                          n);
        p->index = (float)json_number_value(index);
    }
    return st;
}

/* Takes a material's four values: null is an open end. */
static bool take_ends(const json_t *list, double values[4])
{
    if (!json_is_array(list) || json_array_size(list) != 4)
        return false;
    for (size_t n = 0; n < 4; n++) {
        const json_t *end = json_array_get(list, n);
        if (!json_is_null(end) && !json_is_number(end))
            return false;
        values[n] = json_is_number(end) ? json_number_value(end) : n < 2 ? -INFINITY : INFINITY;
    }
    return true;
}

static cw_status take_material(const json_t *object, size_t n, cw_material_class *m,
                               cw_error *err)
{
    static const char *const keys[] = {"name", "values", "color", "opacity", "index"};
    const char *key;
    const json_t *value;
    double opacity = 0, index = 0;
    size_t known = 0;
    if (!json_is_object(object))
        return cwi_fail(err, CW_ERR_FORMAT, "material %zu: an object, {...}, was expected", n);
    json_object_foreach((json_t *)object, key, value)
    {
        for (known = 0; known < 5 && strcmp(key, keys[known]) != 0; known++) {
        }
        if (known == 5)
            return cwi_fail(
                err, CW_ERR_FORMAT,
                "material %zu has the unknown field '%.60s'; there are name, values, "
                "color, opacity, index",
                n, key);
    }
    if (!take_ends(json_object_get(object, "values"), m->values))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "material %zu: 'values' was expected to be [v, v, v, v], null for an "
                        "open end",
                        n);
    if (!parse_color(json_object_get(object, "color"), m->color))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "material %zu: 'color' was expected, such as \"#ffeedd\"", n);
    cw_status st = cwi_json_number(object, "opacity", &opacity, err);
    if (st == CW_OK)
        st = cwi_json_number(object, "index", &index, err);
    m->opacity = (float)opacity;
    m->index = (float)index;
    return st;
}

/* Takes classes of materials, which stand for colours, opacities and indices. */
static cw_status take_materials(const json_t *root, cw_transfer *t, cw_error *err)
{
    static const char *const curves[] = {"colors", "opacities", "indices"};
    cw_material_class materials[CW_MAX_MATERIALS] = {0};
    const json_t *list = json_object_get(root, "materials");
    const size_t count = json_array_size(list);
    cw_status st = CW_OK;
    if (!list)
        return CW_OK;
    for (int n = 0; n < 3; n++)
        if (json_object_get(root, curves[n]))
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'materials' and '%s': one of them was expected", curves[n]);
    if (!json_is_array(list) || count < 1 || count > CW_MAX_MATERIALS)
        return cwi_fail(err, CW_ERR_FORMAT, "'materials' was expected to be a list of 1 to %d",
                        CW_MAX_MATERIALS);
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = take_material(json_array_get(list, n), n, &materials[n], err);
    if (st == CW_OK && cw_transfer_set_materials(t, materials, count, err) != CW_OK)
        st = CW_ERR_FORMAT;
    return st;
}

/* Takes a length. One that is present must be valid; a missing one is chosen by the volume. */
static cw_status take_length(const json_t *root, const char *key, double *length, cw_error *err)
{
    cw_status st = cwi_json_number(root, key, length, err);
    if (st == CW_OK && json_object_get(root, key) && !(*length > 0))
        return cwi_fail(err, CW_ERR_FORMAT, "'%s' is %g: a length was expected", key, *length);
    return st;
}

static cw_status take_all(const json_t *root, cw_transfer *t, cw_error *err)
{
    cw_status st = take_length(root, "unit_mm", &t->unit_mm, err);
    if (st == CW_OK)
        st = take_length(root, "surface_mm", &t->surface_mm, err);
    if (st == CW_OK)
        st = take_colors(root, t, err);
    if (st == CW_OK)
        st = take_opacities(root, "opacities", t->opacities, &t->opacity_count, err);
    if (st == CW_OK)
        st = take_opacities(root, "gradients", t->gradients, &t->gradient_count, err);
    if (st == CW_OK)
        st = take_indices(root, t, err);
    if (st == CW_OK)
        st = take_materials(root, t, err);
    if (st == CW_OK && cw_transfer_check(t, err) != CW_OK)
        st = CW_ERR_FORMAT;
    return st;
}

cw_status cwi_transfer_parse(const char *bytes, size_t size, cw_transfer *transfer,
                             cw_error *err)
{
    static const char *const keys[] = {"unit_mm",    "colors",  "opacities", "gradients",
                                       "surface_mm", "indices", "materials", NULL};
    cw_transfer t = {0};
    json_t *root;
    cw_status st = cwi_json_object(bytes, size, schema, keys, &root, err);
    if (st != CW_OK)
        return st;
    st = take_all(root, &t, err);
    json_decref(root);
    if (st == CW_OK)
        *transfer = t;
    else if (err)
        err->status = st;
    return st;
}

static cw_status parse_transfer(const char *bytes, size_t size, void *out, cw_error *err)
{
    return cwi_transfer_parse(bytes, size, out, err);
}

cw_status cw_transfer_read(const char *path, cw_transfer *transfer, cw_error *err)
{
    CWI_REQUIRE(err, path, transfer);
    return cwi_json_read(path, parse_transfer, transfer, err);
}

cw_status cw_transfer_parse(const char *text, cw_transfer *transfer, cw_error *err)
{
    CWI_REQUIRE(err, text, transfer);
    return cwi_transfer_parse(text, strlen(text), transfer, err);
}

static void put_colors(FILE *out, const cw_transfer *t)
{
    char number[CWI_JSON_NUMBER];
    fputs(",\n \"colors\": [", out);
    for (size_t n = 0; n < t->color_count; n++) {
        const cw_color_point *p = &t->colors[n];
        fprintf(out, "%s[%s, \"#%02x%02x%02x\"]", n ? ",\n  " : "",
                cwi_json_double(number, p->value), (unsigned)lroundf(255 * p->color[0]),
                (unsigned)lroundf(255 * p->color[1]), (unsigned)lroundf(255 * p->color[2]));
    }
    fputc(']', out);
}

static void put_opacities(FILE *out, const char *key, const cw_opacity_point *points,
                          size_t count)
{
    char value[CWI_JSON_NUMBER], opacity[CWI_JSON_NUMBER];
    fprintf(out, ",\n \"%s\": [", key);
    for (size_t n = 0; n < count; n++)
        fprintf(out, "%s[%s, %s]", n ? ", " : "", cwi_json_double(value, points[n].value),
                cwi_json_float(opacity, points[n].opacity));
    fputc(']', out);
}

static void put_indices(FILE *out, const cw_transfer *t)
{
    char value[CWI_JSON_NUMBER], index[CWI_JSON_NUMBER];
    fputs(",\n \"indices\": [", out);
    for (size_t n = 0; n < t->index_count; n++)
        fprintf(out, "%s[%s, %s]", n ? ", " : "", cwi_json_double(value, t->indices[n].value),
                cwi_json_float(index, t->indices[n].index));
    fputc(']', out);
}

static void put_transfer(FILE *out, const cw_transfer *t)
{
    char number[CWI_JSON_NUMBER];
    fprintf(out, "{\"schema\": \"%s\"", schema);
    if (t->unit_mm > 0)
        fprintf(out, ",\n \"unit_mm\": %s", cwi_json_double(number, t->unit_mm));
    put_colors(out, t);
    put_opacities(out, "opacities", t->opacities, t->opacity_count);
    if (t->gradient_count)
        put_opacities(out, "gradients", t->gradients, t->gradient_count);
    if (t->index_count)
        put_indices(out, t);
    if (t->surface_mm > 0)
        fprintf(out, ",\n \"surface_mm\": %s", cwi_json_double(number, t->surface_mm));
    fputs("}\n", out);
}

/* Formats a transfer function. 4 * 64 points of up to 70 bytes each always fit. */
cw_status cw_transfer_format(const cw_transfer *transfer, char text[CW_TRANSFER_TEXT],
                             cw_error *err)
{
    CWI_REQUIRE(err, transfer, text);
    cw_status st = cw_transfer_check(transfer, err);
    if (st != CW_OK)
        return st;
    FILE *out = fmemopen(text, CW_TRANSFER_TEXT, "w");
    if (!out)
        return cwi_fail_memory(err);
    void *before = cwi_locale_c();
    put_transfer(out, transfer);
    cwi_locale_restore(before);
    return fclose(out) == 0 ? CW_OK : cwi_fail_memory(err);
}

cw_status cw_transfer_write(const char *path, const cw_transfer *transfer, cw_error *err)
{
    CWI_REQUIRE(err, path, transfer);
    char text[CW_TRANSFER_TEXT];
    cw_status st = cw_transfer_format(transfer, text, err);
    return st == CW_OK ? cwi_outfile_save(path, text, strlen(text), err) : st;
}
