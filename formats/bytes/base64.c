/* Encodes and decodes Base64 (RFC 4648, section 4). Every writer of VTK files pads each of the
 * pieces that it encodes, so text goes on behind padding. */
#include "formats/bytes/base64.h"

enum { WRONG, BLANK, PADDING, END, DIGIT = 0x80 };

/* The six bits of a character, with the highest bit set; or its other meaning. */
/* clang-format off */
static const unsigned char values[256] = {
    ['A'] = 0x80, 0x81, 0x82, 0x83, 0x84, 0x85, 0x86, 0x87, 0x88, 0x89, 0x8a, 0x8b, 0x8c,
            0x8d, 0x8e, 0x8f, 0x90, 0x91, 0x92, 0x93, 0x94, 0x95, 0x96, 0x97, 0x98, 0x99,
    ['a'] = 0x9a, 0x9b, 0x9c, 0x9d, 0x9e, 0x9f, 0xa0, 0xa1, 0xa2, 0xa3, 0xa4, 0xa5, 0xa6,
            0xa7, 0xa8, 0xa9, 0xaa, 0xab, 0xac, 0xad, 0xae, 0xaf, 0xb0, 0xb1, 0xb2, 0xb3,
    ['0'] = 0xb4, 0xb5, 0xb6, 0xb7, 0xb8, 0xb9, 0xba, 0xbb, 0xbc, 0xbd,
    ['+'] = 0xbe, ['/'] = 0xbf,
    ['='] = PADDING, ['<'] = END, [' '] = BLANK, ['\t'] = BLANK, ['\n'] = BLANK, ['\r'] = BLANK,
};
/* clang-format on */

/* Decodes whole groups without blanks; nearly all text consists of them. */
static size_t decode_groups(const char *text, size_t size, size_t *used, unsigned char *to,
                            size_t capacity)
{
    const unsigned char *from = (const unsigned char *)text;
    size_t i = 0, got = 0;
    for (; size - i >= 4 && capacity - got >= 3; i += 4, got += 3) {
        const unsigned a = values[from[i]], b = values[from[i + 1]], c = values[from[i + 2]],
                       d = values[from[i + 3]];
        if (!(a & b & c & d & DIGIT))
            break;
        const unsigned bits = (a & 63) << 18 | (b & 63) << 12 | (c & 63) << 6 | (d & 63);
        to[got] = (unsigned char)(bits >> 16);
        to[got + 1] = (unsigned char)(bits >> 8);
        to[got + 2] = (unsigned char)bits;
    }
    *used += i;
    return got;
}

static void take_padding(cwi_base64 *b)
{
    b->wrong = b->in_group < 2;
    b->padded = b->in_group == 2;
    b->in_group = (b->in_group + 1) & 3;
}

/* Adds the bits of a character. The second, third and fourth one of a group each complete a
 * byte. */
static size_t take_bits(cwi_base64 *b, unsigned char value, unsigned char *to)
{
    b->bits = b->bits << 6 | (value & 63);
    const unsigned position = b->in_group;
    b->wrong = b->padded;
    b->in_group = (position + 1) & 3;
    if (position == 0 || b->wrong)
        return 0;
    *to = (unsigned char)(b->bits >> (6 - 2 * position));
    return 1;
}

size_t cwi_base64_decode(cwi_base64 *b, const char *text, size_t size, size_t *used,
                         unsigned char *to, size_t capacity)
{
    size_t got = 0;
    *used = 0;
    while (*used < size && got < capacity && !b->ended && !b->wrong) {
        if (b->in_group == 0)
            got += decode_groups(text + *used, size - *used, used, to + got, capacity - got);
        if (*used == size || got == capacity)
            break;
        const unsigned char value = values[(unsigned char)text[*used]];
        if (value & DIGIT)
            got += take_bits(b, value, to + got);
        else if (value == PADDING)
            take_padding(b);
        b->ended = value == END;
        b->wrong |= value == WRONG;
        *used += b->ended || b->wrong ? 0 : 1;
    }
    return got;
}

size_t cwi_base64_encode(const unsigned char *bytes, size_t size, char *text)
{
    static const char digits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char *to = text;
    for (size_t i = 0; i < size; i += 3) {
        const size_t have = size - i < 3 ? size - i : 3;
        const unsigned bits = (unsigned)bytes[i] << 16 |
                              (have > 1 ? (unsigned)bytes[i + 1] << 8 : 0) |
                              (have > 2 ? bytes[i + 2] : 0u);
        for (size_t c = 0; c < 4; c++)
            *to++ = c <= have ? digits[bits >> (18 - 6 * c) & 63] : '=';
    }
    return (size_t)(to - text);
}
