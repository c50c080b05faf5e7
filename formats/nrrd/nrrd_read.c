/* Reads the header of NRRD; the order of the fields here is the one in which later ones need
 * earlier ones. Defined at teem.sourceforge.net/nrrd/format.html. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/bzip2.h"
#include "formats/nrrd/nrrd.h"
#include "formats/nrrd/nrrd_format.h"

#include <math.h>
#include <string.h>

static const char *const field_names[CWI_NRRD_FIELD_COUNT] = {
    [CWI_NRRD_TYPE] = "type",
    [CWI_NRRD_DIMENSION] = "dimension",
    [CWI_NRRD_SIZES] = "sizes",
    [CWI_NRRD_ENCODING] = "encoding",
    [CWI_NRRD_ENDIAN] = "endian",
    [CWI_NRRD_SPACE] = "space",
    [CWI_NRRD_SPACE_DIMENSION] = "spacedimension",
    [CWI_NRRD_SPACE_DIRECTIONS] = "spacedirections",
    [CWI_NRRD_SPACE_ORIGIN] = "spaceorigin",
    [CWI_NRRD_SPACE_UNITS] = "spaceunits",
    [CWI_NRRD_SPACINGS] = "spacings",
    [CWI_NRRD_AXIS_MINS] = "axismins",
    [CWI_NRRD_AXIS_MAXS] = "axismaxs",
    [CWI_NRRD_CENTERS] = "centers|centerings",
    [CWI_NRRD_KINDS] = "kinds",
    [CWI_NRRD_UNITS] = "units",
    [CWI_NRRD_DATA_FILE] = "datafile",
    [CWI_NRRD_LINE_SKIP] = "lineskip",
    [CWI_NRRD_BYTE_SKIP] = "byteskip",
    [CWI_NRRD_IGNORED] =
        ("content|number|thicknesses|labels|sampleunits|measurementframe|min|max|"
         "oldmin|oldmax|blocksize"),
};

/* The kinds of axes: of space, of time, or of values that belong to one voxel. */

static const struct {
    const char *names;
    cw_type type;
    cwi_stored stored;
} types[] = {
    {"signedchar|int8|int8_t", CW_I8, 0},
    {"uchar|unsignedchar|uint8|uint8_t", CW_U8, 0},
    {"short|shortint|signedshort|signedshortint|int16|int16_t", CW_I16, 0},
    {"ushort|unsignedshort|unsignedshortint|uint16|uint16_t", CW_U16, 0},
    {"int|signedint|int32|int32_t", CW_I32, 0},
    {"uint|unsignedint|uint32|uint32_t", CW_U32, 0},
    {("longlong|longlongint|signedlonglong|signedlonglongint|int64|int64_t"), CW_I32,
     CWI_STORED_I64},
    {"ulonglong|unsignedlonglong|unsignedlonglongint|uint64|uint64_t", CW_U32, CWI_STORED_U64},
    {"float", CW_F32, 0},
    {"double", CW_F64, 0},
    {"half|float16", CW_F32, CWI_STORED_F16},
};

bool cwi_nrrd_sniff(const unsigned char *head, size_t size)
{
    return size >= 8 && memcmp(head, "NRRD000", 7) == 0;
}

/* --- lines to fields --------------------------------------------------------------------- */

static cw_status read_magic(cwi_nrrd *n, cw_error *err)
{
    char *line;
    cw_status st = cwi_lines_next(&n->lines, &line, err);
    if (st != CW_OK)
        return st;
    if (!line || strncmp(line, "NRRD000", 7) != 0)
        return cwi_fail(err, CW_ERR_FORMAT, "the first line is not 'NRRD0001' to 'NRRD0005'");
    if (line[7] < '1' || line[7] > '5' || line[8])
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the version is '%.20s'; NRRD0001 to NRRD0005 are read", line);
    return CW_OK;
}

static cw_status keep_field(cwi_nrrd *n, char *line, cw_error *err)
{
    char *colon = strchr(line, ':');
    if (!colon)
        return cwi_fail(err, CW_ERR_FORMAT, "line %zu holds no 'field: value'",
                        n->lines.number);
    if (colon[1] == '=') /* a private key: Slicer names the segments of a label map */
        return cwi_nrrd_keep_segment(n, line, colon + 2, err);
    const int f =
        cwi_field_find(field_names, CWI_NRRD_FIELD_COUNT, line, (size_t)(colon - line));
    if (f < 0)
        return cwi_fail(err, CW_ERR_FORMAT, "line %zu: '%.*s' is not a field of NRRD",
                        n->lines.number, (int)(colon - line < 60 ? colon - line : 60), line);
    if (n->value[f] && f != CWI_NRRD_IGNORED)
        return cwi_fail(err, CW_ERR_FORMAT, "line %zu: the field '%.*s' appears a second time",
                        n->lines.number, (int)(colon - line < 60 ? colon - line : 60), line);
    n->value[f] = colon + 1 + strspn(colon + 1, " \t");
    return CW_OK;
}

