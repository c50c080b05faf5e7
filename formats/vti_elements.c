/* What the attributes of .vti elements mean. */
#include "core/status.h"
#include "core/text.h"
#include "formats/vti.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *name;
    cw_type type;
} types[] = {
    {"Int8", CW_I8},   {"UInt8", CW_U8},   {"Int16", CW_I16},   {"UInt16", CW_U16},
    {"Int32", CW_I32}, {"UInt32", CW_U32}, {"Float32", CW_F32}, {"Float64", CW_F64},
};

static const char *attribute(cwi_attributes a, const char *name)
{
    for (; *a; a += 2)
        if (strcmp(a[0], name) == 0)
            return a[1];
    return NULL;
}

/* Sets *found to the row of a word that must be one of them; it keeps its value when there is
 * no such attribute. */
static cw_status one_of(cwi_attributes a, const char *name, const char *const *rows, int count,
                        int *found, cw_error *err)
{
    const char *value = attribute(a, name);
    for (int i = 0; value && i < count; i++)
        if (strcmp(rows[i], value) == 0) {
            *found = i;
            return CW_OK;
        }
    if (!value)
        return CW_OK;
    char words[120] = "";
    for (int i = 0; i < count; i++)
        snprintf(words + strlen(words), sizeof words - strlen(words), "%s%s",
                 *words ? ", " : "", rows[i]);
    return cw_fail(err, CW_ERR_FORMAT, "'%s' is '%.40s'; those that are read are %s", name,
                   value, words);
}

cw_status cwi_vti_file(cwi_vti *v, cwi_attributes a, cw_error *err)
{
    static const char *const orders[] = {"LittleEndian", "BigEndian"};
    static const char *const words[] = {"UInt32", "UInt64"};
    static const char *const compressors[] = {
        [CWI_VTI_PLAIN] = "", "vtkZLibDataCompressor", "vtkLZ4DataCompressor"};
    int order = 0, word = 0, compressor = 0;
    const char *type = attribute(a, "type");
    v->has_order = attribute(a, "byte_order");
    if (!type || strcmp(type, "ImageData") != 0)
        return cw_fail(err, CW_ERR_FORMAT,
                       "the VTK file is '%.40s'; only ImageData is a volume", type ? type : "");
    cw_status st = one_of(a, "byte_order", orders, 2, &order, err);
    if (st == CW_OK)
        st = one_of(a, "header_type", words, 2, &word, err);
    if (st == CW_OK)
        st = one_of(a, "compressor", compressors, 3, &compressor, err);
    if (st == CW_OK && compressor == CWI_VTI_LZ4 && !cwi_lz4_present())
        return cw_fail(err, CW_ERR_UNSUPPORTED,
                       "'compressor' is vtkLZ4DataCompressor; this build has no LZ4 "
                       "(liblz4-dev, CUBEWRIGHT_LZ4)");
    v->big_endian = order;
    v->word_bytes = word ? 8 : 4;
    v->compressor = (cwi_vti_compressor)compressor;
    return st;
}

static cw_status numbers(cwi_attributes a, const char *name, size_t count, double *out,
                         cw_error *err)
{
    const char *value = attribute(a, name);
    return value ? cwi_field_doubles(name, value, count, "ImageData", out, err) : CW_OK;
}

cw_status cwi_vti_image(cwi_vti *v, cwi_attributes a, cw_error *err)
{
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const char *times = attribute(a, "TimeValues");
    for (int i = 0; i < 3; i++)
        v->spacing[i] = 1;
    memcpy(v->direction, identity, sizeof identity);
    if (times && strchr(times, ' '))
        return cw_fail(err, CW_ERR_FORMAT,
                       "'TimeValues' is '%.40s'; several time steps in one file are not read",
                       times);
    cw_status st = numbers(a, "Origin", 3, v->origin, err);
    if (st == CW_OK)
        st = numbers(a, "Spacing", 3, v->spacing, err);
    return st == CW_OK ? numbers(a, "Direction", 9, v->direction, err) : st;
}

