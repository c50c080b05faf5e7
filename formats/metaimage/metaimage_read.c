/* Reads MetaImage: "Key = value" lines; the last one states the place of the voxels. Defined at
 * itk.org/Wiki/ITK/MetaIO/Documentation. */
#include "core/base/status.h"
#include "formats/metaimage/metaimage_format.h"
#include "formats/text/text_header.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

enum { MAX_AXES = 4 };

typedef enum key {
    K_OBJECT_TYPE,
    K_NDIMS,
    K_DIM_SIZE,
    K_ELEMENT_TYPE,
    K_CHANNELS,
    K_SPACING,
    K_ELEMENT_SIZE,
    K_OFFSET,
    K_MATRIX,
    K_UNITS,
    K_BINARY,
    K_MSB,
    K_COMPRESSED,
    K_COMPRESSED_SIZE,
    K_HEADER_SIZE,
    K_DATA_FILE,
    K_VALUE_SLOPE,
    K_VALUE_OFFSET,
    K_IGNORED,
    KEY_COUNT
} key;

static const char *const key_names[KEY_COUNT] = {
    [K_OBJECT_TYPE] = "objecttype",
    [K_NDIMS] = "ndims",
    [K_DIM_SIZE] = "dimsize",
    [K_ELEMENT_TYPE] = "elementtype",
    [K_CHANNELS] = "elementnumberofchannels",
    [K_SPACING] = "elementspacing",
    [K_ELEMENT_SIZE] = "elementsize",
    [K_OFFSET] = "offset|position|origin",
    [K_MATRIX] = "transformmatrix|rotation|orientation",
    [K_UNITS] = "distanceunits",
    [K_BINARY] = "binarydata",
    [K_MSB] = "binarydatabyteordermsb|elementbyteordermsb",
    [K_COMPRESSED] = "compresseddata",
    [K_COMPRESSED_SIZE] = "compresseddatasize",
    [K_HEADER_SIZE] = "headersize",
    [K_DATA_FILE] = "elementdatafile",
    [K_VALUE_SLOPE] = "elementtointensityfunctionslope",
    [K_VALUE_OFFSET] = "elementtointensityfunctionoffset",
    [K_IGNORED] = "comment|objectsubtype|transformtype|name|id|parentid|color|modality",
};

/* The element types. MetaIO's LONG has 32 bits everywhere, LONG_LONG has 64. */
static const struct {
    const char *name;
    cw_type type;
    cwi_stored stored;
} types[] = {
    {"MET_UCHAR", CW_U8, 0},
    {"MET_CHAR", CW_I8, 0},
    {"MET_USHORT", CW_U16, 0},
    {"MET_SHORT", CW_I16, 0},
    {"MET_UINT", CW_U32, 0},
    {"MET_INT", CW_I32, 0},
    {"MET_ULONG", CW_U32, 0},
    {"MET_LONG", CW_I32, 0},
    {"MET_ULONG_LONG", CW_U32, CWI_STORED_U64},
    {"MET_LONG_LONG", CW_I32, CWI_STORED_I64},
    {"MET_FLOAT", CW_F32, 0},
    {"MET_DOUBLE", CW_F64, 0},
};

typedef struct metaimage {
    cwi_lines lines;
    const char *value[KEY_COUNT]; /* as written; NULL: the key is missing */
    size_t dimensions;
    size_t size[MAX_AXES];
} metaimage;

/* Recognises a first line "Key = ..." with a known key. */
bool cwi_metaimage_sniff(const unsigned char *head, size_t size)
{
    const char *text = (const char *)head;
    size_t length = 0;
    while (length < size && (isalpha(head[length]) || head[length] == ' '))
        length++;
    return length > 0 && length < size && head[length] == '=' &&
           cwi_field_find(key_names, KEY_COUNT, text, length) >= 0;
}

/* Keeps a value. Private keys are legal, so unknown ones are ignored. */
static cw_status keep_key(metaimage *m, const char *line, cw_error *err)
{
    const char *equals = strchr(line, '=');
    if (!equals)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "line %zu holds no 'Key = value'; is this a MetaImage?",
                        m->lines.number);
    const int k = cwi_field_find(key_names, KEY_COUNT, line, (size_t)(equals - line));
    if (k < 0 || k == K_IGNORED)
        return CW_OK;
    if (m->value[k])
        return cwi_fail(err, CW_ERR_FORMAT, "line %zu: '%.*s' was given before",
                        m->lines.number, (int)strcspn(line, " \t="), line);
    m->value[k] = equals + 1 + strspn(equals + 1, " \t");
    return CW_OK;
}

