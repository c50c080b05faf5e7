/* Finds the arrays of a GIfTI file, its labels, and the transform of its coordinates. */
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/volume/label_table.h"
#include "formats/gifti/gifti.h"
#include "formats/text/label_xml.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_ELEMENTS = 200000, TEXT_BYTES = 2048 };

typedef struct parsing {
    cwi_gifti *g;
    cwi_gifti_array *array; /* the one at hand, if it is kept; NULL: it is not */
    bool is_points;
    cwi_gifti_array *open; /* the next tag ends its text; NULL: none */
    char text[TEXT_BYTES]; /* of the element at hand; longer ones are cut */
    size_t length;
    bool from_unknown, to_scanner; /* the spaces of the matrix at hand */
    double matrix[16];
    bool has_matrix;
    bool is_centre; /* the item of metadata at hand is one of VolGeomC */
} parsing;

/* --- attributes of arrays ----------------------------------------------------------------- */

static const char *attribute(cwi_attributes a, const char *name)
{
    const char *value = cwi_attribute(a, name);
    return value ? value : "";
}

static cw_status read_integer(cwi_attributes a, const char *name, int64_t high, uint64_t *out,
                              cw_error *err)
{
    const char *text = attribute(a, name);
    int64_t number = 0;
    cw_status st = *text ? cwi_field_integer(name, text, 0, high, &number, err) : CW_OK;
    *out = (uint64_t)number;
    return st;
}

static cw_status read_type(cwi_gifti_array *array, cwi_attributes a, cw_error *err)
{
    static const struct {
        const char *name;
        cw_type type;
        cwi_stored stored;
    } types[] = {
        {"UINT8", CW_U8, CWI_STORED_PLAIN},    {"INT32", CW_I32, CWI_STORED_PLAIN},
        {"FLOAT32", CW_F32, CWI_STORED_PLAIN}, {"FLOAT64", CW_F64, CWI_STORED_PLAIN},
        {"INT8", CW_I8, CWI_STORED_PLAIN},     {"INT16", CW_I16, CWI_STORED_PLAIN},
        {"UINT16", CW_U16, CWI_STORED_PLAIN},  {"UINT32", CW_U32, CWI_STORED_PLAIN},
        {"INT64", CW_I32, CWI_STORED_I64},     {"UINT64", CW_U32, CWI_STORED_U64},
    };
    const char *text = attribute(a, "DataType");
    const char *name = strncmp(text, "NIFTI_TYPE_", 11) == 0 ? text + 11 : text;
    for (size_t n = 0; n < sizeof types / sizeof *types; n++)
        if (strcmp(types[n].name, name) == 0) {
            array->type = types[n].type;
            array->stored = types[n].stored;
            return CW_OK;
        }
    return cwi_fail(
        err, CW_ERR_FORMAT,
        "'DataType' is '%.40s'; UINT8, INT32, FLOAT32 or another whole or real type of "
        "NIFTI_TYPE was expected",
        text);
}

static cw_status read_sizes(cwi_gifti_array *array, cwi_attributes a, cw_error *err)
{
    uint64_t rank = 0, dim[3] = {0};
    cw_status st = read_integer(a, "Dimensionality", 6, &rank, err);
    for (size_t n = 0; n < 3 && n < rank && st == CW_OK; n++) {
        char name[8];
        snprintf(name, sizeof name, "Dim%zu", n);
        st = read_integer(a, name, INT32_MAX, &dim[n], err);
    }
    if (st == CW_OK && (rank < 1 || rank > 2) && !(rank == 3 && dim[2] == 1))
        return cwi_fail(err, CW_ERR_FORMAT, "'Dimensionality' is %llu; 1 or 2 was expected",
                        (unsigned long long)rank);
    array->count = (size_t)dim[0];
    array->components = rank > 1 ? (size_t)dim[1] : 1;
    return st;
}

static cw_status read_encoding(cwi_gifti_array *array, cwi_attributes a, cw_error *err)
{
    const char *encoding = attribute(a, "Encoding"), *endian = attribute(a, "Endian");
    const bool external = strcmp(encoding, "ExternalFileBinary") == 0;
    array->ascii = strcmp(encoding, "ASCII") == 0;
    array->deflated = strcmp(encoding, "GZipBase64Binary") == 0;
    array->base64 = array->deflated || strcmp(encoding, "Base64Binary") == 0;
    array->big_endian = strcmp(endian, "BigEndian") == 0;
    if (!array->ascii && !array->base64 && !external)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'Encoding' is '%.40s'; ASCII, Base64Binary, GZipBase64Binary or "
                        "ExternalFileBinary was expected",
                        encoding);
    if (!array->ascii && !array->big_endian && strcmp(endian, "LittleEndian") != 0)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'Endian' is '%.40s'; LittleEndian or BigEndian was expected", endian);
    if (!external)
        return CW_OK;
    const char *file = attribute(a, "ExternalFileName");
    if (!*file || strlen(file) >= sizeof array->file)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'ExternalFileName' is '%.80s'; the name of the file with the numbers, "
                        "of at most %zu bytes, was expected",
                        file, sizeof array->file - 1);
    snprintf(array->file, sizeof array->file, "%s", file);
    return read_integer(a, "ExternalFileOffset", INT64_MAX, &array->offset, err);
}

