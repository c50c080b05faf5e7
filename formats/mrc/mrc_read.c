/* Reads MRC2014 and CCP4 maps: a header of 256 words (ccpem.ac.uk/mrc-format/mrc2014), with
 * IMOD's additions. */
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "formats/bytes/inflate_stream.h"
#include "formats/mrc/mrc_format.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    HEADER = 1024,
    IMOD_STAMP = 1146047817,
    IMOD_SIGNED = 1,
    IMOD_ORIGIN = 4,
    IMOD_NIBBLES = 16
};
enum { FLOAT16 = 12 };                              /* a mode */
enum { STACK_GROUP = 401, LAST_STACK_GROUP = 630 }; /* space group + 400: a stack of volumes */

static const double MM_PER_ANGSTROM = 1e-7;
static const double RADIANS_PER_DEGREE = CWI_PI / 180;

/* Offsets of fields. Those with three values are for columns, rows, sections or for X, Y, Z. */
typedef enum field {
    NX = 0,
    MODE = 12,
    NXSTART = 16,
    MX = 28,
    CELL = 40,
    ANGLES = 52,
    MAPC = 64,
    ISPG = 88,
    NSYMBT = 92,
    STAMP = 152,
    FLAGS = 156,
    ORIGIN = 196,
    MAP = 208,
    MACHINE = 212
} field;

static const struct {
    int mode;
    int type; /* cw_type, or -1: refused */
    const char *name;
} modes[] = {
    {0, CW_I8, "bytes"},          {1, CW_I16, "int16"},       {2, CW_F32, "float32"},
    {3, -1, "complex int16"},     {4, -1, "complex float32"}, {6, CW_U16, "uint16"},
    {FLOAT16, CW_F32, "float16"}, {16, -1, "RGB bytes"},      {101, -1, "4 bits"},
};

typedef struct mrc {
    unsigned char bytes[HEADER];
    bool big;
    bool gzipped;
    int imod_flags; /* 0 where the file is not IMOD's */
    size_t size[3];
    int axis[3]; /* axis of the cell, 0 to 2: along columns, rows, sections */
    size_t steps;
} mrc;

static int32_t read_word(const mrc *m, field at, int index)
{
    const unsigned char *b = m->bytes + (size_t)at + 4 * (size_t)index;
    const uint32_t little =
        b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
    return (int32_t)(m->big ? __builtin_bswap32(little) : little);
}

static double read_number(const mrc *m, field at, int index)
{
    const int32_t bits = read_word(m, at, index);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* --- byte order -------------------------------------------------------------------------- */

/* Returns true if the header makes sense in this byte order: sizes, a mode, and axes that are a
 * permutation, or left zero. */
static bool is_plausible(const mrc *m)
{
    unsigned axes = 0, zeros = 0;
    for (int a = 0; a < 3; a++) {
        const int32_t axis = read_word(m, MAPC, a);
        axes |= axis >= 1 && axis <= 3 ? 1u << axis : 0;
        zeros += axis == 0;
        if (read_word(m, NX, a) < 1)
            return false;
    }
    return (axes == 14 || zeros == 3) && read_word(m, MODE, 0) >= 0 &&
           read_word(m, MODE, 0) <= 101;
}

/* Finds the byte order: by the machine stamp if there is one, else by plausibility. */
static bool find_order(mrc *m)
{
    const unsigned char *stamp = m->bytes + MACHINE;
    m->big = stamp[0] == 0x11;
    if (is_plausible(m))
        return true;
    m->big = !m->big;
    return stamp[0] != 0x11 && stamp[0] != 0x44 && is_plausible(m);
}

/* Recognises "MAP ", which all but old files contain; old ones are recognised by extension. */
bool cwi_mrc_sniff(const unsigned char *head, size_t size)
{
    mrc m = {0};
    if (size < CWI_SNIFF_BYTES || memcmp(head + MAP, "MAP", 3) != 0)
        return false;
    memcpy(m.bytes, head, CWI_SNIFF_BYTES);
    return find_order(&m);
}

static cw_status read_header(const cwi_input *in, mrc *m, cw_error *err)
{
    size_t got;
    cw_status st = cwi_stream_head(in->fd, m->bytes, HEADER, &got, &m->gzipped, err);
    if (st == CW_OK && got < HEADER)
        return cwi_fail(err, CW_ERR_FORMAT, "the header ends after %zu of %d bytes", got,
                        HEADER);
    if (st == CW_OK && !find_order(m))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "'NX', 'NY', 'NZ', 'MODE' and 'MAPC', 'MAPR', 'MAPS' are those of no MRC "
            "file in either byte order");
    m->imod_flags = IMOD_SIGNED | IMOD_ORIGIN;
    if (read_word(m, STAMP, 0) == IMOD_STAMP)
        m->imod_flags = read_word(m, FLAGS, 0);
    return st;
}

