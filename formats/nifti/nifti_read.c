/* Reads NIfTI-1 and NIfTI-2: headers of fixed layout (nifti.nimh.nih.gov); and Analyze 7.5, from which
 * the first one came: it has no magic, and no frame. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/byte_order.h"
#include "formats/bytes/file_pattern.h"
#include "formats/bytes/inflate_stream.h"
#include "formats/nifti/nifti.h"
#include "formats/nifti/nifti_format.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const cwi_nifti_layout cwi_nifti_layouts[2] = {
    {348,
     352,
     344,
     4,
     "n+1",
     "ni1",
     148,
     {[CWI_NIFTI_SIZEOF_HDR] = {0, 'i'},
      [CWI_NIFTI_DATATYPE] = {70, 'h'},
      [CWI_NIFTI_BITPIX] = {72, 'h'},
      [CWI_NIFTI_DIM] = {40, 'h'},
      [CWI_NIFTI_PIXDIM] = {76, 'f'},
      [CWI_NIFTI_VOX_OFFSET] = {108, 'f'},
      [CWI_NIFTI_SCL_SLOPE] = {112, 'f'},
      [CWI_NIFTI_SCL_INTER] = {116, 'f'},
      [CWI_NIFTI_QFORM_CODE] = {252, 'h'},
      [CWI_NIFTI_SFORM_CODE] = {254, 'h'},
      [CWI_NIFTI_QUATERN] = {256, 'f'},
      [CWI_NIFTI_QOFFSET] = {268, 'f'},
      [CWI_NIFTI_SROW] = {280, 'f'},
      [CWI_NIFTI_XYZT_UNITS] = {123, 'b'},
      [CWI_NIFTI_INTENT_CODE] = {68, 'h'}}},
    {540,
     544,
     4,
     8,
     "n+2\0\r\n\032\n",
     "ni2\0\r\n\032\n",
     240,
     {[CWI_NIFTI_SIZEOF_HDR] = {0, 'i'},
      [CWI_NIFTI_DATATYPE] = {12, 'h'},
      [CWI_NIFTI_BITPIX] = {14, 'h'},
      [CWI_NIFTI_DIM] = {16, 'l'},
      [CWI_NIFTI_PIXDIM] = {104, 'd'},
      [CWI_NIFTI_VOX_OFFSET] = {168, 'l'},
      [CWI_NIFTI_SCL_SLOPE] = {176, 'd'},
      [CWI_NIFTI_SCL_INTER] = {184, 'd'},
      [CWI_NIFTI_QFORM_CODE] = {344, 'i'},
      [CWI_NIFTI_SFORM_CODE] = {348, 'i'},
      [CWI_NIFTI_QUATERN] = {352, 'd'},
      [CWI_NIFTI_QOFFSET] = {376, 'd'},
      [CWI_NIFTI_SROW] = {400, 'd'},
      [CWI_NIFTI_XYZT_UNITS] = {500, 'i'},
      [CWI_NIFTI_INTENT_CODE] = {504, 'i'}}},
};

static const struct {
    int code;
    int type; /* cw_type, or -1: refused */
    size_t components;
    const char *name;
} datatypes[] = {
    {2, CW_U8, 1, "uint8"},      {4, CW_I16, 1, "int16"},     {8, CW_I32, 1, "int32"},
    {16, CW_F32, 1, "float32"},  {64, CW_F64, 1, "float64"},  {256, CW_I8, 1, "int8"},
    {512, CW_U16, 1, "uint16"},  {768, CW_U32, 1, "uint32"},  {128, CW_U8, 3, "RGB24"},
    {2304, CW_U8, 4, "RGBA32"},  {1, -1, 1, "1-bit binary"},  {32, -1, 1, "complex64"},
    {1024, CW_I32, 1, "int64"},  {1280, CW_U32, 1, "uint64"}, {1536, -1, 1, "float128"},
    {1792, -1, 1, "complex128"}, {2048, -1, 1, "complex256"},
};

/* Returns the form of numbers that voxels do not have. */
static cwi_stored stored_of(int code)
{
    return code == 1024 ? CWI_STORED_I64 : code == 1280 ? CWI_STORED_U64 : CWI_STORED_PLAIN;
}

int cwi_nifti_datatype(cw_type type)
{
    int i = 0;
    while (datatypes[i].type != (int)type)
        i++;
    return datatypes[i].code;
}

/* --- fields ------------------------------------------------------------------------------ */

/* A number of any kind. */
typedef union number {
    unsigned char bytes[8];
    int8_t b;
    int16_t h;
    int32_t i;
    int64_t l;
    float f;
    double d;
} number;