static bool is_list(const char *data_file)
{
    return data_file && strncmp(data_file, "LIST", 4) == 0 &&
           (data_file[4] == '\0' || data_file[4] == ' ');
}

/* Reads the fields. The header ends at an empty line, at the file's end, or where a list of
 * files starts. */
static cw_status read_fields(cwi_nrrd *n, cw_error *err)
{
    char *line;
    cw_status st = read_magic(n, err);
    while (st == CW_OK && !is_list(n->value[CWI_NRRD_DATA_FILE])) {
        st = cwi_lines_next(&n->lines, &line, err);
        if (st != CW_OK || !line || !*line)
            break;
        if (*line != '#')
            st = keep_field(n, line, err);
    }
    return st;
}

static cw_status require_field(const cwi_nrrd *n, cwi_nrrd_field f, cw_error *err)
{
    return n->value[f]
               ? CW_OK
               : cwi_fail(err, CW_ERR_FORMAT, "the field '%s' is missing", field_names[f]);
}

/* --- type of the voxels ------------------------------------------------------------------ */

static cw_status read_sizes(cwi_nrrd *n, cw_error *err)
{
    size_t sizes[CWI_NRRD_MAX_AXES];
    int64_t dimension = 0;
    cw_status st = require_field(n, CWI_NRRD_DIMENSION, err);
    if (st == CW_OK)
        st = cwi_field_integer("dimension", n->value[CWI_NRRD_DIMENSION], 1, CWI_NRRD_MAX_AXES,
                               &dimension, err);
    n->dimension = (size_t)dimension;
    if (st == CW_OK)
        st = require_field(n, CWI_NRRD_SIZES, err);
    if (st == CW_OK)
        st = cwi_field_sizes("sizes", n->value[CWI_NRRD_SIZES], n->dimension, "dimension",
                             sizes, err);
    for (size_t a = 0; st == CW_OK && a < n->dimension; a++) {
        n->axis[a].size = sizes[a];
        n->spacing[a] = n->min[a] = n->max[a] = NAN;
    }
    return st;
}

static cw_status read_type(const cwi_nrrd *n, cwi_source *src, cw_error *err)
{
    cw_status st = require_field(n, CWI_NRRD_TYPE, err);
    if (st != CW_OK)
        return st;
    const char *name = n->value[CWI_NRRD_TYPE];
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (cwi_field_find(&types[i].names, 1, name, strlen(name)) == 0) {
            src->shape.type = types[i].type;
            src->stored = types[i].stored;
            return CW_OK;
        }
    return cwi_fail_type(err, "type", name);
}

static cw_status read_encoding(const cwi_nrrd *n, cwi_source *src, cw_error *err)
{
    static const char *const names[] = {[CWI_RAW] = "raw",
                                        [CWI_DEFLATED] = "gzip|gz",
                                        [CWI_BZIP2] = "bzip2|bz2",
                                        [CWI_ASCII] = "ascii|text|txt",
                                        [CWI_HEX] = "hex"};
    const int count = sizeof names / sizeof *names;
    cw_status st = require_field(n, CWI_NRRD_ENCODING, err);
    if (st != CW_OK)
        return st;
    const char *name = n->value[CWI_NRRD_ENCODING];
    const int found = cwi_field_find(names, count, name, strlen(name));
    if (found < 0)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'encoding' is %.40s; those that are read are raw, gzip, bzip2, ascii "
                        "and hex",
                        name);
    if (found == CWI_BZIP2 && !cwi_bzip2_present())
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "'encoding' is %.40s; this build has no libbz2 (libbz2-dev, "
                        "CUBEWRIGHT_BZIP2)",
                        name);
    src->encoding = (cwi_encoding)found;
    return CW_OK;
}

static cw_status read_endian(const cwi_nrrd *n, cwi_source *src, cw_error *err)
{
    static const char *const names[] = {"little", "big"};
    const char *name = n->value[CWI_NRRD_ENDIAN];
    const int found = name ? cwi_field_find(names, 2, name, strlen(name)) : -1;
    const bool matters = cw_type_size(src->shape.type) > 1 && src->encoding != CWI_ASCII;
    src->big_endian = found == 1;
    if (found >= 0 || (!name && !matters))
        return CW_OK;
    if (!name)
        return cwi_fail(err, CW_ERR_FORMAT, "the field 'endian' is missing; %s voxels need it",
                        cw_type_name(src->shape.type));
    return cwi_fail(err, CW_ERR_FORMAT, "'endian' is '%.40s'; it must be little or big", name);
}

