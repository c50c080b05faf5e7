/* Writes TIFF files byte by byte: pixels in strips or tiles, and directories of tags. */
#include "support/files/tiffs.h"

#include "support/support.h"

#include <stdlib.h>
#include <string.h>

/* --- bytes -------------------------------------------------------------------------------- */

static void grow(test_tiff *t, size_t more)
{
    if (t->size + more > t->room) {
        t->room = 2 * (t->size + more);
        t->bytes = realloc(t->bytes, t->room);
        assert_non_null(t->bytes);
    }
    memset(t->bytes + t->size, 0, more);
    t->size += more;
}

static void put_number(test_tiff *t, size_t at, uint64_t number, size_t size)
{
    for (size_t i = 0; i < size; i++)
        t->bytes[at + (t->high_first ? size - 1 - i : i)] = (unsigned char)(number >> (8 * i));
}

static uint64_t number_at(const void *numbers, size_t index, size_t size)
{
    uint8_t u8;
    uint16_t u16;
    uint32_t u32;
    uint64_t u64;
    const char *p = (const char *)numbers + index * size;
    switch (size) {
    case 1:
        memcpy(&u8, p, 1);
        return u8;
    case 2:
        memcpy(&u16, p, 2);
        return u16;
    case 4:
        memcpy(&u32, p, 4);
        return u32;
    default:
        memcpy(&u64, p, 8);
        return u64;
    }
}

size_t test_tiff_put(test_tiff *t, const void *numbers, size_t count, size_t size)
{
    const size_t at = t->size;
    grow(t, count * size);
    for (size_t i = 0; i < count; i++)
        put_number(t, at + i * size, number_at(numbers, i, size), size);
    return at;
}

/* --- pixels ------------------------------------------------------------------------------- */

static size_t samples_of(const test_page *p)
{
    return p->samples ? p->samples : 1;
}

static size_t bits_of(const test_page *p)
{
    return p->bits ? p->bits : 8;
}

static unsigned char turned(unsigned char byte)
{
    unsigned char out = 0;
    for (int b = 0; b < 8; b++)
        out |= (unsigned char)((byte >> b & 1) << (7 - b));
    return out;
}

/* One row of a block: count pixels from a column on, those beyond the image 0. */
static void put_row(test_tiff *t, const test_page *p, size_t row, size_t column, size_t count,
                    size_t plane)
{
    const size_t samples = samples_of(p), bits = bits_of(p), size = bits / 8;
    const size_t here = p->separate ? 1 : samples;
    const size_t at = t->size;
    grow(t, (count * here * bits + 7) / 8);
    for (size_t i = 0; i < count * here; i++) {
        const size_t x = column + i / here;
        const size_t from = (row * p->columns + x) * samples + (p->separate ? plane : i % here);
        if (x >= p->columns || row >= p->rows)
            continue;
        if (bits == 1)
            t->bytes[at + i / 8] |=
                (unsigned char)(((const unsigned char *)p->pixels)[from] << (7 - i % 8));
        else
            put_number(t, at + i * size, number_at(p->pixels, from, size), size);
    }
    for (size_t i = at; p->low_bit_first && i < t->size; i++)
        t->bytes[i] = turned(t->bytes[i]);
}

typedef struct blocks {
    uint64_t at[4096], bytes[4096];
    size_t count;
} blocks;

static void put_block(test_tiff *t, const test_page *p, blocks *b, size_t row, size_t rows,
                      size_t column, size_t count, size_t plane)
{
    assert_true(b->count < 4096);
    b->at[b->count] = t->size;
    for (size_t r = 0; r < rows; r++)
        put_row(t, p, row + r, column, count, plane);
    b->bytes[b->count] = t->size - b->at[b->count];
    b->count++;
}

static void put_pixels(test_tiff *t, const test_page *p, blocks *b)
{
    const size_t length = p->rows_per_strip ? p->rows_per_strip : p->rows;
    const size_t width = p->tile_width ? p->tile_width : p->columns;
    for (size_t plane = 0; plane < (p->separate ? samples_of(p) : 1); plane++)
        for (size_t row = 0; row < p->rows; row += length)
            for (size_t column = 0; column < p->columns; column += width)
                put_block(t, p, b, row,
                          p->tile_width || row + length <= p->rows ? length : p->rows - row,
                          column, width, plane);
}

/* --- directories -------------------------------------------------------------------------- */

enum { ASCII = 2, SHORT = 3, LONG = 4, LONG8 = 16, MAX_TAGS = 20 + TEST_TIFF_MAX_TAGS };

static size_t size_of_type(uint16_t type)
{
    static const size_t sizes[] = {0, 1, 1, 2, 4, 4, 1, 1, 2, 4, 4, 4, 8, 4, 0, 0, 8, 8, 8};
    return sizes[type];
}

/* Rational numbers are two of four bytes each. */
static size_t numbers_of(const test_tag *tag)
{
    return tag->type == 5 || tag->type == 10 ? 2 * (size_t)tag->count : tag->count;
}

static int compare(const void *a, const void *b)
{
    return (int)((const test_tag *)a)->tag - (int)((const test_tag *)b)->tag;
}