static size_t kind_size(char kind)
{
    return kind == 'b' ? 1 : kind == 'h' ? 2 : kind == 'i' || kind == 'f' ? 4 : 8;
}

double cwi_nifti_get(const cwi_nifti_layout *layout, const unsigned char *header, bool swapped,
                     cwi_nifti_field field, int index)
{
    const char kind = layout->field[field].kind;
    const size_t size = kind_size(kind);
    number n;
    memcpy(n.bytes, header + layout->field[field].offset + (size_t)index * size, size);
    if (swapped)
        cwi_swap_bytes(&n, 1, size);
    return kind == 'b'   ? n.b
           : kind == 'h' ? n.h
           : kind == 'i' ? n.i
           : kind == 'l' ? (double)n.l
           : kind == 'f' ? (double)n.f
                         : n.d;
}

void cwi_nifti_put(const cwi_nifti_layout *layout, unsigned char *header, cwi_nifti_field field,
                   int index, double value)
{
    const char kind = layout->field[field].kind;
    const size_t size = kind_size(kind);
    number n;
    switch (kind) {
    case 'b':
        n.b = (int8_t)value;
        break;
    case 'h':
        n.h = (int16_t)value;
        break;
    case 'i':
        n.i = (int32_t)value;
        break;
    case 'l':
        n.l = (int64_t)value;
        break;
    case 'f':
        n.f = (float)value;
        break;
    default:
        n.d = value;
    }
    memcpy(header + layout->field[field].offset + (size_t)index * size, n.bytes, size);
}

/* --- the header -------------------------------------------------------------------------- */

/* The header's bytes, and their layout and byte order. */
typedef struct nifti {
    unsigned char bytes[CWI_NIFTI_MAX_HEADER];
    const cwi_nifti_layout *layout;
    bool swapped;
    bool is_pair;    /* the voxels are in a separate file */
    bool is_analyze; /* Analyze 7.5 */
    bool gzipped;
    const char *image; /* name of the file of voxels, where it was the one that was named */
    int used;          /* number of dimensions: dim[0] */
} nifti;

static double get_field(const nifti *n, cwi_nifti_field field, int index)
{
    return cwi_nifti_get(n->layout, n->bytes, n->swapped, field, index);
}

/* Finds the version and the byte order for which sizeof_hdr is right. */
static bool find_layout(nifti *n)
{
    for (int i = 0; i < 4; i++) {
        n->layout = &cwi_nifti_layouts[i / 2];
        n->swapped = i % 2;
        if (get_field(n, CWI_NIFTI_SIZEOF_HDR, 0) == (double)n->layout->bytes)
            return true;
    }
    return false;
}

/* Checks the magic. The newlines in NIfTI-2's magic show if a text transfer has damaged the
 * file. */
static bool has_magic(const nifti *n, const char *magic)
{
    return memcmp(n->bytes + n->layout->magic, magic, n->layout->magic_bytes) == 0;
}

bool cwi_nifti_sniff(const unsigned char *head, size_t size)
{
    nifti n = {0};
    memcpy(n.bytes, head, size < CWI_NIFTI_MAX_HEADER ? size : CWI_NIFTI_MAX_HEADER);
    return size >= 348 && find_layout(&n) &&
           (has_magic(&n, n.layout->one_file) || has_magic(&n, n.layout->pair));
}

static cw_status read_header(const cwi_input *in, nifti *n, cw_error *err)
{
    size_t got;
    cw_status st = cwi_stream_head(in->fd, n->bytes, sizeof n->bytes, &got, &n->gzipped, err);
    if (st != CW_OK)
        return st;
    const char *inside = n->gzipped ? "inside the gzip file, " : "";
    if (got < 4 || !find_layout(n)) {
        n->swapped = false;
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "%s'sizeof_hdr' is %.0f; a header of NIfTI or Analyze starts with 348 or 540",
            inside, got < 4 ? 0.0 : get_field(n, CWI_NIFTI_SIZEOF_HDR, 0));
    }
    if (got < n->layout->bytes)
        return cwi_fail(err, CW_ERR_FORMAT, "%sthe header ends after %zu of %zu bytes", inside,
                        got, n->layout->bytes);
    const bool is_one_file = has_magic(n, n->layout->one_file);
    const bool is_first = n->layout == &cwi_nifti_layouts[0];
    n->is_analyze = !is_one_file && !has_magic(n, n->layout->pair) && is_first;
    n->is_pair = has_magic(n, n->layout->pair) || n->is_analyze;
    if (!n->is_pair && !is_one_file)
        return cwi_fail(err, CW_ERR_FORMAT, "%s'magic' is neither '%s' nor '%s'", inside,
                        n->layout->one_file, n->layout->pair);
    if (n->is_analyze && !cwi_has_extension(in->path, ".hdr .hdr.gz"))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "%s'magic' is neither '%s' nor '%s', and the header of an Analyze 7.5 pair "
            "would be named .hdr",
            inside, n->layout->one_file, n->layout->pair);
    return CW_OK;
}

