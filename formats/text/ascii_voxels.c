/* Reads voxels written as decimal numbers, and checks that they fit their type. */
#include "formats/text/ascii_voxels.h"

#include "core/base/status.h"
#include "core/base/text.h"

#include <math.h>
#include <string.h>

/* The longest accepted number; a longer run without a blank is an error. */
enum { LONGEST_NUMBER = 63 };

/* Reads the next byte, or -1 at the end. */
static cw_status next_byte(cwi_numbers *n, int *byte, cw_error *err)
{
    cw_status st = CW_OK;
    if (n->next == n->size) {
        n->next = 0;
        st = cwi_stream_some(n->stream, n->text, sizeof n->text, &n->size, err);
    }
    *byte = st == CW_OK && n->next < n->size ? (unsigned char)n->text[n->next++] : -1;
    return st;
}

static bool is_blank(int byte)
{
    return byte == ' ' || (byte >= '\t' && byte <= '\r') || byte == ',';
}

static cw_status next_token(cwi_numbers *n, char token[LONGEST_NUMBER + 1], cw_error *err)
{
    size_t length = 0;
    int byte;
    cw_status st = next_byte(n, &byte, err);
    while (st == CW_OK && is_blank(byte))
        st = next_byte(n, &byte, err);
    while (st == CW_OK && byte >= 0 && !is_blank(byte) && length < LONGEST_NUMBER) {
        token[length++] = (char)byte;
        st = next_byte(n, &byte, err);
    }
    token[length] = '\0';
    if (st == CW_OK && length == 0)
        return cwi_fail(err, CW_ERR_FORMAT, "the %s end after %llu numbers", n->noun,
                        (unsigned long long)n->count);
    return st;
}

/* The minimum and maximum of each type; floating types accept any number. */
static const struct {
    double low, high;
} ranges[CW_TYPE_COUNT] = {
    [CW_U8] = {0, UINT8_MAX},         [CW_I8] = {INT8_MIN, INT8_MAX},
    [CW_U16] = {0, UINT16_MAX},       [CW_I16] = {INT16_MIN, INT16_MAX},
    [CW_U32] = {0, UINT32_MAX},       [CW_I32] = {INT32_MIN, INT32_MAX},
    [CW_F32] = {-INFINITY, INFINITY}, [CW_F64] = {-INFINITY, INFINITY},
};

static bool type_holds(cw_type type, double value)
{
    if (type == CW_F32 || type == CW_F64)
        return true;
    return value >= ranges[type].low && value <= ranges[type].high && value == floor(value);
}

static void store_value(cw_type type, void *to, size_t index, double value)
{
    switch (type) {
#define CASE(name, ctype, text)                                                                \
    case name:                                                                                 \
        ((ctype *)to)[index] = (ctype)value;                                                   \
        break;
        CW_TYPE_TABLE(CASE)
#undef CASE
    default:
        break;
    }
}

cw_status cwi_numbers_read(cwi_numbers *numbers, cw_type type, void *to, size_t count,
                           cw_error *err)
{
    char token[LONGEST_NUMBER + 1];
    for (size_t i = 0; i < count; i++) {
        const char *s = token;
        double value;
        cw_status st = next_token(numbers, token, err);
        if (st != CW_OK)
            return st;
        numbers->count++;
        if (!cwi_parse_double(&s, &value) || *s || !type_holds(type, value))
            return cwi_fail(
                err, CW_ERR_FORMAT, "number %llu of the %s is '%s'; %s cannot hold it",
                (unsigned long long)numbers->count, numbers->noun, token, cw_type_name(type));
        if (to)
            store_value(type, to, i, value);
    }
    return CW_OK;
}
