/* Reads INRIMAGE-4: a text header of "KEY=value" lines, padded to a multiple of 256 bytes, then
 * the voxels; or all of that as a gzip file. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/inflate_stream.h"
#include "formats/inr/inr_format.h"
#include "formats/text/text_header.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { BLOCK = 256, MAX_HEADER = 1 << 16 };
static const char magic[] = "#INRIMAGE-4#{", closing[] = "##}\n";

typedef enum key {
    K_XDIM,
    K_YDIM,
    K_ZDIM,
    K_VDIM,
    K_TYPE,
    K_PIXSIZE,
    K_CPU,
    K_SCALE,
    K_VX,
    K_VY,
    K_VZ,
    K_TX,
    K_TY,
    K_TZ,
    K_RX,
    K_RY,
    K_RZ,
    KEY_COUNT
} key;

static const char *const key_names[KEY_COUNT] = {
    [K_XDIM] = "XDIM", [K_YDIM] = "YDIM",       [K_ZDIM] = "ZDIM", [K_VDIM] = "VDIM",
    [K_TYPE] = "TYPE", [K_PIXSIZE] = "PIXSIZE", [K_CPU] = "CPU",   [K_SCALE] = "SCALE",
    [K_VX] = "VX",     [K_VY] = "VY",           [K_VZ] = "VZ",     [K_TX] = "TX",
    [K_TY] = "TY",     [K_TZ] = "TZ",           [K_RX] = "RX",     [K_RY] = "RY",
    [K_RZ] = "RZ",
};

static const struct {
    const char *name;
    int bits;
    cw_type type;
} types[] = {
    {"unsigned fixed", 8, CW_U8},   {"signed fixed", 8, CW_I8},
    {"unsigned fixed", 16, CW_U16}, {"signed fixed", 16, CW_I16},
    {"unsigned fixed", 32, CW_U32}, {"signed fixed", 32, CW_I32},
    {"float", 32, CW_F32},          {"float", 64, CW_F64},
};

typedef struct inr {
    char *text;
    size_t size; /* of the header */
    bool gzipped;
    const char *value[KEY_COUNT]; /* as written; NULL: the key is missing */
} inr;

bool cwi_inr_sniff(const unsigned char *head, size_t size)
{
    return size >= sizeof magic - 1 && memcmp(head, magic, sizeof magic - 1) == 0;
}

/* --- text to keys ------------------------------------------------------------------------ */

static cw_status find_end(inr *n, size_t got, cw_error *err)
{
    for (n->size = BLOCK; n->size <= got; n->size += BLOCK)
        if (memcmp(n->text + n->size - 4, closing, 4) == 0)
            return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "the header does not end with '##}' at a multiple of %d bytes, within %zu",
                    BLOCK, got);
}

static cw_status read_text(const cwi_input *in, inr *n, cw_error *err)
{
    size_t got;
    n->text = cwi_alloc_array(MAX_HEADER, 1);
    if (!n->text)
        return cwi_fail_memory(err);
    cw_status st = cwi_stream_head(in->fd, n->text, MAX_HEADER, &got, &n->gzipped, err);
    if (st == CW_OK && !cwi_inr_sniff((const unsigned char *)n->text, got))
        return cwi_fail(err, CW_ERR_FORMAT, "the first line is not '%s'", magic);
    if (st == CW_OK)
        st = find_end(n, got, err);
    if (st == CW_OK && memchr(n->text, '\0', n->size))
        return cwi_fail(err, CW_ERR_FORMAT, "the header holds a zero byte");
    return st;
}

/* Keeps the value of a known key; other keys are legal and ignored. */
static cw_status keep_key(inr *n, const char *line, cw_error *err)
{
    const size_t length = strcspn(line, "= \t");
    const char *value = line + strcspn(line, "=");
    if (*line == '#' || !*line)
        return CW_OK;
    if (!*value)
        return cwi_fail(err, CW_ERR_FORMAT, "the header's line '%.40s' holds no 'KEY=value'",
                        line);
    value += 1 + strspn(value + 1, " \t");
    for (int k = 0; k < KEY_COUNT; k++) {
        if (strlen(key_names[k]) != length || memcmp(key_names[k], line, length) != 0)
            continue;
        if (n->value[k])
            return cwi_fail(err, CW_ERR_FORMAT, "'%s' was given before", key_names[k]);
        n->value[k] = value;
    }
    return CW_OK;
}

static cw_status read_keys(inr *n, cw_error *err)
{
    char *line = n->text, *end = n->text + n->size;
    cw_status st = CW_OK;
    while (st == CW_OK && line < end) {
        char *stop = memchr(line, '\n', (size_t)(end - line)), *last = stop;
        while (last > line && isspace((unsigned char)last[-1]))
            last--;
        *last = '\0';
        st = keep_key(n, line, err);
        line = stop + 1;
    }
    return st;
}

static cw_status require_key(const inr *n, key k, cw_error *err)
{
    return n->value[k] ? CW_OK : cwi_fail(err, CW_ERR_FORMAT, "'%s' is missing", key_names[k]);
}

/* --- voxels ------------------------------------------------------------------------------ */

