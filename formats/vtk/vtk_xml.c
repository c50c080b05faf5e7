/* Parses the common elements of VTK's XML files, and finds the bytes of their arrays. */
#include "formats/vtk/vtk_xml.h"

#include "core/base/status.h"
#include "formats/cells/grid_arrays.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

bool cwi_vtk_xml_sniff(const unsigned char *head, size_t size, const char *word)
{
    static const char tag[] = "<VTKFile";
    const size_t length = strlen(word);
    for (size_t i = 0; i + sizeof tag - 1 <= size; i++)
        if (memcmp(head + i, tag, sizeof tag - 1) == 0)
            for (size_t k = i; k + length <= size && head[k] != '>'; k++)
                if (memcmp(head + k, word, length) == 0)
                    return true;
    return false;
}

/* --- elements ---------------------------------------------------------------------------- */

/* Sets *found to the row of a word that must be one of them. It is unchanged when there is no
 * such attribute. */
static cw_status one_of(cwi_attributes a, const char *name, const char *const *rows, int count,
                        int *found, cw_error *err)
{
    const char *value = cwi_attribute(a, name);
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
    return cwi_fail(err, CW_ERR_FORMAT, "'%s' is '%.40s'; those that are read are %s", name,
                    value, words);
}

cw_status cwi_vtk_xml_file(cwi_vtk_xml *v, cwi_attributes a, const char *const kind[2],
                           cw_error *err)
{
    static const char *const orders[] = {"LittleEndian", "BigEndian"};
    static const char *const words[] = {"UInt32", "UInt64"};
    static const char *const compressors[] = {
        [CWI_VTK_PLAIN] = "", "vtkZLibDataCompressor", "vtkLZ4DataCompressor"};
    int order = 0, word = 0, compressor = 0;
    const char *type = cwi_attribute(a, "type");
    v->has_order = cwi_attribute(a, "byte_order");
    if (type &&
        (strncmp(type, "vtk", 3) == 0 || (*type == 'P' && strcmp(type, "PolyData") != 0)) &&
        strcmp(type, kind[0]) != 0)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the VTK file is '%.40s', a list of other files; name one of them",
                        type);
    if (!type || strcmp(type, kind[0]) != 0)
        return cwi_fail(err, CW_ERR_FORMAT, "the VTK file is '%.40s'; only %s is %s",
                        type ? type : "", kind[0], kind[1]);
    cw_status st = one_of(a, "byte_order", orders, 2, &order, err);
    if (st == CW_OK)
        st = one_of(a, "header_type", words, 2, &word, err);
    if (st == CW_OK)
        st = one_of(a, "compressor", compressors, 3, &compressor, err);
    if (st == CW_OK && compressor == CWI_VTK_LZ4 && !cwi_lz4_present())
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "'compressor' is vtkLZ4DataCompressor; this build has no LZ4 "
                        "(liblz4-dev, CUBEWRIGHT_LZ4)");
    v->big_endian = order;
    v->word_bytes = word ? 8 : 4;
    v->compressor = (cwi_vtk_compressor)compressor;
    return st;
}

cw_status cwi_vtk_xml_integer(cwi_attributes a, const char *name, int64_t low, int64_t high,
                              int64_t *out, cw_error *err)
{
    const char *value = cwi_attribute(a, name);
    return value ? cwi_field_integer(name, value, low, high, out, err) : CW_OK;
}

static const struct {
    const char *name;
    cw_type type;
    cwi_stored stored;
} types[] = {
    {"Int8", CW_I8, 0},
    {"UInt8", CW_U8, 0},
    {"Int16", CW_I16, 0},
    {"UInt16", CW_U16, 0},
    {"Int32", CW_I32, 0},
    {"UInt32", CW_U32, 0},
    {"Float32", CW_F32, 0},
    {"Float64", CW_F64, 0},
    {"Int64", CW_I32, CWI_STORED_I64},
    {"UInt64", CW_U32, CWI_STORED_U64},
};

