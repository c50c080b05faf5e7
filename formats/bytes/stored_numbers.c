/* Converts numbers of files to the types of voxels: integers of 64 bits that fit 32, floats of 16
 * bits. */
#include "formats/bytes/stored_numbers.h"

#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

size_t cwi_stored_size(cwi_stored stored, cw_type type)
{
    return stored == CWI_STORED_PLAIN ? cw_type_size(type) : stored == CWI_STORED_F16 ? 2 : 8;
}

cw_type cwi_stored_type(cwi_stored stored)
{
    return stored == CWI_STORED_I64 ? CW_I32 : stored == CWI_STORED_U64 ? CW_U32 : CW_F32;
}

const char *cwi_stored_name(cwi_stored stored)
{
    static const char *const names[] = {"", "int64", "uint64", "float16"};
    return names[stored];
}

/* Floats of 16 bits: sign, five bits of exponent, ten of fraction. */
enum { BIAS = 15, FRACTION_BITS = 10, TOP = 31 };

uint16_t cwi_stored_half(double value)
{
    enum { INFINITE = TOP << FRACTION_BITS };
    const double size = fabs(value), end = 65520; /* rounds to infinity from there on */
    const int sign = signbit(value) ? 1 << 15 : 0;
    if (isnan(value))
        return INFINITE | 1 << (FRACTION_BITS - 1);
    if (size >= end)
        return (uint16_t)(sign | INFINITE);
    const int exponent = size < ldexp(1, 1 - BIAS) ? -BIAS : ilogb(size);
    const int power = exponent == -BIAS ? 1 - BIAS : exponent;
    const int fraction = (int)nearbyint(ldexp(size, FRACTION_BITS - power));
    const int first = exponent == -BIAS ? 0 : 1 << FRACTION_BITS;
    return (uint16_t)(sign | (((exponent + BIAS) << FRACTION_BITS) + fraction - first));
}

static float to_float(uint16_t half)
{
    const int exponent = half >> FRACTION_BITS & TOP, fraction = half & 1023;
    const double sign = half >> 15 ? -1 : 1;
    if (exponent == TOP)
        return fraction ? NAN : (float)(sign * HUGE_VAL);
    if (exponent == 0)
        return (float)(sign * ldexp(fraction, 1 - BIAS - FRACTION_BITS));
    return (float)(sign * ldexp(fraction + 1024, exponent - BIAS - FRACTION_BITS));
}

/* Unsigned numbers from 2^63 on count as negative, and so never fit. */
static size_t narrow_integers(cw_type type, const char *from, size_t stride, size_t count,
                              uint32_t *to)
{
    const int64_t low = type == CW_I32 ? INT32_MIN : 0;
    const int64_t high = type == CW_I32 ? INT32_MAX : (int64_t)UINT32_MAX;
    for (size_t i = 0; i < count; i++) {
        int64_t value;
        memcpy(&value, from + i * stride, sizeof value);
        if (value < low || value > high)
            return i;
        to[i] = (uint32_t)value;
    }
    return count;
}

size_t cwi_stored_convert(cwi_stored stored, cw_type type, const void *from, size_t stride,
                          size_t count, void *to)
{
    uint16_t half;
    if (stored != CWI_STORED_F16)
        return narrow_integers(type, from, stride, count, to);
    for (size_t i = 0; i < count; i++) {
        memcpy(&half, (const char *)from + i * stride, sizeof half);
        ((float *)to)[i] = to_float(half);
    }
    return count;
}

cw_status cwi_stored_fail(cwi_stored stored, cw_type type, const void *number, cw_error *err)
{
    char text[24];
    int64_t value;
    memcpy(&value, number, sizeof value);
    if (stored == CWI_STORED_I64)
        snprintf(text, sizeof text, "%lld", (long long)value);
    else
        snprintf(text, sizeof text, "%llu", (unsigned long long)value);
    return cwi_fail(err, CW_ERR_FORMAT,
                    "a number is %s (%s); of integers of 64 bits those that fit %s are read",
                    text, cwi_stored_name(stored), cw_type_name(type));
}

bool cwi_stored_needs_u32(cwi_stored stored, const void *number)
{
    int64_t value;
    memcpy(&value, number, sizeof value);
    return stored == CWI_STORED_I64 && value > INT32_MAX && value <= (int64_t)UINT32_MAX;
}