static cw_status read_keys(metaimage *m, cw_error *err)
{
    char *line;
    cw_status st = CW_OK;
    while (st == CW_OK && !m->value[K_DATA_FILE]) {
        st = cwi_lines_next(&m->lines, &line, err);
        if (st == CW_OK && !line)
            return cwi_fail(err, CW_ERR_FORMAT, "'ElementDataFile' is missing");
        if (st == CW_OK && *line)
            st = keep_key(m, line, err);
    }
    return st;
}

static cw_status require_key(const metaimage *m, key k, const char *name, cw_error *err)
{
    return m->value[k] ? CW_OK : cwi_fail(err, CW_ERR_FORMAT, "'%s' is missing", name);
}

static cw_status read_bool(const metaimage *m, key k, const char *name, bool *out,
                           cw_error *err)
{
    static const char *const words[] = {"false|0|f", "true|1|t"};
    const char *value = m->value[k];
    if (!value)
        return CW_OK;
    const int found = cwi_field_find(words, 2, value, strlen(value));
    if (found < 0)
        return cwi_fail(err, CW_ERR_FORMAT, "'%s' is '%.40s'; it must be True or False", name,
                        value);
    *out = found == 1;
    return CW_OK;
}

static cw_status read_type(const metaimage *m, cwi_source *src, cw_error *err)
{
    cw_status st = require_key(m, K_ELEMENT_TYPE, "ElementType", err);
    if (st != CW_OK)
        return st;
    const char *name = m->value[K_ELEMENT_TYPE];
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        const size_t length = strlen(types[i].name);
        if (strncmp(name, types[i].name, length) == 0 &&
            (name[length] == '\0' || strcmp(name + length, "_ARRAY") == 0)) {
            src->shape.type = types[i].type;
            src->stored = types[i].stored;
            return CW_OK;
        }
    }
    return cwi_fail_type(err, "ElementType", name);
}

static cw_status read_sizes(metaimage *m, cwi_source *src, cw_error *err)
{
    int64_t dimensions = 0, channels = 1;
    cw_status st = require_key(m, K_NDIMS, "NDims", err);
    if (st == CW_OK)
        st = cwi_field_integer("NDims", m->value[K_NDIMS], 2, MAX_AXES, &dimensions, err);
    m->dimensions = (size_t)dimensions;
    if (st == CW_OK)
        st = require_key(m, K_DIM_SIZE, "DimSize", err);
    if (st == CW_OK)
        st = cwi_field_sizes("DimSize", m->value[K_DIM_SIZE], m->dimensions, "NDims", m->size,
                             err);
    if (st == CW_OK && m->value[K_CHANNELS])
        st = cwi_field_integer("ElementNumberOfChannels", m->value[K_CHANNELS], 1, 16,
                               &channels, err);
    if (st != CW_OK)
        return st;
    static const cwi_role roles[MAX_AXES] = {CWI_AXIS_X, CWI_AXIS_Y, CWI_AXIS_Z, CWI_AXIS_STEP};
    cwi_axis axes[1 + MAX_AXES] = {{CWI_AXIS_COMPONENT, (size_t)channels}};
    for (size_t a = 0; a < m->dimensions; a++)
        axes[a + 1] = (cwi_axis){roles[a], m->size[a]};
    return cwi_source_set_axes(src, axes, 1 + m->dimensions, err);
}

/* --- place of the voxels ----------------------------------------------------------------- */

/* Reads "LIST", "LIST 2" and "LIST 2D": files with that number of axes each. */
static cw_status read_list(metaimage *m, cwi_source *src, int64_t *depth, cw_error *err)
{
    const char *count = m->value[K_DATA_FILE] + 4;
    count += strspn(count, " \t");
    if (*count &&
        (count[0] < '1' || count[0] > '4' || (count[1] && strcmp(count + 1, "D") != 0)))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'ElementDataFile' is 'LIST %.20s'; 'LIST 2D' was expected", count);
    if (*count)
        *depth = count[0] - '0';
    return cwi_lines_names(&m->lines, &src->files, err);
}