static void find_type(cwi_vtk_array *array)
{
    for (size_t i = 0; i < sizeof types / sizeof *types && !array->is_known; i++)
        if (strcmp(types[i].name, array->type_name) == 0) {
            array->is_known = true;
            array->type = types[i].type;
            array->stored = types[i].stored;
        }
}

static void keep_word(char word[CWI_WORD_BYTES], const char *text)
{
    snprintf(word, CWI_WORD_BYTES, "%s", text ? text : "");
}

cw_status cwi_vtk_xml_array(cwi_vtk_array *array, cwi_attributes a, cw_error *err)
{
    static const char *const forms[] = {"ascii", "binary", "appended"};
    int form = CWI_VTK_ASCII;
    int64_t offset = 0, components = 1;
    *array = (cwi_vtk_array){0};
    keep_word(array->name, cwi_attribute(a, "Name"));
    keep_word(array->type_name, cwi_attribute(a, "type"));
    find_type(array);
    cw_status st = one_of(a, "format", forms, 3, &form, err);
    if (st == CW_OK)
        st = cwi_vtk_xml_integer(a, "NumberOfComponents", 1, INT32_MAX, &components, err);
    if (st == CW_OK && form == CWI_VTK_APPENDED && !cwi_attribute(a, "offset"))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the array '%s' is appended; its 'offset' is missing", array->name);
    if (st == CW_OK)
        st = cwi_vtk_xml_integer(a, "offset", 0, INT64_MAX, &offset, err);
    array->form = (cwi_vtk_form)form;
    array->offset = (uint64_t)offset;
    array->components = (size_t)components;
    return st;
}

cw_status cwi_vtk_xml_appended(cwi_vtk_xml *v, cwi_attributes a, cw_error *err)
{
    static const char *const encodings[] = {"raw", "base64"};
    int encoding = 1; /* VTK's own default */
    v->has_appended = true;
    cw_status st = one_of(a, "encoding", encodings, 2, &encoding, err);
    v->base64 = encoding;
    return st;
}

/* --- appended data ----------------------------------------------------------------------- */

/* Checks that the file goes on to its last tag behind the appended data, since Expat has not
 * read that. */
static cw_status check_end(const cwi_input *in, cw_error *err)
{
    static const char tag[] = "</VTKFile>";
    char text[256];
    const size_t length = sizeof tag - 1;
    const uint64_t start = in->size > sizeof text ? in->size - sizeof text : 0;
    size_t size;
    cw_status st = cwi_input_read_at(in->fd, start, text, sizeof text, &size, err);
    while (size > 0 && isspace((unsigned char)text[size - 1]))
        size--;
    if (st != CW_OK || (size >= length && memcmp(text + size - length, tag, length) == 0))
        return st;
    return cwi_fail(err, CW_ERR_FORMAT, "the file does not end with %s: it is cut off", tag);
}

/* Finds the appended data, which start with an underscore. */
cw_status cwi_vtk_xml_find_appended(const cwi_input *in, cwi_vtk_xml *v, cw_error *err)
{
    char text[256];
    size_t size = 0, i = 0;
    if (!v->has_appended)
        return CW_OK;
    cw_status st = cwi_input_read_at(in->fd, v->appended, text, sizeof text, &size, err);
    while (i < size && isspace((unsigned char)text[i]))
        i++;
    if (st == CW_OK && (i == size || text[i] != '_'))
        return cwi_fail(err, CW_ERR_FORMAT, "the appended data do not start with '_'");
    v->appended += i + 1;
    return st == CW_OK ? check_end(in, err) : st;
}

/* --- to a source ------------------------------------------------------------------------- */