cw_status cwi_vti_piece(cwi_vti *v, cwi_attributes a, cw_error *err)
{
    const char *extent = attribute(a, "Extent"), *s = extent ? extent : "";
    if (v->pieces++)
        return cw_fail(err, CW_ERR_FORMAT,
                       "the file has several Piece elements; files of one are read");
    for (int i = 0; i < 6; i++)
        if (!cwi_parse_int(&s, &v->extent[i]) || v->extent[i] > INT32_MAX ||
            v->extent[i] < INT32_MIN)
            return cw_fail(err, CW_ERR_FORMAT,
                           "'Extent' is '%.60s'; six whole numbers were expected",
                           extent ? extent : "");
    for (int i = 0; i < 6; i += 2)
        if (v->extent[i + 1] < v->extent[i] || v->extent[i + 1] - v->extent[i] >= INT32_MAX)
            return cw_fail(err, CW_ERR_FORMAT,
                           "'Extent' is '%.60s'; it must hold 1 to 2147483647 points along "
                           "each axis",
                           extent);
    return CW_OK;
}

static void keep_word(char word[CWI_WORD_BYTES], const char *text)
{
    snprintf(word, CWI_WORD_BYTES, "%s", text ? text : "");
}

cw_status cwi_vti_point_data(cwi_vti *v, cwi_attributes a, cw_error *err)
{
    (void)err;
    keep_word(v->scalars, attribute(a, "Scalars"));
    return CW_OK;
}

/* --- arrays ------------------------------------------------------------------------------ */

static cw_status integer(cwi_attributes a, const char *name, int64_t low, int64_t high,
                         int64_t *out, cw_error *err)
{
    const char *value = attribute(a, name);
    return value ? cwi_field_integer(name, value, low, high, out, err) : CW_OK;
}

static void note_other(cwi_vti *v, const char *name, const char *type, int64_t components)
{
    const size_t used = strlen(v->others);
    snprintf(v->others + used, sizeof v->others - used, "%s'%s' (%lld %s)", used ? ", " : "",
             name, (long long)components, type);
}

/* Whether the array can be a volume at all. */
static bool find_type(const char *name, cw_type *type)
{
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strcmp(types[i].name, name) == 0) {
            *type = types[i].type;
            return true;
        }
    return false;
}

static cw_status read_array(cwi_vti_array *array, cwi_attributes a, int64_t *components,
                            cw_error *err)
{
    static const char *const forms[] = {"ascii", "binary", "appended"};
    int form = CWI_VTI_ASCII;
    int64_t offset = 0;
    keep_word(array->name, attribute(a, "Name"));
    cw_status st = one_of(a, "format", forms, 3, &form, err);
    if (st == CW_OK)
        st = integer(a, "NumberOfComponents", 1, INT32_MAX, components, err);
    if (st == CW_OK && form == CWI_VTI_APPENDED && !attribute(a, "offset"))
        return cw_fail(err, CW_ERR_FORMAT,
                       "the array '%s' is appended; its 'offset' is missing", array->name);
    if (st == CW_OK)
        st = integer(a, "offset", 0, INT64_MAX, &offset, err);
    array->form = (cwi_vti_form)form;
    array->offset = (uint64_t)offset;
    array->components = (size_t)*components;
    return st;
}

cw_status cwi_vti_data_array(cwi_vti *v, cwi_attributes a, bool *kept, cw_error *err)
{
    const char *type = attribute(a, "type");
    cwi_vti_array array = {0};
    int64_t components = 1;
    cw_status st = read_array(&array, a, &components, err);
    *kept = false;
    if (st != CW_OK)
        return st;
    const bool named = *array.name && strcmp(array.name, v->scalars) == 0;
    array.rank = named ? CWI_VTI_SCALARS : components == 1 ? CWI_VTI_ONE : CWI_VTI_SEVERAL;
    if (!type || !find_type(type, &array.type) || components > 16) {
        note_other(v, array.name, type ? type : "of no type", components);
        return CW_OK;
    }
    *kept = array.rank > v->best.rank;
    if (*kept)
        v->best = array;
    return CW_OK;
}

cw_status cwi_vti_appended(cwi_vti *v, cwi_attributes a, cw_error *err)
{
    static const char *const encodings[] = {"raw", "base64"};
    int encoding = 1; /* VTK's own default */
    v->has_appended = true;
    cw_status st = one_of(a, "encoding", encodings, 2, &encoding, err);
    v->base64 = encoding;
    return st;
}
