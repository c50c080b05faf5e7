/* RFC 4648, section 4. Every writer of VTK files pads each of the pieces that it encodes, so
 * text goes on behind padding. */
#include "formats/base64.h"

enum { BLANK = 0x40, PADDING = 0x41, END = 0x42, WRONG = 0x43 };

/* The six bits that a character stands for, or what else it is. */
static unsigned char value_of(char c)
{
    if (c >= 'A' && c <= 'Z')
        return (unsigned char)(c - 'A');
    if (c >= 'a' && c <= 'z')
        return (unsigned char)(c - 'a' + 26);
    if (c >= '0' && c <= '9')
        return (unsigned char)(c - '0' + 52);
    return c == '+'                                          ? 62
           : c == '/'                                        ? 63
           : c == '='                                        ? PADDING
           : c == '<'                                        ? END
           : c == ' ' || c == '\n' || c == '\r' || c == '\t' ? BLANK
                                                             : WRONG;
}

/* Whole groups without blanks, which is what nearly all text is made of. */
static size_t decode_groups(const char *text, size_t size, size_t *used, unsigned char *to,
                            size_t room)
{
    size_t i = 0, got = 0;
    for (; size - i >= 4 && room - got >= 3; i += 4, got += 3) {
        const unsigned a = value_of(text[i]), b = value_of(text[i + 1]),
                       c = value_of(text[i + 2]), d = value_of(text[i + 3]);
        if ((a | b | c | d) & 0x40)
            break;
        to[got] = (unsigned char)(a << 2 | b >> 4);
        to[got + 1] = (unsigned char)(b << 4 | c >> 2);
        to[got + 2] = (unsigned char)(c << 6 | d);
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

/* The second, third and fourth character of a group each complete a byte. */
static size_t take_bits(cwi_base64 *b, unsigned char value, unsigned char *to)
{
    b->bits = b->bits << 6 | value;
    const unsigned place = b->in_group;
    b->wrong = b->padded;
    b->in_group = (place + 1) & 3;
    if (place == 0 || b->wrong)
        return 0;
    *to = (unsigned char)(b->bits >> (6 - 2 * place));
    return 1;
}

size_t cwi_base64_decode(cwi_base64 *b, const char *text, size_t size, size_t *used,
                         unsigned char *to, size_t room)
{
    size_t got = 0;
    *used = 0;
    while (*used < size && got < room && !b->ended && !b->wrong) {
        if (b->in_group == 0)
            got += decode_groups(text + *used, size - *used, used, to + got, room - got);
        if (*used == size || got == room)
            break;
        const unsigned char value = value_of(text[*used]);
        if (value < BLANK)
            got += take_bits(b, value, to + got);
        else if (value == PADDING)
            take_padding(b);
        b->ended = value == END;
        b->wrong |= value == WRONG;
        *used += b->ended || b->wrong ? 0 : 1;
    }
    return got;
}