static void set_byte_range(const cwi_vtk_xml *v, const cwi_vtk_array *a, cwi_source *src)
{
    static const cwi_codec codecs[] = {
        [CWI_VTK_ZLIB] = CWI_CODEC_ZLIB, [CWI_VTK_LZ4] = CWI_CODEC_LZ4};
    src->offset = a->start;
    src->span = a->end - a->start;
    src->big_endian = v->big_endian;
    src->base64 = a->form == CWI_VTK_BINARY || (a->form == CWI_VTK_APPENDED && v->base64);
    if (a->form == CWI_VTK_APPENDED) {
        src->span = 0;
        if (__builtin_add_overflow(v->appended, a->offset, &src->offset))
            src->offset = UINT64_MAX;
    }
    if (a->form == CWI_VTK_ASCII) {
        src->encoding = CWI_ASCII;
    } else if (v->compressor != CWI_VTK_PLAIN) {
        src->encoding = CWI_BLOCKS;
        src->blocks = (cwi_block_form){codecs[v->compressor], v->word_bytes, v->big_endian};
    } else {
        src->skip = v->word_bytes;
    }
}

/* Checks the count of bytes that precedes uncompressed data. */
static cw_status check_count(const cwi_input *in, const cwi_vtk_xml *v,
                             const cwi_vtk_array *array, const cwi_source *src, cw_error *err)
{
    unsigned char word[8];
    uint64_t count = 0;
    cwi_stream stream = {0};
    if (src->encoding != CWI_RAW)
        return CW_OK;
    cw_status st = cwi_stream_open(&stream, in->fd, src->offset, false, err);
    if (st == CW_OK && src->base64)
        st = cwi_stream_from_base64(&stream, err);
    if (st == CW_OK)
        st = cwi_stream_read(&stream, word, v->word_bytes, err);
    cwi_stream_close(&stream);
    if (st != CW_OK)
        return st;
    for (size_t i = 0; i < v->word_bytes; i++)
        count = count << 8 | word[v->big_endian ? i : v->word_bytes - 1 - i];
    const size_t bytes = src->bytes / cw_type_size(src->shape.type) *
                         cwi_stored_size(src->stored, src->shape.type);
    if (count == bytes)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "the array '%s' has %llu bytes; '%s' and 'type' ask for %zu", array->name,
                    (unsigned long long)count, src->size_field, bytes);
}

cw_status cwi_vtk_xml_place(const cwi_vtk_xml *v, const cwi_vtk_array *array,
                            const cwi_input *in, cwi_source *src, cw_error *err)
{
    if (array->form == CWI_VTK_APPENDED && !v->has_appended)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the array '%s' is appended; AppendedData is missing", array->name);
    if (array->form != CWI_VTK_ASCII && !v->has_order)
        return cwi_fail(err, CW_ERR_FORMAT, "'byte_order' is missing; the array '%s' needs it",
                        array->name);
    set_byte_range(v, array, src);
    return check_count(in, v, array, src, err);
}

cw_status cwi_vtk_xml_tuples(const cwi_vtk_xml *v, const cwi_vtk_array *array,
                             const char *field, size_t count, const cwi_input *in,
                             cwi_source *src, bool *wide, cw_error *err)
{
    *wide = false;
    if (!array)
        return cwi_fail(err, CW_ERR_FORMAT, "'%s' is %zu; the array for them is missing", field,
                        count);
    *wide = array->stored && array->form != CWI_VTK_ASCII;
    const cw_type type = *wide ? CW_U32 : array->stored ? CW_F64 : array->type;
    cw_status st = cwi_tuples_describe(src, field, type, *wide, array->components, count, err);
    return st == CW_OK ? cwi_vtk_xml_place(v, array, in, src, err) : st;
}

cw_status cwi_vtk_xml_values(const cwi_vtk_xml *v, const cwi_vtk_array *array,
                             const char *field, size_t count, const cwi_input *in,
                             cwi_source *src, cw_error *err)
{
    cw_status st =
        cwi_tuples_describe(src, field, array->type, false, array->components, count, err);
    src->stored = array->stored;
    return st == CW_OK ? cwi_vtk_xml_place(v, array, in, src, err) : st;
}