static cw_status check_file_count(const metaimage *m, const cwi_source *src, int64_t depth,
                                  cw_error *err)
{
    size_t expected = 1;
    if (depth < 1 || depth > (int64_t)m->dimensions)
        depth = (int64_t)m->dimensions - 1;
    for (size_t a = (size_t)depth; a < m->dimensions; a++)
        expected *= expected <= INT32_MAX ? m->size[a] : 1;
    if (src->files.count != expected)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'ElementDataFile' names %zu files; 'DimSize' needs %zu",
                        src->files.count, expected);
    return CW_OK;
}

/* Returns true if the text is this word (given in lower case), or starts with it and a
 * blank. */
static bool is_word(const char *text, const char *word)
{
    return cwi_field_find(&word, 1, text, strcspn(text, " \t")) == 0;
}

static cw_status read_files(metaimage *m, cwi_source *src, cw_error *err)
{
    const char *name = m->value[K_DATA_FILE];
    int64_t depth = (int64_t)m->dimensions - 1;
    cw_status st;
    if (is_word(name, "local")) {
        src->offset = m->lines.next;
        return CW_OK;
    }
    if (is_word(name, "list"))
        st = read_list(m, src, &depth, err);
    else if (strchr(name, '%'))
        st = cwi_names_expand(&src->files, name, &depth, err);
    else
        return cwi_names_add(&src->files, name, err);
    return st == CW_OK ? check_file_count(m, src, depth, err) : st;
}

/* Reads HeaderSize, which counts from the start of the file with the voxels, in a LOCAL file
 * too. */
static cw_status read_header_size(const metaimage *m, cwi_source *src, cw_error *err)
{
    int64_t size = 0;
    if (!m->value[K_HEADER_SIZE])
        return CW_OK;
    cw_status st =
        cwi_field_integer("HeaderSize", m->value[K_HEADER_SIZE], -1, INT64_MAX, &size, err);
    if (st == CW_OK && size < 0 && src->encoding != CWI_RAW)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'HeaderSize' is -1; that needs binary data, uncompressed");
    src->at_end = size < 0;
    if (size > 0)
        src->offset = (uint64_t)size;
    return st;
}

/* Reads the compressed size. 0 means an unknown size. With several files it is unclear to which
 * one it belongs. */
static cw_status read_compressed_size(const metaimage *m, cwi_source *src, cw_error *err)
{
    int64_t size = 0;
    if (src->encoding != CWI_DEFLATED || !m->value[K_COMPRESSED_SIZE] || src->files.count > 1)
        return CW_OK;
    cw_status st = cwi_field_integer("CompressedDataSize", m->value[K_COMPRESSED_SIZE], 0,
                                     INT64_MAX, &size, err);
    src->packed = (uint64_t)size;
    return st;
}

static cw_status read_encoding(const metaimage *m, cwi_source *src, cw_error *err)
{
    bool binary = true, compressed = false;
    cw_status st = read_bool(m, K_BINARY, "BinaryData", &binary, err);
    if (st == CW_OK)
        st = read_bool(m, K_COMPRESSED, "CompressedData", &compressed, err);
    if (st == CW_OK)
        st = read_bool(m, K_MSB, "BinaryDataByteOrderMSB", &src->big_endian, err);
    src->encoding = compressed ? CWI_DEFLATED : binary ? CWI_RAW : CWI_ASCII;
    return st;
}

/* --- frame ------------------------------------------------------------------------------- */

/* Reads numbers of a key into a row, which keeps its defaults when the key is missing. */
static cw_status read_numbers(const metaimage *m, key k, const char *name, size_t count,
                              double *out, cw_error *err)
{
    return m->value[k] ? cwi_field_doubles(name, m->value[k], count, "NDims", out, err) : CW_OK;
}

static cw_status read_unit(const metaimage *m, double *mm, cw_error *err)
{
    static const char *const names[] = {"?", "mm", "cm", "um"};
    static const double scales[] = {1, 1, 10, 1e-3};
    const char *value = m->value[K_UNITS];
    const int found = value ? cwi_field_find(names, 4, value, strlen(value)) : 0;
    if (found < 0)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'DistanceUnits' is '%.40s'; it must be mm, cm or um", value);
    *mm = scales[found];
    return CW_OK;
}

