/* Reads BMP: headers of 12 to 124 bytes, palettes, 16, 24 and 32 bits without compression
 * (learn.microsoft.com/windows/win32/gdi/bitmap-storage). */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/picture/picture_file.h"

#include <string.h>

enum {
    FILE_HEADER = 14,
    OLD_HEADER = 12,
    INFO_HEADER = 40,
    LONGEST_HEADER = 124,
    MASKS_AT = FILE_HEADER + INFO_HEADER,
    PLAIN = 0,
    MASKS = 3, /* of red, green and blue; */
    ALPHA_MASKS = 6
};

typedef struct bmp {
    unsigned char head[FILE_HEADER + LONGEST_HEADER + 16];
    uint32_t header, bits, compression, colors;
    bool from_top;
    uint64_t pixels, stored_row;
    unsigned char palette[256][4];
    uint32_t masks[4];
} bmp;

static uint32_t get(const bmp *b, size_t at, size_t size)
{
    uint32_t n = 0;
    for (size_t i = size; i > 0; i--)
        n = n << 8 | b->head[at + i - 1];
    return n;
}

static cw_status read_head(const cwi_picture_file *f, bmp *b, cw_error *err)
{
    const size_t there = f->size < sizeof b->head ? (size_t)f->size : sizeof b->head;
    memset(b, 0, sizeof *b);
    if (there < FILE_HEADER + OLD_HEADER || !cwi_picture_read_at(f, 0, b->head, there))
        return cwi_fail(err, CW_ERR_FORMAT, "the file ends within its header");
    b->pixels = get(b, 10, 4);
    b->header = get(b, FILE_HEADER, 4);
    if ((b->header != OLD_HEADER && b->header < INFO_HEADER) || b->header > LONGEST_HEADER ||
        FILE_HEADER + b->header > there)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "its header has %u bytes; 12, or 40 to %d were expected", b->header,
                        LONGEST_HEADER);
    return CW_OK;
}

static cw_status check_kind(const bmp *b, int64_t columns, int64_t rows, cw_error *err)
{
    const bool has_masks = b->compression == MASKS || b->compression == ALPHA_MASKS;
    if (columns < 1 || rows < 1 || columns > INT32_MAX || rows > INT32_MAX)
        return cwi_fail(err, CW_ERR_FORMAT, "it has %lld x %lld pixels", (long long)columns,
                        (long long)rows);
    if (b->compression != PLAIN && !(has_masks && (b->bits == 16 || b->bits == 32)))
        return cwi_fail(err, CW_ERR_FORMAT, "its compression is %u%s, which is not read",
                        b->compression,
                        b->compression == 1 || b->compression == 2 ? " (run lengths)" : "");
    for (int i = 0; i < 7; i++)
        if (b->bits == (const uint32_t[]){1, 2, 4, 8, 16, 24, 32}[i])
            return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "it has %u bits a pixel; 1, 2, 4, 8, 16, 24 and 32 are read", b->bits);
}

static cw_status read_facts(cwi_picture_file *f, bmp *b, cw_error *err)
{
    const bool is_old = b->header == OLD_HEADER;
    const int64_t columns = is_old ? (int64_t)get(b, 18, 2) : (int32_t)get(b, 18, 4);
    const int64_t height = is_old ? (int64_t)get(b, 20, 2) : (int32_t)get(b, 22, 4);
    const int64_t rows = height < 0 ? -height : height;
    b->from_top = height < 0;
    b->bits = is_old ? get(b, 24, 2) : get(b, 28, 2);
    b->compression = is_old ? PLAIN : get(b, 30, 4);
    cw_status st = check_kind(b, columns, rows, err);
    if (st != CW_OK)
        return st;
    f->facts = (cwi_picture_facts){.columns = (uint32_t)columns,
                                   .rows = (uint32_t)rows,
                                   .samples = b->bits > 8 ? 3 : 1,
                                   .bits = b->bits > 8 ? 8 : b->bits,
                                   .type = CW_U8,
                                   .max_ratio = 2};
    b->stored_row = ((uint64_t)columns * b->bits + 31) / 32 * 4;
    if (b->pixels < FILE_HEADER + b->header || b->pixels > f->size ||
        (f->size - b->pixels) / b->stored_row < (uint64_t)rows)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "%lld rows of %llu bytes from byte %llu on; the file has %llu bytes",
                        (long long)rows, (unsigned long long)b->stored_row,
                        (unsigned long long)b->pixels, (unsigned long long)f->size);
    return CW_OK;
}