/* --- voxels ------------------------------------------------------------------------------ */

static cw_status read_type(const mrc *m, cwi_source *src, cw_error *err)
{
    const int mode = read_word(m, MODE, 0);
    char name[40];
    snprintf(name, sizeof name, "%d", mode);
    if (mode == 0 && m->imod_flags & IMOD_NIBBLES)
        return cwi_fail_type(err, "MODE", "0 (two numbers of 4 bits)");
    for (size_t i = 0; i < sizeof modes / sizeof *modes; i++) {
        if (modes[i].mode != mode)
            continue;
        snprintf(name, sizeof name, "%d (%s)", mode, modes[i].name);
        if (modes[i].type < 0)
            break;
        src->shape.type = (cw_type)modes[i].type;
        src->stored = mode == FLOAT16 ? CWI_STORED_F16 : CWI_STORED_PLAIN;
        if (mode == 0 && !(m->imod_flags & IMOD_SIGNED))
            src->shape.type = CW_U8;
        return CW_OK;
    }
    return cwi_fail_type(err, "MODE", name);
}

/* Reads the steps. A stack of volumes holds them one after another along its sections, MZ of
 * them each. */
static cw_status read_steps(mrc *m, cw_error *err)
{
    const int32_t group = read_word(m, ISPG, 0), each = read_word(m, MX, 2);
    m->steps = 1;
    if (group < STACK_GROUP || group > LAST_STACK_GROUP)
        return CW_OK;
    if (each < 1 || m->size[2] % (size_t)each != 0)
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "'ISPG' is %d, a stack of volumes; 'NZ' is %zu, which is no multiple of "
            "'MZ', %d",
            (int)group, m->size[2], (int)each);
    m->steps = m->size[2] / (size_t)each;
    m->size[2] = (size_t)each;
    return CW_OK;
}

static cw_status read_axes(mrc *m, cwi_source *src, cw_error *err)
{
    static const cwi_role roles[3] = {CWI_AXIS_X, CWI_AXIS_Y, CWI_AXIS_Z};
    for (int a = 0; a < 3; a++) {
        const int32_t axis = read_word(m, MAPC, a);
        m->axis[a] = axis ? axis - 1 : a;
        m->size[a] = (size_t)read_word(m, NX, a);
    }
    cw_status st = read_steps(m, err);
    cwi_axis axes[4] = {[3] = {CWI_AXIS_STEP, m->steps}};
    for (int a = 0; a < 3; a++)
        axes[a] = (cwi_axis){roles[m->axis[a]], m->size[a]};
    return st == CW_OK ? cwi_source_set_axes(src, axes, 4, err) : st;
}

static cw_status find_voxels(const mrc *m, cwi_source *src, cw_error *err)
{
    const int32_t extra = read_word(m, NSYMBT, 0);
    if (extra < 0)
        return cwi_fail(err, CW_ERR_FORMAT, "'NSYMBT' is %d; it must be 0 or more", (int)extra);
    src->skip = HEADER + (uint64_t)extra;
    src->is_last = true;
    src->encoding = m->gzipped ? CWI_DEFLATED : CWI_RAW;
    src->big_endian = m->big;
    return CW_OK;
}

/* --- frame ------------------------------------------------------------------------------- */

/* Computes the cell's edges from its lengths and angles: a along x, b in the plane of x and
 * y. */