/* --- voxels ------------------------------------------------------------------------------ */

static cw_status read_type(const nifti *n, cwi_source *src, size_t *components, cw_error *err)
{
    const int code = (int)get_field(n, CWI_NIFTI_DATATYPE, 0);
    const int bits = (int)get_field(n, CWI_NIFTI_BITPIX, 0);
    char name[40];
    snprintf(name, sizeof name, "%d", code);
    for (size_t i = 0; i < sizeof datatypes / sizeof *datatypes; i++) {
        if (datatypes[i].code != code)
            continue;
        snprintf(name, sizeof name, "%d (%s)", code, datatypes[i].name);
        if (datatypes[i].type < 0)
            break;
        src->shape.type = (cw_type)datatypes[i].type;
        src->stored = stored_of(code);
        *components = datatypes[i].components;
        const int expected =
            (int)(8 * *components * cwi_stored_size(src->stored, src->shape.type));
        if (bits == 0 || bits == expected)
            return CW_OK;
        return cwi_fail(err, CW_ERR_FORMAT, "'bitpix' is %d; 'datatype' %s has %d", bits, name,
                        expected);
    }
    return cwi_fail_type(err, "datatype", name);
}

/* Reads the sizes. dim[5] counts values per voxel, stored as one whole series of volumes after
 * another. */
static cw_status read_dims(nifti *n, cwi_source *src, size_t colours, cw_error *err)
{
    static const cwi_role roles[8] = {[1] = CWI_AXIS_X,
                                      [2] = CWI_AXIS_Y,
                                      [3] = CWI_AXIS_Z,
                                      [4] = CWI_AXIS_STEP,
                                      [5] = CWI_AXIS_COMPONENT};
    cwi_axis axes[6] = {{CWI_AXIS_COMPONENT, colours}};
    size_t count = colours > 1 ? 1 : 0;
    const double used = get_field(n, CWI_NIFTI_DIM, 0);
    if (!(used >= 1 && used <= 7))
        return cwi_fail(err, CW_ERR_FORMAT, "'dim[0]' is %.0f; it must be 1 to 7", used);
    n->used = (int)used;
    for (int d = 1; d <= n->used; d++) {
        const double size = get_field(n, CWI_NIFTI_DIM, d);
        if (!(size >= 1 && size <= INT32_MAX))
            return cwi_fail(err, CW_ERR_FORMAT, "'dim[%d]' is %.0f; sizes are 1 to 2147483647",
                            d, size);
        if (size > 1 && (d > 5 || (d == 5 && colours > 1)))
            return cwi_fail(err, CW_ERR_FORMAT, "'dim[%d]' is %.0f; only 1 is read%s", d, size,
                            d == 5 ? " with colours" : "");
        if (size > 1 || d < 4)
            axes[count++] = (cwi_axis){roles[d], (size_t)size};
    }
    return cwi_source_set_axes(src, axes, count, err);
}

/* Names the file of voxels: "head.hdr.gz" belongs to "head.img.gz". */
static cw_status name_image(const cwi_input *in, const nifti *n, cwi_source *src, cw_error *err)
{
    if (n->image)
        return cwi_names_add(&src->files, n->image, err);
    const char *slash = strrchr(in->path, '/');
    char *name = cwi_strdup(slash ? slash + 1 : in->path);
    if (!name)
        return cwi_fail_memory(err);
    const bool lower = cwi_has_extension(name, ".hdr .hdr.gz");
    char *extension = NULL;
    for (char *s = name; lower && (s = strstr(s, ".hdr")); s++)
        extension = s;
    cw_status st = CW_OK;
    if (extension) {
        memcpy(extension, ".img", 4);
        st = cwi_names_add(&src->files, name, err);
    } else {
        st = cwi_fail(
            err, CW_ERR_FORMAT,
            "'magic' says that the voxels are in a second file; the header of such a pair "
            "must be named .hdr");
    }
    cwi_free(name);
    return st;
}

/* Returns true if the voxels are gzip data, as their header is, or as their name tells. */
static bool is_packed(const nifti *n)
{
    return n->image ? cwi_has_extension(n->image, ".gz") : n->gzipped;
}