/* --- place of the voxels ----------------------------------------------------------------- */

static cw_status read_skips(const cwi_nrrd *n, cwi_source *src, cw_error *err)
{
    int64_t lines = 0, bytes = 0;
    cw_status st = CW_OK;
    if (n->value[CWI_NRRD_LINE_SKIP])
        st = cwi_field_integer("line skip", n->value[CWI_NRRD_LINE_SKIP], 0, INT64_MAX, &lines,
                               err);
    if (st == CW_OK && n->value[CWI_NRRD_BYTE_SKIP])
        st = cwi_field_integer("byte skip", n->value[CWI_NRRD_BYTE_SKIP], -1, INT64_MAX, &bytes,
                               err);
    if (st == CW_OK && bytes < 0 && src->encoding != CWI_RAW)
        return cwi_fail(err, CW_ERR_FORMAT, "'byte skip' is -1; that needs the raw encoding");
    src->lines = (uint64_t)lines;
    src->is_last = true;
    src->at_end = bytes < 0;
    src->skip = bytes > 0 ? (uint64_t)bytes : 0;
    return st;
}

/* Checks the number of files of `depth` axes each: one axis fewer than the voxels, unless
 * stated. */
static cw_status check_file_count(const cwi_nrrd *n, const cwi_source *src, int64_t depth,
                                  cw_error *err)
{
    size_t expected = 1;
    if (depth < 1 || depth > (int64_t)n->dimension)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'data file' gives its files %lld axes; 'dimension' says %zu",
                        (long long)depth, n->dimension);
    for (size_t a = (size_t)depth; a < n->dimension; a++)
        expected *= expected <= INT32_MAX ? n->axis[a].size : 1;
    if (src->files.count != expected)
        return cwi_fail(err, CW_ERR_FORMAT, "'data file' names %zu files; 'sizes' needs %zu",
                        src->files.count, expected);
    return CW_OK;
}

static cw_status read_list(cwi_nrrd *n, cwi_source *src, int64_t *depth, cw_error *err)
{
    const char *count = n->value[CWI_NRRD_DATA_FILE] + 4;
    cw_status st = CW_OK;
    count += strspn(count, " \t");
    if (*count)
        st = cwi_field_integer("data file: LIST", count, 1, CWI_NRRD_MAX_AXES, depth, err);
    return st == CW_OK ? cwi_lines_names(&n->lines, &src->files, err) : st;
}

static cw_status read_files(cwi_nrrd *n, cwi_source *src, cw_error *err)
{
    const char *name = n->value[CWI_NRRD_DATA_FILE];
    int64_t depth = n->dimension > 1 ? (int64_t)n->dimension - 1 : 1;
    cw_status st;
    src->offset = name ? 0 : n->lines.next;
    if (!name)
        return CW_OK;
    if (is_list(name))
        st = read_list(n, src, &depth, err);
    else if (strchr(name, '%'))
        st = cwi_names_expand(&src->files, name, &depth, err);
    else
        return cwi_names_add(&src->files, name, err);
    return st == CW_OK ? check_file_count(n, src, depth, err) : st;
}

static cw_status check_voxels_follow(const cwi_input *in, const cwi_source *src, cw_error *err)
{
    if (src->files.count || src->offset < in->size)
        return CW_OK;
    return cwi_fail(
        err, CW_ERR_FORMAT,
        "the file ends with its header: no 'data file' is named and no voxels follow an "
        "empty line");
}

cw_status cwi_nrrd_parse(const cwi_input *in, cwi_source *src, cw_error *err)
{
    cwi_nrrd n = {.wants_segments = in->labels != NULL};
    cw_status st = cwi_lines_open(&n.lines, in, err);
    if (st == CW_OK)
        st = read_fields(&n, err);
    src->size_field = "sizes";
    src->frame_field = n.value[CWI_NRRD_SPACE_DIRECTIONS] ? "space directions" : "spacings";
    src->shape.slope = 1;
    if (st == CW_OK)
        st = read_sizes(&n, err);
    if (st == CW_OK)
        st = read_type(&n, src, err);
    if (st == CW_OK)
        st = read_encoding(&n, src, err);
    if (st == CW_OK)
        st = read_endian(&n, src, err);
    if (st == CW_OK)
        st = read_skips(&n, src, err);
    if (st == CW_OK)
        st = read_files(&n, src, err);
    if (st == CW_OK)
        st = cwi_nrrd_describe(&n, src, err);
    if (st == CW_OK)
        st = check_voxels_follow(in, src, err);
    if (st == CW_OK && in->labels)
        st = cwi_nrrd_read_segments(&n, src, in->labels, err);
    cwi_free(n.segment_keys);
    cwi_lines_close(&n.lines);
    return st;
}
