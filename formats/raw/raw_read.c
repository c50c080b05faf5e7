/* Parses the layout of voxels without a header, and makes a source from it. */
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/bytes/byte_order.h"
#include "formats/raw/raw_format.h"
#include "formats/text/text_header.h"

#include <math.h>
#include <string.h>
#include <strings.h>

/* --- a layout written on the command line ------------------------------------------------ */

static cw_status fail_dims(const char *text, cw_error *err)
{
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "'dims' is '%.40s'; it must be three sizes such as 512x512x300", text);
}

static cw_status parse_dims(const char *text, cw_raw_layout *layout, cw_error *err)
{
    char item[CWI_ITEM_BYTES], separator = 0;
    const char *rest = text;
    for (int a = 0; a < 3; a++) {
        const char *at = item;
        int64_t n;
        if (!cwi_next_item(&rest, &separator, item) || !cwi_parse_int(&at, &n) || *at ||
            n < 1 || n > INT32_MAX || (separator != 0) != (a < 2))
            return fail_dims(text, err);
        layout->dim[a] = (size_t)n;
    }
    return *rest ? fail_dims(text, err) : CW_OK;
}

static cw_status parse_spacing(const char *text, cw_raw_layout *layout, cw_error *err)
{
    return cwi_parse_lengths(text, layout->spacing)
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT,
                          "'spacing' is '%.40s'; it must be a length above 0 with its unit, or "
                          "three of them, such as 0.5x0.5x1mm",
                          text);
}

/* The names of types: here, in C, in NRRD and in NumPy. NumPy's i8 and u8, which have 8 bytes, count
 * as such only behind its sign of a byte order. */
static const struct {
    const char *names;
    cw_type type;
    size_t stored_bytes;
    bool is_numpy;
} types[] = {
    {"i8", CW_I32, 8, true},
    {"u8", CW_U32, 8, true},
    {"u8|uint8|uint8_t|u1|uchar|unsignedchar|ubyte|byte|bool|b1", CW_U8, 0, false},
    {"i8|int8|int8_t|i1|schar|signedchar|char|sbyte", CW_I8, 0, false},
    {"u16|uint16|uint16_t|u2|ushort|unsignedshort", CW_U16, 0, false},
    {"i16|int16|int16_t|i2|short|signedshort", CW_I16, 0, false},
    {"u32|uint32|uint32_t|u4|uint|unsignedint", CW_U32, 0, false},
    {"i32|int32|int32_t|i4|int|signedint", CW_I32, 0, false},
    {"u64|uint64|uint64_t", CW_U32, 8, false},
    {"i64|int64|int64_t", CW_I32, 8, false},
    {"f16|float16|f2|half", CW_F32, 2, false},
    {"f32|float32|f4|float|single", CW_F32, 0, false},
    {"f64|float64|f8|double", CW_F64, 0, false},
};

static bool find_type(const char *name, size_t length, bool is_numpy, cw_raw_layout *layout)
{
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (types[i].is_numpy <= is_numpy &&
            cwi_field_find(&types[i].names, 1, name, length) == 0) {
            layout->type = types[i].type;
            layout->stored_bytes = types[i].stored_bytes;
            return true;
        }
    return false;
}

/* Parses a name, with "le" or "be" behind it, or NumPy's "<", ">", "|" or "=" in front. */
static cw_status parse_type(const char *text, cw_raw_layout *layout, cw_error *err)
{
    const bool is_numpy = *text && strchr("<>|=", *text);
    const char *name = text + is_numpy;
    const size_t length = strlen(name);
    layout->big_endian = *text == '>' || (*text == '=' && cwi_machine_is_big_endian());
    if (find_type(name, length, is_numpy, layout))
        return CW_OK;
    const bool is_big = length > 2 && strcasecmp(name + length - 2, "be") == 0;
    if (!is_numpy && length > 2 && (is_big || strcasecmp(name + length - 2, "le") == 0) &&
        find_type(name, length - 2, false, layout)) {
        layout->big_endian = is_big;
        return CW_OK;
    }
    cwi_fail_type(err, "type", text);
    return CW_ERR_ARGUMENT;
}

static cw_status check_stored(const cw_raw_layout *layout, cw_error *err)
{
    const size_t n = layout->stored_bytes;
    const cw_type type = layout->type;
    if (n == 0 || (n == 8 && (type == CW_I32 || type == CW_U32)) || (n == 2 && type == CW_F32))
        return CW_OK;
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "'stored_bytes' is %zu; 8 for i32 and u32, or 2 for f32 was expected", n);
}

static cw_status parse_count(const char *key, const char *text, int64_t low, int64_t high,
                             int64_t *out, cw_error *err)
{
    return cwi_field_integer(key, text, low, high, out, err) == CW_OK ? CW_OK : CW_ERR_ARGUMENT;
}

static cw_status parse_offset(const char *text, cw_raw_layout *layout, cw_error *err)
{
    int64_t n = 0;
    cw_status st = parse_count("offset", text, 0, INT64_MAX, &n, err);
    layout->offset = (uint64_t)n;
    return st;
}

static cw_status parse_components(const char *text, cw_raw_layout *layout, cw_error *err)
{
    int64_t n = 0;
    cw_status st = parse_count("components", text, 1, 16, &n, err);
    layout->components = (size_t)n;
    return st;
}