/* Reads the palette, in the order red, green, blue. */
static cw_status read_palette(cwi_picture_file *f, bmp *b, cw_error *err)
{
    const size_t step = b->header == OLD_HEADER ? 3 : 4, most = (size_t)1 << b->bits;
    const size_t stated = b->header == OLD_HEADER ? 0 : get(b, 46, 4);
    const size_t count = stated && stated < most ? stated : most;
    unsigned char bytes[4 * 256];
    if (!cwi_picture_read_at(f, FILE_HEADER + b->header, bytes, count * step))
        return cwi_fail(err, CW_ERR_FORMAT, "the file ends within its palette");
    b->colors = (uint32_t)count;
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            b->palette[i][c] = bytes[i * step + 2 - (size_t)c];
    f->facts.has_palette = !cwi_picture_is_grey(b->palette[0], count, sizeof b->palette[0]);
    return CW_OK;
}

static void find_masks(cwi_picture_file *f, bmp *b)
{
    static const uint32_t usual[2][3] = {{0x7c00, 0x3e0, 0x1f}, {0xff0000, 0xff00, 0xff}};
    const bool is_stated = b->compression != PLAIN;
    const bool has_alpha = is_stated && (b->header >= 56 || b->compression == ALPHA_MASKS);
    for (size_t c = 0; c < 3; c++)
        b->masks[c] = is_stated ? get(b, MASKS_AT + 4 * c, 4) : usual[b->bits > 16][c];
    b->masks[3] = has_alpha ? get(b, MASKS_AT + 12, 4) : 0;
    if (b->masks[3])
        f->facts.samples = 4;
}

/* Takes the bits of a mask from a pixel, as 0 to 255. */
static unsigned char take_masked(uint32_t pixel, uint32_t mask)
{
    const int shift = mask ? __builtin_ctz(mask) : 0;
    const uint64_t most = mask >> shift;
    return most ? (unsigned char)((uint64_t)((pixel & mask) >> shift) * 255 / most) : 0;
}

static cw_status put_indices(const cwi_picture_file *f, const bmp *b, const unsigned char *row,
                             unsigned char *to, cw_error *err)
{
    const unsigned per_byte = 8 / b->bits, mask = (1u << b->bits) - 1;
    for (uint32_t x = 0; x < f->facts.columns; x++) {
        const unsigned index = row[x / per_byte] >> (8 - b->bits * (x % per_byte + 1)) & mask;
        if (index >= b->colors)
            return cwi_fail(err, CW_ERR_FORMAT, "a pixel has the colour %u; the palette has %u",
                            index, b->colors);
        to[x] = f->facts.has_palette ? (unsigned char)index : b->palette[index][0];
    }
    return CW_OK;
}

static void put_colors(const cwi_picture_file *f, const bmp *b, const unsigned char *row,
                       unsigned char *to)
{
    const size_t size = b->bits / 8;
    for (uint32_t x = 0; x < f->facts.columns; x++, row += size, to += f->facts.samples) {
        uint32_t pixel = 0;
        for (size_t i = size; i > 0; i--)
            pixel = pixel << 8 | row[i - 1];
        for (uint32_t c = 0; c < f->facts.samples; c++)
            to[c] = take_masked(pixel, b->masks[c]);
    }
}

/* Reads the rows, which run from the bottom up unless the height is negative. */
static cw_status read_rows(cwi_picture_file *f, const bmp *b, cw_error *err)
{
    const size_t row = cwi_picture_row(&f->facts);
    unsigned char *stored = cwi_alloc_array(b->stored_row, 1);
    cw_status st = stored ? CW_OK : cwi_fail_memory(err);
    for (uint32_t y = 0; st == CW_OK && y < f->facts.rows; y++) {
        unsigned char *to = f->pixels + (b->from_top ? y : f->facts.rows - 1 - y) * row;
        if (!cwi_picture_read_at(f, b->pixels + y * b->stored_row, stored, b->stored_row))
            st = cwi_fail(err, CW_ERR_FORMAT, "the file ends within its pixels");
        else if (b->bits <= 8)
            st = put_indices(f, b, stored, to, err);
        else
            put_colors(f, b, stored, to);
    }
    cwi_free(stored);
    return st;
}

cw_status cwi_picture_bmp(cwi_picture_file *f, bool with_pixels, cw_error *err)
{
    bmp b;
    cw_status st = read_head(f, &b, err);
    if (st == CW_OK)
        st = read_facts(f, &b, err);
    if (st == CW_OK && b.bits <= 8)
        st = read_palette(f, &b, err);
    if (st == CW_OK && b.bits > 8)
        find_masks(f, &b);
    if (st == CW_OK && with_pixels)
        st = cwi_picture_reserve(f, err);
    return st == CW_OK && with_pixels ? read_rows(f, &b, err) : st;
}