static cw_status read_type(const inr *n, cwi_source *src, cw_error *err)
{
    char name[CWI_WORD_BYTES], unit[CWI_WORD_BYTES];
    int64_t bits;
    cw_status st = require_key(n, K_TYPE, err);
    if (st == CW_OK)
        st = require_key(n, K_PIXSIZE, err);
    if (st != CW_OK)
        return st;
    const char *text = n->value[K_PIXSIZE];
    cwi_next_text_word(&text, unit);
    st = cwi_field_integer("PIXSIZE", unit, 1, 1024, &bits, err);
    if (st == CW_OK && cwi_next_text_word(&text, unit) && strcmp(unit, "bits") != 0)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'PIXSIZE' is '%.40s'; '8 bits' or the like was expected",
                        n->value[K_PIXSIZE]);
    for (size_t i = 0; st == CW_OK && i < sizeof types / sizeof *types; i++)
        if (strcmp(types[i].name, n->value[K_TYPE]) == 0 && types[i].bits == bits) {
            src->shape.type = types[i].type;
            return CW_OK;
        }
    if (st != CW_OK)
        return st;
    snprintf(name, sizeof name, "%.40s of %d bits", n->value[K_TYPE], (int)bits);
    return cwi_fail_type(err, "TYPE", name);
}

static cw_status read_sizes(const inr *n, cwi_source *src, cw_error *err)
{
    static const struct {
        key key;
        cwi_role role;
    } order[4] = {{K_VDIM, CWI_AXIS_COMPONENT},
                  {K_XDIM, CWI_AXIS_X},
                  {K_YDIM, CWI_AXIS_Y},
                  {K_ZDIM, CWI_AXIS_Z}};
    cwi_axis axes[4];
    for (int a = 0; a < 4; a++) {
        int64_t size = 1;
        const char *value = n->value[order[a].key];
        cw_status st = value || a == 0 ? CW_OK : require_key(n, order[a].key, err);
        if (st == CW_OK && value)
            st = cwi_field_integer(key_names[order[a].key], value, 1, INT32_MAX, &size, err);
        if (st != CW_OK)
            return st;
        axes[a] = (cwi_axis){order[a].role, (size_t)size};
    }
    return cwi_source_set_axes(src, axes, 4, err);
}

static cw_status read_cpu(const inr *n, cwi_source *src, cw_error *err)
{
    static const char *const names[] = {"decm|alpha|pc", "sun|sgi"};
    const char *cpu = n->value[K_CPU];
    const int found = cpu ? cwi_field_find(names, 2, cpu, strlen(cpu)) : -1;
    if (!cpu && cw_type_size(src->shape.type) > 1)
        return cwi_fail(err, CW_ERR_FORMAT, "'CPU' is missing; %s voxels need it",
                        cw_type_name(src->shape.type));
    if (cpu && found < 0)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'CPU' is '%.40s'; it must be decm, alpha, pc, sun or sgi", cpu);
    src->big_endian = found == 1;
    src->encoding = n->gzipped ? CWI_DEFLATED : CWI_RAW;
    src->skip = n->size;
    return CW_OK;
}

/* Reads the scale "2**-8": fixed-point numbers are multiples of it. */
static cw_status read_scale(const inr *n, cw_volume *shape, cw_error *err)
{
    const char *scale = n->value[K_SCALE];
    int64_t power = 0;
    shape->slope = 1;
    if (!scale || shape->type == CW_F32 || shape->type == CW_F64)
        return CW_OK;
    if (strncmp(scale, "2**", 3) != 0)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'SCALE' is '%.40s'; '2**0' or the like was expected", scale);
    cw_status st = cwi_field_integer("SCALE", scale + 3, -128, 128, &power, err);
    shape->slope = ldexp(1, (int)power);
    return st;
}

/* --- frame ------------------------------------------------------------------------------- */

static cw_status read_three(const inr *n, key first, double out[3], cw_error *err)
{
    cw_status st = CW_OK;
    for (int a = 0; a < 3 && st == CW_OK; a++) {
        const key k = (key)((int)first + a);
        if (n->value[k])
            st = cwi_field_doubles(key_names[k], n->value[k], 1, key_names[k], &out[a], err);
    }
    return st;
}

static cw_status read_frame(const inr *n, cwi_source *src, cw_error *err)
{
    double spacing[3] = {1, 1, 1}, origin[3] = {0}, turns[3] = {0};
    cw_status st = read_three(n, K_VX, spacing, err);
    if (st == CW_OK)
        st = read_three(n, K_TX, origin, err);
    if (st == CW_OK)
        st = read_three(n, K_RX, turns, err);
    if (st == CW_OK && (turns[0] != 0 || turns[1] != 0 || turns[2] != 0))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'RX', 'RY', 'RZ' are %g %g %g; rotated images are not read", turns[0],
                        turns[1], turns[2]);
    for (int a = 0; a < 3; a++) {
        src->shape.affine[a][a] = spacing[a];
        src->shape.affine[a][3] = origin[a];
    }
    return st;
}

cw_status cwi_inr_parse(const cwi_input *in, cwi_source *src, cw_error *err)
{
    inr n = {0};
    src->size_field = "XDIM, YDIM, ZDIM, VDIM";
    src->frame_field = "VX, VY, VZ, TX, TY, TZ";
    cw_status st = read_text(in, &n, err);
    if (st == CW_OK)
        st = read_keys(&n, err);
    if (st == CW_OK)
        st = read_type(&n, src, err);
    if (st == CW_OK)
        st = read_sizes(&n, src, err);
    if (st == CW_OK)
        st = read_cpu(&n, src, err);
    if (st == CW_OK)
        st = read_scale(&n, &src->shape, err);
    if (st == CW_OK)
        st = read_frame(&n, src, err);
    cwi_free(n.text);
    return st;
}