static cw_status parse_steps(const char *text, cw_raw_layout *layout, cw_error *err)
{
    int64_t n = 0;
    cw_status st = parse_count("steps", text, 1, INT32_MAX, &n, err);
    layout->steps = (size_t)n;
    return st;
}

static const struct {
    const char *name;
    cw_status (*parse)(const char *text, cw_raw_layout *layout, cw_error *err);
} keys[] = {
    {"dims", parse_dims},
    {"type", parse_type},
    {"offset", parse_offset},
    {"spacing", parse_spacing},
    {"components", parse_components},
    {"steps", parse_steps},
};
enum { KEY_COUNT = sizeof keys / sizeof *keys };

static cw_status parse_pair(const char *pair, unsigned *seen, cw_raw_layout *layout,
                            cw_error *err)
{
    const size_t length = strcspn(pair, "=");
    for (unsigned k = 0; k < KEY_COUNT; k++) {
        if (strncmp(keys[k].name, pair, length) != 0 || keys[k].name[length])
            continue;
        if (!pair[length])
            return cwi_fail(err, CW_ERR_ARGUMENT, "'%s' needs a value: %s=...", pair, pair);
        if (*seen & 1u << k)
            return cwi_fail(err, CW_ERR_ARGUMENT, "'%s' is given twice", keys[k].name);
        *seen |= 1u << k;
        return keys[k].parse(pair + length + 1, layout, err);
    }
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "'%.*s' is not a key of a layout; known are dims, type, offset, spacing, "
                    "components, steps",
                    (int)(length < 40 ? length : 40), pair);
}

/* Returns the length of a pair: up to a comma that no number follows. Sizes and lengths may
 * also be separated by commas. */
static size_t pair_length(const char *text)
{
    size_t length = strcspn(text, ",");
    while (text[length] && text[length + 1] && strchr("0123456789.+-", text[length + 1]))
        length += 1 + strcspn(text + length + 1, ",");
    return length;
}

cw_status cw_raw_layout_parse(const char *text, cw_raw_layout *layout, cw_error *err)
{
    CWI_REQUIRE(err, text, layout);
    cw_raw_layout out = {0};
    unsigned seen = 0;
    cw_status st = CW_OK;
    while (st == CW_OK && *text) {
        char pair[128];
        const size_t length = pair_length(text);
        const size_t kept = length < sizeof pair ? length : sizeof pair - 1;
        memcpy(pair, text, kept);
        pair[kept] = '\0';
        st = parse_pair(pair, &seen, &out, err);
        text += length + (text[length] == ',');
    }
    if (st == CW_OK && !(seen & 1u))
        return cwi_fail(err, CW_ERR_ARGUMENT, "'dims' is missing: dims=512x512x300");
    if (st == CW_OK && !(seen & 2u))
        return cwi_fail(err, CW_ERR_ARGUMENT, "'type' is missing: type=u16le");
    if (st == CW_OK)
        *layout = out;
    return st;
}

/* --- a layout as a source ---------------------------------------------------------------- */

static void set_frame(const cw_raw_layout *layout, cw_volume *shape)
{
    const double *s = layout->spacing;
    const bool known = s[0] != 0 || s[1] != 0 || s[2] != 0;
    for (int a = 0; a < 3; a++)
        shape->affine[a][a] = known ? s[a] : 1;
    shape->known = known ? CW_KNOWN_UNIT : 0;
}

static cw_status check_layout(const cw_raw_layout *layout, cw_error *err)
{
    if (!cw_type_size(layout->type))
        return cwi_fail(err, CW_ERR_ARGUMENT, "'type' is %d, which is not a voxel type",
                        (int)layout->type);
    cw_status st = check_stored(layout, err);
    if (st != CW_OK)
        return st;
    for (int a = 0; a < 3; a++)
        if (layout->dim[a] < 1 || layout->dim[a] > INT32_MAX)
            return cwi_fail(err, CW_ERR_ARGUMENT, "'dims' holds %zu; sizes are 1 to 2147483647",
                            layout->dim[a]);
    return CW_OK;
}

cw_status cwi_raw_describe(const cw_raw_layout *layout, cwi_source *src, cw_error *err)
{
    cw_status st = check_layout(layout, err);
    if (st != CW_OK)
        return st;
    const cwi_axis axes[] = {{CWI_AXIS_COMPONENT, layout->components ? layout->components : 1},
                             {CWI_AXIS_X, layout->dim[0]},
                             {CWI_AXIS_Y, layout->dim[1]},
                             {CWI_AXIS_Z, layout->dim[2]},
                             {CWI_AXIS_STEP, layout->steps ? layout->steps : 1}};
    src->size_field = "dims";
    src->frame_field = "spacing";
    src->shape.type = layout->type;
    if (layout->stored_bytes)
        src->stored = layout->type == CW_F32   ? CWI_STORED_F16
                      : layout->type == CW_I32 ? CWI_STORED_I64
                                               : CWI_STORED_U64;
    src->shape.slope = 1;
    src->big_endian = layout->big_endian;
    src->skip = layout->offset;
    src->is_last = true;
    set_frame(layout, &src->shape);
    return cwi_source_set_axes(src, axes, sizeof axes / sizeof *axes, err);
}