static cw_status cell_edges(const double angle[3], double edges[3][3], cw_error *err)
{
    double c[3];
    for (int a = 0; a < 3; a++) /* 0: not stated */
        c[a] = angle[a] == 0 || angle[a] == 90 ? 0 : cos(angle[a] * RADIANS_PER_DEGREE);
    const double sine = sqrt(1 - c[2] * c[2]), y = (c[0] - c[1] * c[2]) / sine;
    const double z = 1 - c[1] * c[1] - y * y;
    if (!(sine > 0 && z > 0))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'CELLB' is %g %g %g; these are not the angles of a cell", angle[0],
                        angle[1], angle[2]);
    const double columns[3][3] = {{1, 0, 0}, {c[2], sine, 0}, {c[1], y, sqrt(z)}};
    for (int r = 0; r < 3; r++)
        for (int k = 0; k < 3; k++)
            edges[r][k] = columns[k][r];
    return CW_OK;
}

/* Returns true if the cell has lengths at all; simple writers leave them zero. */
static bool has_cell(const mrc *m)
{
    for (int a = 0; a < 3; a++)
        if (read_number(m, CELL, a) != 0)
            return true;
    return false;
}

static cw_status read_spacing(const mrc *m, double spacing[3], cw_error *err)
{
    for (int a = 0; a < 3; a++) {
        const double length = read_number(m, CELL, a);
        const int32_t intervals = read_word(m, MX, a);
        if (!(length > 0 && length < 1e30) || intervals < 1)
            return cwi_fail(
                err, CW_ERR_FORMAT,
                "'CELLA' and 'M%c' give axis %d %g Angstrom in %d intervals; both must "
                "be above 0",
                'X' + a, a, length, (int)intervals);
        spacing[a] = length / intervals * MM_PER_ANGSTROM;
    }
    return CW_OK;
}

/* Sets the origin: that of the first voxel: ORIGIN in Angstrom, else the START words in voxels. Old
 * versions of IMOD wrote the way back to zero instead. */
static void set_origin(const mrc *m, double mm, cw_volume *shape)
{
    const double sign = m->imod_flags & IMOD_ORIGIN ? mm : -mm;
    bool has_origin = false;
    for (int r = 0; r < 3; r++) {
        const double origin = read_number(m, ORIGIN, r);
        has_origin |= origin != 0;
        shape->affine[r][3] = origin == 0 ? 0 : sign * origin;
    }
    for (int a = 0; !has_origin && a < 3; a++)
        for (int r = 0; r < 3; r++)
            shape->affine[r][3] += shape->affine[r][m->axis[a]] * read_word(m, NXSTART, a);
}

static cw_status read_frame(const mrc *m, cwi_source *src, cw_error *err)
{
    double spacing[3] = {1, 1, 1}, angle[3], edges[3][3];
    const bool known = has_cell(m);
    for (int a = 0; a < 3; a++)
        angle[a] = read_number(m, ANGLES, a);
    cw_status st = cell_edges(angle, edges, err);
    if (st == CW_OK && known)
        st = read_spacing(m, spacing, err);
    if (st != CW_OK)
        return st;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            src->shape.affine[r][c] = edges[r][c] * spacing[c];
    src->shape.known = known ? CW_KNOWN_UNIT : 0;
    src->shape.said_unit_mm = known ? MM_PER_ANGSTROM : 0;
    set_origin(m, known ? MM_PER_ANGSTROM : 1, &src->shape);
    return CW_OK;
}

cw_status cwi_mrc_parse(const cwi_input *in, cwi_source *src, cw_error *err)
{
    mrc m = {0};
    src->size_field = "NX, NY, NZ";
    src->frame_field = "CELLA, ORIGIN";
    src->shape.slope = 1;
    cw_status st = read_header(in, &m, err);
    if (st == CW_OK)
        st = read_type(&m, src, err);
    if (st == CW_OK)
        st = read_axes(&m, src, err);
    if (st == CW_OK)
        st = find_voxels(&m, src, err);
    if (st == CW_OK)
        st = read_frame(&m, src, err);
    return st;
}