static cw_status read_array(cwi_gifti_array *array, cwi_attributes a, cw_error *err)
{
    const char *order = attribute(a, "ArrayIndexingOrder");
    *array = (cwi_gifti_array){.columns = strcmp(order, "ColumnMajorOrder") == 0};
    snprintf(array->intent, sizeof array->intent, "%s", attribute(a, "Intent"));
    cw_status st = read_type(array, a, err);
    if (st == CW_OK)
        st = read_sizes(array, a, err);
    if (st == CW_OK)
        st = read_encoding(array, a, err);
    if (st == CW_OK && *order && !array->columns && strcmp(order, "RowMajorOrder") != 0)
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "'ArrayIndexingOrder' is '%.40s'; RowMajorOrder or ColumnMajorOrder was "
            "expected",
            order);
    return st;
}

static cwi_gifti_role role_of(const char *intent)
{
    static const struct {
        const char *name;
        cwi_gifti_role role;
    } intents[] = {{"POINTSET", CWI_GIFTI_POINTS},   {"TRIANGLE", CWI_GIFTI_TRIANGLES},
                   {"SHAPE", CWI_GIFTI_SCALARS},     {"LABEL", CWI_GIFTI_LABELS},
                   {"RGB_VECTOR", CWI_GIFTI_COLORS}, {"RGBA_VECTOR", CWI_GIFTI_COLORS}};
    if (strncmp(intent, "NIFTI_INTENT_", 13) != 0)
        return CWI_GIFTI_ROLE_COUNT;
    for (size_t n = 0; n < sizeof intents / sizeof *intents; n++)
        if (strcmp(intent + 13, intents[n].name) == 0)
            return intents[n].role;
    return CWI_GIFTI_ROLE_COUNT;
}

/* --- elements ---------------------------------------------------------------------------- */

static cw_status start_array(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    parsing *p = user;
    cwi_gifti *g = p->g;
    const char *intent = attribute(a, "Intent");
    const cwi_gifti_role role = role_of(intent);
    const bool structural = role <= CWI_GIFTI_TRIANGLES;
    (void)x;
    if (g->count++ == 0)
        snprintf(g->first, sizeof g->first, "%s", intent);
    p->array = NULL;
    p->is_points = false;
    if (role == CWI_GIFTI_ROLE_COUNT || g->has[role]) {
        g->more += structural && role != CWI_GIFTI_ROLE_COUNT;
        if (!structural && g->others++ == 0)
            snprintf(g->other, sizeof g->other, "%s", intent);
        return CW_OK;
    }
    g->has[role] = true;
    p->array = &g->arrays[role];
    p->is_points = role == CWI_GIFTI_POINTS;
    return read_array(p->array, a, err);
}

static cw_status start_data(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    parsing *p = user;
    (void)a, (void)err;
    if (p->array && p->array->start == 0) {
        p->array->start = p->array->end = cwi_xml_tag_end(x);
        p->open = p->array;
    }
    return CW_OK;
}

static cw_status start_text(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    (void)x, (void)a, (void)err;
    ((parsing *)user)->length = 0;
    return CW_OK;
}

/* Returns the text of the element at hand, without blanks around it. */
static const char *text_of(parsing *p)
{
    while (p->length && strchr(" \t\r\n", p->text[p->length - 1]))
        p->length--;
    p->text[p->length] = '\0';
    return p->text + strspn(p->text, " \t\r\n");
}

static cw_status start_matrix(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    parsing *p = user;
    (void)x, (void)a, (void)err;
    p->from_unknown = p->to_scanner = p->has_matrix = false;
    return CW_OK;
}

static cw_status end_data_space(void *user, cwi_xml *x, cw_error *err)
{
    parsing *p = user;
    const char *text = text_of(p);
    (void)x, (void)err;
    p->from_unknown = !*text || strcmp(text, "NIFTI_XFORM_UNKNOWN") == 0;
    return CW_OK;
}

static cw_status end_transformed_space(void *user, cwi_xml *x, cw_error *err)
{
    parsing *p = user;
    (void)x, (void)err;
    p->to_scanner = strcmp(text_of(p), "NIFTI_XFORM_SCANNER_ANAT") == 0;
    return CW_OK;
}