static cw_status find_voxels(const cwi_input *in, const nifti *n, cwi_source *src,
                             cw_error *err)
{
    double offset = get_field(n, CWI_NIFTI_VOX_OFFSET, 0);
    const double min = n->is_pair ? 0 : (double)n->layout->voxels;
    if (offset == 0)
        offset = min;
    if (!(offset >= min && offset < 0x1p53) || offset != floor(offset))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'vox_offset' is %g; it must be a whole number of at least %.0f",
                        offset, min);
    src->skip = (uint64_t)offset;
    src->is_last = true;
    src->encoding = is_packed(n) ? CWI_DEFLATED : CWI_RAW;
    src->big_endian = n->swapped != cwi_machine_is_big_endian();
    return n->is_pair ? name_image(in, n, src, err) : CW_OK;
}

/* Reads slope and intercept. A slope that is 0 or not finite means no scaling. Colours are
 * never scaled. */
static void read_scaling(const nifti *n, size_t colours, cw_volume *shape)
{
    const double slope = get_field(n, CWI_NIFTI_SCL_SLOPE, 0);
    const double intercept = get_field(n, CWI_NIFTI_SCL_INTER, 0);
    shape->slope = 1;
    if (colours > 1 || slope == 0 || !isfinite(slope) || !isfinite(intercept))
        return;
    shape->slope = slope;
    shape->intercept = intercept;
}

/* --- frame ------------------------------------------------------------------------------- */

/* Reads the spacings, which must be positive; an axis with one voxel may have none. */
static cw_status read_spacing(const nifti *n, double spacing[3], cw_error *err)
{
    for (int a = 0; a < 3; a++) {
        const double size = a < n->used ? get_field(n, CWI_NIFTI_DIM, a + 1) : 1;
        spacing[a] = fabs(get_field(n, CWI_NIFTI_PIXDIM, a + 1));
        if (spacing[a] > 0 && isfinite(spacing[a]))
            continue;
        if (size > 1)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'pixdim[%d]' is %g; it must be finite and not 0", a + 1,
                            get_field(n, CWI_NIFTI_PIXDIM, a + 1));
        spacing[a] = 1;
    }
    return CW_OK;
}

static cw_status check_quaternion(const double q[4], cw_error *err)
{
    if (isfinite(q[1]) && isfinite(q[2]) && isfinite(q[3]))
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'quatern_b', 'c', 'd' are %g %g %g; they must be finite", q[1], q[2],
                    q[3]);
}

/* Reads the frame by method 2: a rotation by a unit quaternion whose first number is computed
 * from the others. Where rounding made their length more than 1, it is a half turn. */
