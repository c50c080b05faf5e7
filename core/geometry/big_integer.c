/* Arithmetic of long integers by sign and magnitude, as in school. */
#include "core/geometry/big_integer.h"

#include <math.h>
#include <string.h>

__extension__ typedef unsigned __int128 wide;

void cwi_big_set(cwi_big *out, cwi_wide value)
{
    const wide magnitude = value < 0 ? -(wide)value : (wide)value;
    out->negative = value < 0;
    out->limbs[0] = (uint64_t)magnitude;
    out->limbs[1] = (uint64_t)(magnitude >> 64);
    out->count = out->limbs[1] ? 2 : out->limbs[0] ? 1 : 0;
}

void cwi_big_mul(const cwi_big *a, const cwi_big *b, cwi_big *out)
{
    out->count = a->count && b->count ? a->count + b->count : 0;
    out->negative = out->count && a->negative != b->negative;
    if (!out->count)
        return;
    memset(out->limbs, 0,
           (size_t)(out->count < CWI_BIG_LIMBS ? out->count : CWI_BIG_LIMBS) *
               sizeof *out->limbs);
    for (int i = 0; i < a->count; i++) {
        uint64_t carry = 0;
        for (int j = 0; j < b->count; j++) {
            const wide sum = (wide)a->limbs[i] * b->limbs[j] + out->limbs[i + j] + carry;
            out->limbs[i + j] = (uint64_t)sum;
            carry = (uint64_t)(sum >> 64);
        }
        if (i + b->count < CWI_BIG_LIMBS)
            out->limbs[i + b->count] = carry;
    }
    if (out->count > CWI_BIG_LIMBS || !out->limbs[out->count - 1])
        out->count--;
}

/* Compares magnitudes. */
static int compare_limbs(const cwi_big *a, const cwi_big *b)
{
    if (a->count != b->count)
        return a->count < b->count ? -1 : 1;
    for (int i = a->count; i-- > 0;)
        if (a->limbs[i] != b->limbs[i])
            return a->limbs[i] < b->limbs[i] ? -1 : 1;
    return 0;
}

/* Adds magnitudes; the sign is that of a. */
static void add_limbs(const cwi_big *a, const cwi_big *b, cwi_big *out)
{
    const cwi_big *longer = a->count >= b->count ? a : b, *shorter = longer == a ? b : a;
    const int short_count = shorter->count, count = longer->count;
    const bool negative = a->negative;
    uint64_t carry = 0;
    for (int i = 0; i < count; i++) {
        const wide sum =
            (wide)longer->limbs[i] + (i < short_count ? shorter->limbs[i] : 0) + carry;
        out->limbs[i] = (uint64_t)sum;
        carry = (uint64_t)(sum >> 64);
    }
    out->count = count;
    if (carry)
        out->limbs[out->count++] = carry;
    out->negative = negative;
}

/* Subtracts the smaller magnitude b from that of a. */
static void subtract_limbs(const cwi_big *a, const cwi_big *b, bool negative, cwi_big *out)
{
    const int short_count = b->count;
    int count = a->count;
    uint64_t borrow = 0;
    for (int i = 0; i < count; i++) {
        const wide difference =
            (wide)a->limbs[i] - (i < short_count ? b->limbs[i] : 0) - borrow;
        out->limbs[i] = (uint64_t)difference;
        borrow = (uint64_t)(difference >> 64) & 1;
    }
    while (count && !out->limbs[count - 1])
        count--;
    out->count = count;
    out->negative = count && negative;
}

static void add_signed(const cwi_big *a, const cwi_big *b, bool flip, cwi_big *out)
{
    const bool b_negative = b->count && b->negative != flip;
    if (!b->count || !a->count) {
        const cwi_big result = a->count ? *a : *b;
        const bool negative = a->count ? a->negative : b_negative;
        *out = result;
        out->negative = negative;
    } else if (a->negative == b_negative)
        add_limbs(a, b, out);
    else if (compare_limbs(a, b) >= 0)
        subtract_limbs(a, b, a->negative, out);
    else
        subtract_limbs(b, a, b_negative, out);
}

void cwi_big_add(const cwi_big *a, const cwi_big *b, cwi_big *out)
{
    add_signed(a, b, false, out);
}

void cwi_big_sub(const cwi_big *a, const cwi_big *b, cwi_big *out)
{
    add_signed(a, b, true, out);
}

void cwi_big_cross(const cwi_big *a, const cwi_big *b, const cwi_big *c, const cwi_big *d,
                   cwi_big *out)
{
    cwi_big ab, cd;
    cwi_big_mul(a, b, &ab);
    cwi_big_mul(c, d, &cd);
    cwi_big_sub(&ab, &cd, out);
}

/* Returns the leading 64 bits as a double, and the power of two that it is multiplied by. */
static double leading_bits(const cwi_big *a, int *exponent)
{
    const uint64_t top = a->limbs[a->count - 1];
    const int shift = __builtin_clzll(top);
    uint64_t bits = top << shift;
    if (shift && a->count > 1)
        bits |= a->limbs[a->count - 2] >> (64 - shift);
    *exponent = 64 * (a->count - 1) - shift;
    return (double)bits;
}

double cwi_big_ratio(const cwi_big *a, const cwi_big *b)
{
    int above, below;
    if (!a->count)
        return 0;
    const double x = leading_bits(a, &above), y = leading_bits(b, &below);
    const double ratio = ldexp(x / y, above - below);
    return a->negative != b->negative ? -ratio : ratio;
}
