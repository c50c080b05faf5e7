/* Parses the layout of voxels without a header, and makes a source from it. */
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/raw/raw_format.h"
#include "formats/text/text_header.h"

#include <math.h>
#include <string.h>

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

static cw_status parse_type(const char *text, cw_raw_layout *layout, cw_error *err)
{
    for (int type = 0; type < CW_TYPE_COUNT; type++) {
        const char *name = cw_type_name((cw_type)type);
        const size_t length = strlen(name);
        const char *order = text + length;
        if (strncmp(text, name, length) != 0 ||
            (*order && strcmp(order, "le") != 0 && strcmp(order, "be") != 0))
            continue;
        layout->type = (cw_type)type;
        layout->big_endian = *order == 'b';
        return CW_OK;
    }
    cwi_fail_type(err, "type", text);
    return CW_ERR_ARGUMENT;
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
    src->shape.slope = 1;
    src->big_endian = layout->big_endian;
    src->skip = layout->offset;
    set_frame(layout, &src->shape);
    return cwi_source_set_axes(src, axes, sizeof axes / sizeof *axes, err);
}