/* Sets the affine. Row i of the matrix is the direction of axis i, as in ITK. A time axis has a
 * row in it, but does not turn anything. */
static void set_affine(const metaimage *m, const double *spacing, const double *matrix,
                       const double *origin, double mm, cw_volume *shape)
{
    const size_t n = m->dimensions;
    for (size_t r = 0; r < 3; r++) {
        for (size_t c = 0; c < 3; c++)
            shape->affine[r][c] = r < n && c < n ? matrix[c * n + r] * spacing[c] * mm
                                  : r == c       ? 1
                                                 : 0;
        shape->affine[r][3] = r < n ? origin[r] * mm : 0;
    }
    shape->known = n < 3 ? 0 : CW_KNOWN_UNIT | CW_KNOWN_FRAME;
    shape->said_unit_mm = mm;
}

static cw_status read_frame(const metaimage *m, cwi_source *src, cw_error *err)
{
    const size_t n = m->dimensions;
    double spacing[MAX_AXES] = {1, 1, 1, 1}, origin[MAX_AXES] = {0}, mm = 1;
    double matrix[MAX_AXES * MAX_AXES] = {0};
    for (size_t a = 0; a < n; a++)
        matrix[a * n + a] = 1;
    src->frame_field = "TransformMatrix, ElementSpacing, Offset";
    const bool sized = !m->value[K_SPACING];
    cw_status st = read_numbers(m, sized ? K_ELEMENT_SIZE : K_SPACING,
                                sized ? "ElementSize" : "ElementSpacing", n, spacing, err);
    if (st == CW_OK)
        st = read_numbers(m, K_OFFSET, "Offset", n, origin, err);
    if (st == CW_OK)
        st = read_numbers(m, K_MATRIX, "TransformMatrix", n * n, matrix, err);
    if (st == CW_OK)
        st = read_unit(m, &mm, err);
    if (st == CW_OK)
        set_affine(m, spacing, matrix, origin, mm, &src->shape);
    return st;
}

/* Reads the line that turns stored numbers into values. */
static cw_status read_scaling(const metaimage *m, cw_volume *shape, cw_error *err)
{
    static const char *const names[] = {"ElementToIntensityFunctionSlope",
                                        "ElementToIntensityFunctionOffset"};
    double line[2] = {1, 0};
    cw_status st = CW_OK;
    for (int i = 0; st == CW_OK && i < 2; i++) {
        const char *text = m->value[i ? K_VALUE_OFFSET : K_VALUE_SLOPE];
        if (text)
            st = cwi_field_doubles(names[i], text, 1, names[i], &line[i], err);
        if (st == CW_OK && !isfinite(line[i]))
            st = cwi_fail(err, CW_ERR_FORMAT, "'%s' is %g; it must be finite", names[i],
                          line[i]);
    }
    if (st == CW_OK && line[0] == 0)
        return cwi_fail(err, CW_ERR_FORMAT, "'%s' is 0, which gives all voxels one value",
                        names[0]);
    shape->slope = line[0];
    shape->intercept = line[1];
    return st;
}

cw_status cwi_metaimage_parse(const cwi_input *in, cwi_source *src, cw_error *err)
{
    metaimage m = {0};
    src->size_field = "DimSize";
    src->is_last = true;
    src->shape.slope = 1;
    cw_status st = cwi_lines_open(&m.lines, in, err);
    if (st == CW_OK)
        st = read_keys(&m, err);
    if (st == CW_OK)
        st = read_type(&m, src, err);
    if (st == CW_OK)
        st = read_sizes(&m, src, err);
    if (st == CW_OK)
        st = read_encoding(&m, src, err);
    if (st == CW_OK)
        st = read_files(&m, src, err);
    if (st == CW_OK)
        st = read_header_size(&m, src, err);
    if (st == CW_OK)
        st = read_compressed_size(&m, src, err);
    if (st == CW_OK)
        st = read_frame(&m, src, err);
    if (st == CW_OK)
        st = read_scaling(&m, &src->shape, err);
    cwi_lines_close(&m.lines);
    return st;
}
