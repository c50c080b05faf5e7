/* Reads MGH, the volumes of FreeSurfer: a header of 284 bytes, all numbers big-endian, then the voxels;
 * or all of that as a gzip file, MGZ (surfer.nmr.mgh.harvard.edu/fswiki/FsTutorial/MghFormat). */
#include "core/base/status.h"
#include "formats/bytes/inflate_stream.h"
#include "formats/mgh/mgh_format.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Places in the header. */
enum {
    VERSION = 0,
    SIZES = 4, /* width, height, depth, frames */
    TYPE = 20,
    HAS_FRAME = 28, /* 16 bits; floats follow: */
    SPACING = 30,
    DIRECTIONS = 42, /* of x, y and z, right-anterior-superior */
    CENTRE = 78,
    HEADER_USED = 90,
    HEADER_BYTES = 284
};

enum { LONG = 2 }; /* a type: integers of 64 bits */

static const struct {
    int32_t code;
    int type; /* cw_type, or -1: refused */
    const char *name;
} types[] = {{0, CW_U8, "uchar"},  {1, CW_I32, "int"},     {3, CW_F32, "float"},
             {4, CW_I16, "short"}, {10, CW_U16, "ushort"}, {LONG, CW_I32, "long"},
             {5, -1, "bitmap"},    {6, -1, "tensor"}};

static int32_t get_integer(const unsigned char *header, size_t at)
{
    const unsigned char *b = header + at;
    return (int32_t)((uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3]);
}

static double get_float(const unsigned char *header, size_t at)
{
    const int32_t bits = get_integer(header, at);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

static bool has_frame(const unsigned char *header)
{
    return header[HAS_FRAME] || header[HAS_FRAME + 1];
}

/* Four bytes of a version decide little, so sizes and type have to be possible as well. */
bool cwi_mgh_sniff(const unsigned char *head, size_t size)
{
    bool is_known = false;
    if (size < HEADER_USED || get_integer(head, VERSION) != 1)
        return false;
    for (size_t n = 0; n < sizeof types / sizeof *types; n++)
        is_known = is_known || types[n].code == get_integer(head, TYPE);
    for (size_t n = 0; n < 4; n++)
        is_known = is_known && get_integer(head, SIZES + 4 * n) > 0;
    return is_known && head[HAS_FRAME] == 0 && head[HAS_FRAME + 1] <= 1;
}

static cw_status read_header(const cwi_input *in, unsigned char header[HEADER_BYTES],
                             bool *gzipped, cw_error *err)
{
    size_t got;
    cw_status st = cwi_stream_head(in->fd, header, HEADER_BYTES, &got, gzipped, err);
    if (st != CW_OK)
        return st;
    if (got < HEADER_BYTES)
        return cwi_fail(err, CW_ERR_FORMAT, "the header ends after %zu of %d bytes", got,
                        HEADER_BYTES);
    const int32_t version = get_integer(header, VERSION);
    return version == 1
               ? CW_OK
               : cwi_fail(err, CW_ERR_FORMAT, "'version' is %d; 1 was expected", (int)version);
}

static cw_status read_type(const unsigned char *header, cwi_source *src, cw_error *err)
{
    const int32_t code = get_integer(header, TYPE);
    char name[40];
    snprintf(name, sizeof name, "%d", (int)code);
    for (size_t n = 0; n < sizeof types / sizeof *types; n++) {
        if (types[n].code != code)
            continue;
        if (types[n].type >= 0) {
            src->shape.type = (cw_type)types[n].type;
            src->stored = code == LONG ? CWI_STORED_I64 : CWI_STORED_PLAIN;
            return CW_OK;
        }
        snprintf(name, sizeof name, "%d (%s)", (int)code, types[n].name);
    }
    return cwi_fail_type(err, "type", name);
}

static cw_status read_sizes(const unsigned char *header, cwi_source *src, cw_error *err)
{
    static const char *const names[] = {"width", "height", "depth", "nframes"};
    static const cwi_role roles[] = {CWI_AXIS_X, CWI_AXIS_Y, CWI_AXIS_Z, CWI_AXIS_STEP};
    cwi_axis axes[4];
    for (size_t n = 0; n < 4; n++) {
        const int32_t size = get_integer(header, SIZES + 4 * n);
        if (size < 1)
            return cwi_fail(err, CW_ERR_FORMAT, "'%s' is %d; it must be 1 or more", names[n],
                            (int)size);
        axes[n] = (cwi_axis){roles[n], (size_t)size};
    }
    return cwi_source_set_axes(src, axes, 4, err);
}

/* Reads the frame. The centre is the place of the voxel at half of each size. Without a frame the volume
 * is coronal, as FreeSurfer takes it: voxels of 1 mm, the axes left, inferior, anterior. */
static void read_frame(const unsigned char *header, cwi_source *src)
{
    static const double coronal[3][3] = {{-1, 0, 0}, {0, 0, -1}, {0, 1, 0}}; /* of x, y, z */
    cw_volume *shape = &src->shape;
    const bool is_stated = has_frame(header);
    for (size_t r = 0; r < 3; r++) {
        double place = is_stated ? get_float(header, CENTRE + 4 * r) : 0;
        for (size_t axis = 0; axis < 3; axis++) {
            const double step = is_stated ? get_float(header, SPACING + 4 * axis) : 1;
            const double direction = is_stated
                                         ? get_float(header, DIRECTIONS + 12 * axis + 4 * r)
                                         : coronal[axis][r];
            shape->affine[r][axis] = step * direction;
            place -= shape->affine[r][axis] * (double)shape->dim[axis] / 2;
        }
        shape->affine[r][3] = place;
    }
    cwi_flip_ras(shape->affine);
    shape->said_ras = true;
    shape->said_unit_mm = 1;
    shape->known |= CW_KNOWN_UNIT | CW_KNOWN_FRAME;
    if (!is_stated)
        snprintf(
            src->note, sizeof src->note,
            "'goodRASFlag' is 0: taken as coronal, with voxels of 1 mm, as FreeSurfer does");
}

cw_status cwi_mgh_parse(const cwi_input *in, cwi_source *src, cw_error *err)
{
    unsigned char header[HEADER_BYTES];
    bool gzipped = false;
    src->size_field = "width, height, depth, nframes";
    src->frame_field = "delta, Mdc, Pxyz_c";
    cw_status st = read_header(in, header, &gzipped, err);
    if (st == CW_OK)
        st = read_type(header, src, err);
    if (st == CW_OK)
        st = read_sizes(header, src, err);
    if (st != CW_OK)
        return st;
    src->shape.slope = 1;
    src->encoding = gzipped ? CWI_DEFLATED : CWI_RAW;
    src->big_endian = true;
    src->skip = HEADER_BYTES;
    read_frame(header, src);
    return CW_OK;
}