static void put_directory(test_tiff *t, test_tag *tags, size_t count)
{
    const size_t word = t->big ? 8 : 4, head = t->big ? 8 : 2, entry = t->big ? 20 : 12;
    size_t offsets[MAX_TAGS];
    qsort(tags, count, sizeof *tags, compare);
    for (size_t i = 0; i < count; i++) {
        const size_t size = size_of_type(tags[i].type), n = numbers_of(&tags[i]);
        if (t->size % 2)
            grow(t, 1);
        offsets[i] = n * size > word ? test_tiff_put(t, tags[i].values, n, size) : 0;
    }
    if (t->size % 2)
        grow(t, 1);
    const size_t at = t->size;
    put_number(t, t->link, at, word);
    grow(t, head + count * entry + word);
    put_number(t, at, count, head);
    for (size_t i = 0; i < count; i++) {
        const size_t e = at + head + i * entry, size = size_of_type(tags[i].type);
        put_number(t, e, tags[i].tag, 2);
        put_number(t, e + 2, tags[i].type, 2);
        put_number(t, e + 4, tags[i].count, word);
        if (offsets[i])
            put_number(t, e + 4 + word, offsets[i], word);
        for (size_t n = 0; !offsets[i] && n < numbers_of(&tags[i]); n++)
            put_number(t, e + 4 + word + n * size, number_at(tags[i].values, n, size), size);
    }
    t->link = at + head + count * entry;
}

static void begin(test_tiff *t)
{
    grow(t, t->big ? 16 : 8);
    memset(t->bytes, t->high_first ? 'M' : 'I', 2);
    put_number(t, 2, t->big ? 43 : 42, 2);
    if (t->big)
        put_number(t, 4, 8, 2);
    t->link = t->big ? 8 : 4;
}

void test_tiff_add(test_tiff *t, const test_page *p)
{
    blocks b = {.count = 0};
    test_tag tags[MAX_TAGS];
    size_t count = 0;
    if (t->size == 0)
        begin(t);
    put_pixels(t, p, &b);
    const uint16_t samples = (uint16_t)samples_of(p), bits = (uint16_t)bits_of(p);
    const uint16_t many_bits[] = {bits, bits, bits, bits, bits, bits, bits, bits};
    const uint16_t format = p->format ? p->format : 1;
    const uint16_t many_formats[] = {format, format, format, format,
                                     format, format, format, format};
    const uint16_t compression = p->compression ? p->compression : 1;
    const uint16_t photometric = p->photometric == 100 ? 0
                                 : p->photometric      ? p->photometric
                                                       : 1;
    const uint16_t planar = p->separate ? 2 : 1, order = 2;
    const uint32_t length = p->rows_per_strip ? p->rows_per_strip : p->rows;
    const uint16_t wide = t->big ? LONG8 : LONG;
    uint32_t at[4096], bytes[4096];
    for (size_t i = 0; i < b.count; i++) {
        at[i] = (uint32_t)b.at[i];
        bytes[i] = (uint32_t)b.bytes[i];
    }
    const uint32_t n = (uint32_t)b.count;
    const test_tag all[] = {
        {254, LONG, p->kind ? 1 : 0, &p->kind},
        {256, LONG, 1, &p->columns},
        {257, LONG, 1, &p->rows},
        {258, SHORT, samples, many_bits},
        {259, SHORT, 1, &compression},
        {262, SHORT, 1, &photometric},
        {266, SHORT, p->low_bit_first ? 1 : 0, &order},
        {270, ASCII, p->description ? (uint32_t)strlen(p->description) + 1 : 0, p->description},
        {p->tile_width ? 324 : 273, wide, n, t->big ? (void *)b.at : (void *)at},
        {274, SHORT, p->orientation ? 1 : 0, &p->orientation},
        {277, SHORT, 1, &samples},
        {278, LONG, p->tile_width ? 0 : 1, &length},
        {p->tile_width ? 325 : 279, wide, n, t->big ? (void *)b.bytes : (void *)bytes},
        {284, SHORT, 1, &planar},
        {322, LONG, p->tile_width ? 1 : 0, &p->tile_width},
        {323, LONG, p->tile_width ? 1 : 0, &length},
        {339, SHORT, samples, many_formats},
    };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (all[i].count)
            tags[count++] = all[i];
    for (size_t i = 0; i < TEST_TIFF_MAX_TAGS; i++)
        if (p->tags[i].count)
            tags[count++] = p->tags[i];
    put_directory(t, tags, count);
}

static uint64_t word_at(const test_tiff *t, size_t at, size_t size)
{
    uint64_t n = 0;
    for (size_t i = 0; i < size; i++)
        n = n << 8 | t->bytes[at + (t->high_first ? i : size - 1 - i)];
    return n;
}

void test_tiff_poke(test_tiff *t, uint16_t tag, test_tag_part part, uint64_t number)
{
    const size_t word = t->big ? 8 : 4, head = t->big ? 8 : 2, entry = t->big ? 20 : 12;
    const size_t at = word_at(t, t->big ? 8 : 4, word), count = word_at(t, at, head);
    for (size_t i = 0; i < count; i++) {
        const size_t e = at + head + i * entry;
        if (word_at(t, e, 2) != tag)
            continue;
        const size_t type = word_at(t, e + 2, 2), values = word_at(t, e + 4, word);
        const size_t size = size_of_type((uint16_t)type);
        if (part == TEST_TAG_TYPE)
            put_number(t, e + 2, number, 2);
        else if (part == TEST_TAG_COUNT)
            put_number(t, e + 4, number, word);
        else
            put_number(t, e + 4 + word, number, values * size > word ? word : size);
        return;
    }
    fail_msg("there is no tag %u", tag);
}

void test_tiff_save(test_tiff *t, const char *path)
{
    test_file_write(path, t->bytes, t->size);
    free(t->bytes);
    *t = (test_tiff){0};
}
