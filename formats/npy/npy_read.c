/* Reads arrays of NumPy: a magic, the literal of a Python dictionary, then the numbers
 * (numpy.org/doc/stable/reference/generated/numpy.lib.format.html). */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/bytes/inflate_stream.h"
#include "formats/npy/npy_format.h"

#include <stdio.h>
#include <string.h>

enum { MAGIC_BYTES = 6, MAX_HEADER = CWI_NPY_HEADER, MAX_AXES = 4, MAX_CHANNELS = 4 };
static const char magic[] = "\x93NUMPY";

/* A header: the dictionary as text, and what its keys say. */
typedef struct npy {
    char *text;
    size_t voxels; /* offset of the numbers */
    bool is_fortran;
    size_t size[MAX_AXES];
    size_t axes;
} npy;

bool cwi_npy_sniff(const unsigned char *head, size_t size)
{
    return size > MAGIC_BYTES && memcmp(head, magic, MAGIC_BYTES) == 0;
}

/* Finds the dictionary at the start of a file, and moves it to the start of the text. */
static cw_status find_text(npy *n, size_t got, cw_error *err)
{
    const unsigned char *b = (const unsigned char *)n->text;
    if (got < 12 || !cwi_npy_sniff(b, got))
        return cwi_fail(err, CW_ERR_FORMAT, "it does not begin with the magic of NumPy");
    const size_t start = b[6] == 1 ? 10 : 12;
    const size_t length =
        b[6] == 1 ? b[8] | (size_t)b[9] << 8
                  : b[8] | (size_t)b[9] << 8 | (size_t)b[10] << 16 | (size_t)b[11] << 24;
    if (b[6] < 1 || b[6] > 3)
        return cwi_fail(err, CW_ERR_FORMAT, "it has version %d; 1 to 3 are read", b[6]);
    if (length > MAX_HEADER - start || start + length > got)
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "the header is said to have %zu bytes; the file has %zu behind that, and "
            "at most %zu are read",
            length, got - start, MAX_HEADER - start);
    n->voxels = start + length;
    n->text[n->voxels] = '\0';
    memmove(n->text, n->text + start, length + 1);
    return CW_OK;
}

/* Finds the value of a key; NULL: there is none. */
static const char *find_value(const npy *n, const char *key)
{
    char quoted[2][32];
    snprintf(quoted[0], sizeof quoted[0], "'%s'", key);
    snprintf(quoted[1], sizeof quoted[1], "\"%s\"", key);
    for (int k = 0; k < 2; k++) {
        const char *found = strstr(n->text, quoted[k]);
        if (!found)
            continue;
        found += strlen(quoted[k]);
        found += strspn(found, " \t\n");
        if (*found != ':')
            continue;
        return found + 1 + strspn(found + 1, " \t\n");
    }
    return NULL;
}

/* Reads a type such as '<f4'. Bools are bytes of 0 and 1. */
static cw_status read_type(const npy *n, cwi_source *src, cw_error *err)
{
    static const struct {
        const char *name;
        cw_type type;
        cwi_stored stored;
    } types[] = {{"u1", CW_U8, 0},
                 {"i1", CW_I8, 0},
                 {"b1", CW_U8, 0},
                 {"u2", CW_U16, 0},
                 {"i2", CW_I16, 0},
                 {"u4", CW_U32, 0},
                 {"i4", CW_I32, 0},
                 {"f4", CW_F32, 0},
                 {"f8", CW_F64, 0},
                 {"i8", CW_I32, CWI_STORED_I64},
                 {"u8", CW_U32, CWI_STORED_U64},
                 {"f2", CW_F32, CWI_STORED_F16}};
    char name[24] = "";
    const char *text = find_value(n, "descr");
    if (!text)
        return cwi_fail(err, CW_ERR_FORMAT, "'descr' is missing in the header");
    if (*text != '\'' && *text != '"')
        return cwi_fail_type(err, "descr", "a structure");
    const size_t length = strcspn(text + 1, "'\"");
    snprintf(name, sizeof name, "%.*s", (int)(length < 20 ? length : 20), text + 1);
    const bool has_order = *name && strchr("<>|=", *name);
    src->big_endian = *name == '>';
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strcmp(name + has_order, types[i].name) == 0) {
            src->shape.type = types[i].type;
            src->stored = types[i].stored;
            return CW_OK;
        }
    return cwi_fail_type(err, "descr", name);
}

