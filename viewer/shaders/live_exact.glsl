// Numbers with 64 bits of mantissa, rounded to the nearest, ties to even: the arithmetic by which
// core/cases/cell_topology.c tells if a cell has a tunnel. The value is the mantissa high:low, whose
// top bit is set unless it is 0, times 2^exponent.
struct Extended {
    uint high, low;
    int exponent;
    bool negative;
};

Extended negate(Extended x)
{
    x.negative = !x.negative;
    return x;
}

Extended scale_by(Extended x, int exponent)
{
    x.exponent += exponent;
    return x;
}

bool is_zero(Extended x)
{
    return (x.high | x.low) == 0u;
}

// Shifts 128 bits, the highest word first, to the left until the top bit is set. They are not 0.
uvec4 shift_up(uvec4 m, inout int exponent)
{
    for (int n = 0; n < 3 && m.x == 0u; n++) {
        m = uvec4(m.yzw, 0u);
        exponent -= 32;
    }
    int by = 31 - findMSB(m.x);
    if (by > 0) {
        m = m << uint(by) | uvec4(m.yzw >> uint(32 - by), 0u);
        exponent -= by;
    }
    return m;
}

// Shifts 128 bits to the right; what is shifted out sets the lowest bit.
uvec4 shift_down(uvec4 m, int by)
{
    uint lost = 0u;
    for (; by >= 32; by -= 32) {
        lost |= m.w;
        m = uvec4(0u, m.xyz);
    }
    if (by > 0) {
        lost |= m.w << uint(32 - by);
        m = m >> uint(by) | uvec4(0u, m.xyz << uint(32 - by));
    }
    m.w |= lost != 0u ? 1u : 0u;
    return m;
}

// Rounds 128 bits, whose lowest bit has the exponent given, to 64.
Extended round_bits(uvec4 m, int exponent, bool negative)
{
    Extended x = Extended(0u, 0u, 0, false);
    if (m == uvec4(0u))
        return x;
    m = shift_up(m, exponent);
    x = Extended(m.x, m.y, exponent + 64, negative);
    bool up = (m.z & 0x80000000u) != 0u &&
              ((m.z & 0x7fffffffu) != 0u || m.w != 0u || (m.y & 1u) != 0u);
    if (!up)
        return x;
    x.low += 1u;
    if (x.low == 0u) {
        x.high += 1u;
        if (x.high == 0u) {
            x.high = 0x80000000u;
            x.exponent += 1;
        }
    }
    return x;
}

// Numbers below the normal doubles are taken for 0.
Extended extend(double x)
{
    uvec2 bits = unpackDouble2x32(x);
    uint exponent = bits.y >> 20 & 0x7ffu;
    if (exponent == 0u)
        return Extended(0u, 0u, 0, false);
    return Extended(0x80000000u | (bits.y & 0xfffffu) << 11 | bits.x >> 21, bits.x << 11,
                    int(exponent) - 1023 - 63, (bits.y & 0x80000000u) != 0u);
}

Extended multiply(Extended a, Extended b)
{
    uint h0, l0, h1, l1, h2, l2, h3, l3, carry, more;
    umulExtended(a.low, b.low, h0, l0);
    umulExtended(a.low, b.high, h1, l1);
    umulExtended(a.high, b.low, h2, l2);
    umulExtended(a.high, b.high, h3, l3);
    uvec4 m = uvec4(h3, 0u, 0u, l0);
    m.z = uaddCarry(h0, l1, carry);
    m.z = uaddCarry(m.z, l2, more);
    m.y = uaddCarry(l3, carry + more, carry);
    m.x += carry;
    m.y = uaddCarry(m.y, h1, carry);
    m.y = uaddCarry(m.y, h2, more);
    m.x += carry + more;
    return round_bits(m, a.exponent + b.exponent, a.negative != b.negative);
}

bool is_smaller(uvec2 a, uvec2 b)
{
    return a.x < b.x || (a.x == b.x && a.y < b.y);
}

Extended add(Extended a, Extended b)
{
    if (is_zero(a))
        return b;
    if (is_zero(b))
        return a;
    bool swaps =
        a.exponent < b.exponent ||
        (a.exponent == b.exponent && is_smaller(uvec2(a.high, a.low), uvec2(b.high, b.low)));
    Extended big = a, small = b;
    if (swaps) {
        big = b;
        small = a;
    }
    int by = min(big.exponent - small.exponent, 126);
    uvec4 m = uvec4(0u, big.high, big.low, 0u); // room for a carry, and 32 bits below
    uvec4 n = shift_down(uvec4(0u, small.high, small.low, 0u), by);
    if (big.negative != small.negative) { // m - n = m + ~n + 1
        n = ~n;
    }
    uint carry = big.negative != small.negative ? 1u : 0u, more;
    for (int w = 3; w >= 0; w--) {
        uint sum = uaddCarry(m[w], carry, carry);
        m[w] = uaddCarry(sum, n[w], more);
        carry += more;
    }
    return round_bits(m, big.exponent - 32, big.negative);
}

// The quotient, bit by bit; b is not 0.
Extended divide(Extended a, Extended b)
{
    if (is_zero(a))
        return a;
    uvec4 quotient = uvec4(0u);
    uvec2 rest = uvec2(a.high, a.low), by = uvec2(b.high, b.low);
    bool carry = false;
    for (int n = 0; n < 67; n++) {
        quotient = quotient << 1u | uvec4(quotient.yzw >> 31u, 0u);
        if (carry || !is_smaller(rest, by)) {
            uint borrow;
            rest.y = usubBorrow(rest.y, by.y, borrow);
            rest.x -= by.x + borrow;
            quotient.w |= 1u;
        }
        carry = (rest.x & 0x80000000u) != 0u;
        rest = uvec2(rest.x << 1 | rest.y >> 31, rest.y << 1);
    }
    // a bit for what is left
    quotient = quotient << 1u | uvec4(quotient.yzw >> 31u, 0u);
    quotient.w |= carry || rest != uvec2(0u) ? 1u : 0u;
    return round_bits(quotient, a.exponent - b.exponent - 67, a.negative != b.negative);
}

// Returns the sign of a number.
int sign_of(Extended x)
{
    return is_zero(x) ? 0 : x.negative ? -1 : 1;
}

bool is_below(Extended a, Extended b)
{
    int sign_a = sign_of(a), sign_b = sign_of(b);
    if (sign_a != sign_b || sign_a == 0)
        return sign_a < sign_b;
    bool smaller = a.exponent != b.exponent
                       ? a.exponent < b.exponent
                       : is_smaller(uvec2(a.high, a.low), uvec2(b.high, b.low));
    bool same = a.exponent == b.exponent && a.high == b.high && a.low == b.low;
    return !same && smaller == (sign_a > 0);
}