static cw_status read_qform(const nifti *n, cw_volume *shape, cw_error *err)
{
    double spacing[3], q[4] = {0};
    for (int i = 0; i < 3; i++)
        q[i + 1] = get_field(n, CWI_NIFTI_QUATERN, i);
    cw_status st = check_quaternion(q, err);
    if (st == CW_OK)
        st = read_spacing(n, spacing, err);
    if (st != CW_OK)
        return st;
    const double vector_sq = q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    const double length = vector_sq > 1 - 1e-7 ? sqrt(vector_sq) : 1;
    q[0] = length == 1 && vector_sq < 1 ? sqrt(1 - vector_sq) : 0;
    const double a = q[0], b = q[1] / length, c = q[2] / length, d = q[3] / length;
    const double rotation[3][3] = {
        {a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
        {2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
        {2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c}};
    if (get_field(n, CWI_NIFTI_PIXDIM, 0) < 0)
        spacing[2] = -spacing[2]; /* qfac: the third axis is mirrored */
    for (int r = 0; r < 3; r++) {
        for (int k = 0; k < 3; k++)
            shape->affine[r][k] = rotation[r][k] * spacing[k];
        shape->affine[r][3] = get_field(n, CWI_NIFTI_QOFFSET, r);
    }
    return CW_OK;
}

static void read_sform(const nifti *n, cw_volume *shape)
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            shape->affine[r][c] = get_field(n, CWI_NIFTI_SROW, 4 * r + c);
}

static cw_status read_pixdim(const nifti *n, cw_volume *shape, cw_error *err)
{
    double spacing[3];
    cw_status st = read_spacing(n, spacing, err);
    for (int a = 0; a < 3 && st == CW_OK; a++)
        shape->affine[a][a] = spacing[a];
    return st;
}

static void read_units(const nifti *n, cw_volume *shape)
{
    static const double mm[8] = {[1] = 1000, [2] = 1, [3] = 1e-3};
    static const double seconds[8] = {[1] = 1, [2] = 1e-3, [3] = 1e-6};
    const unsigned units = (unsigned)(int32_t)get_field(n, CWI_NIFTI_XYZT_UNITS, 0);
    const double scale = mm[units & 7];
    const double step = get_field(n, CWI_NIFTI_PIXDIM, 4) * seconds[units >> 3 & 7];
    if (n->used > 3 && step > 0 && isfinite(step))
        shape->step_seconds = step;
    if (scale == 0)
        return;
    shape->known |= CW_KNOWN_UNIT;
    shape->said_unit_mm = scale;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            shape->affine[r][c] *= scale;
}

/* Marks labels: NIFTI_INTENT_LABEL, NIFTI_INTENT_NEURONAME. */
static void read_intent(const nifti *n, cw_volume *shape)
{
    const double code = get_field(n, CWI_NIFTI_INTENT_CODE, 0);
    if (code == 1002 || code == 1005)
        shape->known |= CW_KNOWN_LABELS;
}

/* Reads the names of labels, for the caller if he wants them. A volume that has some is one of
 * labels. */
static cw_status read_labels(const cwi_input *in, const nifti *n, cwi_source *src,
                             cw_error *err)
{
    const uint64_t whole = n->gzipped ? UINT64_MAX : in->size;
    const cwi_nifti_span span = {n->layout->bytes, n->is_pair ? whole : src->skip, n->gzipped,
                                 n->swapped};
    cw_label_table table = {0};
    char note[200] = "";
    cw_status st = cwi_nifti_labels(in, &span, &table, note, err);
    if (*note)
        cwi_source_note(src, "%s", note);
    if (table.count)
        src->shape.known |= CW_KNOWN_LABELS;
    if (in->labels)
        *in->labels = table;
    else
        cw_label_table_free(&table);
    return st;
}

/* Analyze has spacings alone. Its own fields in the places of NIfTI's codes are left out: sides are
 * not stated reliably by any of them. */
static cw_status read_analyze_frame(const nifti *n, cwi_source *src, cw_error *err)
{
    enum { UNIT = 56 };
    const bool is_mm = strncmp((const char *)n->bytes + UNIT, "mm", 4) == 0;
    src->frame_field = "pixdim";
    cwi_source_note(src,
                    "Analyze 7.5 does not state the frame: left and right may be exchanged");
    if (is_mm) {
        src->shape.known |= CW_KNOWN_UNIT;
        src->shape.said_unit_mm = 1;
    }
    return read_pixdim(n, &src->shape, err);
}

static cw_status read_frame(const nifti *n, cwi_source *src, cw_error *err)
{
    if (n->is_analyze)
        return read_analyze_frame(n, src, err);
    const bool sform = get_field(n, CWI_NIFTI_SFORM_CODE, 0) > 0;
    const bool qform = get_field(n, CWI_NIFTI_QFORM_CODE, 0) > 0;
    cw_status st = CW_OK;
    src->frame_field = sform ? "srow" : qform ? "qoffset" : "pixdim";
    if (sform)
        read_sform(n, &src->shape);
    else if (qform)
        st = read_qform(n, &src->shape, err);
    else
        st = read_pixdim(n, &src->shape, err);
    if (st != CW_OK)
        return st;
    if (!sform && !qform)
        cwi_source_note(src, "neither 'sform_code' nor 'qform_code' states the frame: left and "
                             "right may be exchanged");
    if (sform || qform) {
        cwi_flip_ras(src->shape.affine);
        src->shape.known |= CW_KNOWN_FRAME;
        src->shape.said_ras = true;
    }
    read_units(n, &src->shape);
    return CW_OK;
}

cw_status cwi_nifti_parse_header(const cwi_input *in, const char *image, cwi_source *src,
                                 cw_error *err)
{
    nifti n = {.image = image};
    size_t colours = 1;
    src->size_field = "dim";
    cw_status st = read_header(in, &n, err);
    if (st == CW_OK)
        st = read_type(&n, src, &colours, err);
    if (st == CW_OK)
        st = read_dims(&n, src, colours, err);
    if (st == CW_OK)
        st = find_voxels(in, &n, src, err);
    if (st == CW_OK)
        st = read_frame(&n, src, err);
    if (st == CW_OK && !n.is_analyze)
        read_intent(&n, &src->shape);
    if (st == CW_OK && !n.is_analyze)
        st = read_labels(in, &n, src, err);
    if (st == CW_OK)
        read_scaling(&n, colours, &src->shape);
    return st;
}