static cw_status read_order(npy *n, cw_error *err)
{
    const char *text = find_value(n, "fortran_order");
    n->is_fortran = text && strncmp(text, "True", 4) == 0;
    return n->is_fortran || (text && strncmp(text, "False", 5) == 0)
               ? CW_OK
               : cwi_fail(err, CW_ERR_FORMAT,
                          "'fortran_order' is neither True nor False in the header");
}

/* Reads "(10, 16, 12)". */
static cw_status read_shape(npy *n, cw_error *err)
{
    const char *text = find_value(n, "shape");
    const char *at = text;
    if (!text || *at++ != '(')
        return cwi_fail(err, CW_ERR_FORMAT, "'shape' is no tuple in the header");
    for (at += strspn(at, " "); *at && *at != ')'; at += strspn(at, ", ")) {
        int64_t size;
        if (!cwi_parse_int(&at, &size) || size < 0 || !strchr(",) ", *at))
            return cwi_fail(err, CW_ERR_FORMAT, "'shape' is '%.40s'; sizes were expected",
                            text);
        if (size == 0)
            return cwi_fail(err, CW_ERR_FORMAT, "'shape' is '%.40s': the array is empty", text);
        if (n->axes < MAX_AXES)
            n->size[n->axes] = (size_t)size;
        n->axes++;
    }
    if (*at != ')')
        return cwi_fail(err, CW_ERR_FORMAT, "'shape' is '%.40s'; it does not end", text);
    return n->axes >= 2 && n->axes <= MAX_AXES
               ? CW_OK
               : cwi_fail(err, CW_ERR_FORMAT,
                          "'shape' has %zu sizes; 2 to 4 make a volume: z y x, with the steps "
                          "before or up to %d values of a voxel behind",
                          n->axes, MAX_CHANNELS);
}

/* Four axes are z y x and up to four values of a voxel, else steps of z y x. */
static cw_status set_axes(const npy *n, cwi_source *src, cw_error *err)
{
    static const cwi_role order[3][MAX_AXES] = {
        {CWI_AXIS_Z, CWI_AXIS_Y, CWI_AXIS_X},
        {CWI_AXIS_Z, CWI_AXIS_Y, CWI_AXIS_X, CWI_AXIS_COMPONENT},
        {CWI_AXIS_STEP, CWI_AXIS_Z, CWI_AXIS_Y, CWI_AXIS_X}};
    const bool has_values = n->axes == 4 && n->size[3] <= MAX_CHANNELS;
    const cwi_role *roles = order[n->axes < 4 ? 0 : has_values ? 1 : 2] + (n->axes == 2);
    cwi_axis axes[MAX_AXES];
    for (size_t a = 0; a < n->axes; a++) {
        const size_t from = n->is_fortran ? a : n->axes - 1 - a;
        axes[a] = (cwi_axis){roles[from], n->size[from]};
    }
    if (n->axes == 4)
        cwi_source_note(src, "the %s axis is taken as %s", has_values ? "last" : "first",
                        has_values ? "values of a voxel" : "steps of time");
    return cwi_source_set_axes(src, axes, n->axes, err);
}

cw_status cwi_npy_describe(char *head, size_t size, cwi_source *src, cw_error *err)
{
    npy n = {.text = head};
    src->size_field = "shape";
    src->frame_field = "shape";
    cw_status st = find_text(&n, size, err);
    if (st == CW_OK)
        st = read_type(&n, src, err);
    if (st == CW_OK)
        st = read_order(&n, err);
    if (st == CW_OK)
        st = read_shape(&n, err);
    if (st == CW_OK)
        st = set_axes(&n, src, err);
    if (st == CW_OK) {
        src->shape.slope = 1;
        src->skip = n.voxels;
        for (int a = 0; a < 3; a++)
            src->shape.affine[a][a] = 1;
    }
    return st;
}

cw_status cwi_npy_parse(const cwi_input *in, cwi_source *src, cw_error *err)
{
    size_t got;
    bool gzipped;
    char *head = cwi_alloc_array(CWI_NPY_HEADER + 1, 1);
    if (!head)
        return cwi_fail_memory(err);
    cw_status st = cwi_stream_head(in->fd, head, CWI_NPY_HEADER, &got, &gzipped, err);
    if (st == CW_OK)
        st = cwi_npy_describe(head, gzipped ? 0 : got, src, err);
    src->is_last = true;
    cwi_free(head);
    return st;
}