static cw_status end_numbers(void *user, cwi_xml *x, cw_error *err)
{
    parsing *p = user;
    (void)x;
    p->has_matrix = true;
    return cwi_field_doubles("MatrixData", text_of(p), 16, "CoordinateSystemTransformMatrix",
                             p->matrix, err);
}

/* Keeps the matrix of points whose own frame is not named, if it leads to the scanner's. */
static cw_status end_matrix(void *user, cwi_xml *x, cw_error *err)
{
    parsing *p = user;
    (void)x, (void)err;
    if (!p->is_points || !p->has_matrix || !p->from_unknown || !p->to_scanner)
        return CW_OK;
    p->g->has_matrix = true;
    memcpy(p->g->matrix, p->matrix, sizeof p->g->matrix);
    return CW_OK;
}

static cw_status end_name(void *user, cwi_xml *x, cw_error *err)
{
    parsing *p = user;
    (void)x, (void)err;
    p->is_centre = p->is_points && strncmp(text_of(p), "VolGeomC_", 9) == 0;
    return CW_OK;
}

static cw_status end_value(void *user, cwi_xml *x, cw_error *err)
{
    parsing *p = user;
    (void)x, (void)err;
    if (p->is_centre && strtod(text_of(p), NULL) != 0)
        p->g->has_centre = true;
    return CW_OK;
}

static cw_status start_label(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    cw_label label;
    if (attribute(a, "Key")[0] == '-') /* vertices without a label */
        return CW_OK;
    cw_status st = cwi_label_xml_label(x, a, &label, err);
    return st == CW_OK ? cwi_label_table_append(&((parsing *)user)->g->labels, &label, err)
                       : st;
}

static cw_status end_text(void *user, cwi_xml *x, cw_error *err)
{
    parsing *p = user;
    (void)err;
    if (p->open && cwi_xml_tag_start(x) > p->open->start)
        p->open->end = cwi_xml_tag_start(x);
    p->open = NULL;
    return CW_OK;
}

enum {
    E_FILE,
    E_TABLE,
    E_LABEL,
    E_ARRAY,
    E_METADATA,
    E_ITEM,
    E_NAME,
    E_VALUE,
    E_MATRIX,
    E_DATA_SPACE,
    E_TRANSFORMED_SPACE,
    E_NUMBERS,
    E_DATA,
    ELEMENT_COUNT
};

static const cwi_xml_element elements[ELEMENT_COUNT] = {
    [E_FILE] = {"GIFTI", CWI_XML_ROOT, NULL, NULL},
    [E_TABLE] = {"LabelTable", E_FILE, NULL, NULL},
    [E_LABEL] = {"Label", E_TABLE, start_label, NULL},
    [E_ARRAY] = {"DataArray", E_FILE, start_array, NULL},
    [E_METADATA] = {"MetaData", E_ARRAY, NULL, NULL},
    [E_ITEM] = {"MD", E_METADATA, NULL, NULL},
    [E_NAME] = {"Name", E_ITEM, start_text, end_name},
    [E_VALUE] = {"Value", E_ITEM, start_text, end_value},
    [E_MATRIX] = {"CoordinateSystemTransformMatrix", E_ARRAY, start_matrix, end_matrix},
    [E_DATA_SPACE] = {"DataSpace", E_MATRIX, start_text, end_data_space},
    [E_TRANSFORMED_SPACE] = {"TransformedSpace", E_MATRIX, start_text, end_transformed_space},
    [E_NUMBERS] = {"MatrixData", E_MATRIX, start_text, end_numbers},
    [E_DATA] = {"Data", E_ARRAY, start_data, NULL},
};

static cw_status add_text(void *user, int row, const char *text, size_t size, cw_error *err)
{
    parsing *p = user;
    const size_t left = TEXT_BYTES - 1 - p->length, kept = size < left ? size : left;
    (void)err;
    if (row == E_DATA || row == CWI_XML_ROOT)
        return CW_OK;
    for (size_t n = 0; n < kept; n++)
        p->text[p->length++] = strchr("\t\r\n", text[n]) ? ' ' : text[n];
    return CW_OK;
}

cw_status cwi_gifti_parse(cwi_gifti *g, const cwi_input *in, cw_error *err)
{
    static const cwi_xml_rules rules = {.elements = elements,
                                        .element_count = ELEMENT_COUNT,
                                        .max_elements = MAX_ELEMENTS,
                                        .doctype = "GIFTI",
                                        .text = add_text,
                                        .tag = end_text};
    parsing p = {.g = g};
    cw_status st = cwi_xml_read_file(&rules, &p, in, err);
    return st == CW_OK ? cwi_label_table_sort(&g->labels, false, err) : st;
}

void cwi_gifti_free(cwi_gifti *g)
{
    cw_label_table_free(&g->labels);
}
