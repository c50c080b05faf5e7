/* VTK's XML files, put together in every dialect: how numbers may be written in them. */
#ifndef TESTS_VTK_XML_H
#define TESTS_VTK_XML_H

#include "formats/bytes/block_reader.h"
#include "support/files/reading.h"

enum { VTK_BLOCK = 7, VTK_MAX = 8000 };

typedef enum packing { PLAIN, ZLIB, LZ4 } packing;
typedef enum form { ASCII, INLINE, APPENDED_TEXT, APPENDED_RAW, FORM_COUNT } form;
typedef struct dialect {
    form form;
    packing packing;
    bool big, wide; /* byte order; header_type UInt64 */
    bool joined;    /* header and data are one piece of base64 */
} dialect;

static const char *const form_names[] = {"ascii", "binary", "appended", "appended"};

/* Every bit of the number stands for one choice. */
static inline dialect dialect_of(unsigned n)
{
    return (dialect){.form = (form)(n & 3),
                     .packing = (packing)(n >> 2 & 3),
                     .big = n & 16,
                     .wide = n & 32,
                     .joined = n & 64};
}

static inline bool is_read(const dialect *d)
{
    return d->packing <= LZ4 && (d->packing != LZ4 || cwi_lz4_present());
}

/* Bytes that grow. */
typedef struct byte_buffer {
    unsigned char at[VTK_MAX];
    size_t size;
} byte_buffer;

static inline void add(byte_buffer *b, const void *more, size_t size)
{
    assert_true(b->size + size <= VTK_MAX);
    memcpy(b->at + b->size, more, size);
    b->size += size;
}

static inline void add_text(byte_buffer *b, const char *text)
{
    add(b, text, strlen(text));
}

static inline void add_number(byte_buffer *b, uint64_t number, size_t size, bool big)
{
    unsigned char word[8];
    for (size_t i = 0; i < size; i++)
        word[big ? size - 1 - i : i] = (unsigned char)(number >> (8 * i));
    add(b, word, size);
}

static inline void add_base64(byte_buffer *b, const unsigned char *from, size_t size)
{
    static const char digits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        const size_t n = size - i < 3 ? size - i : 3;
        uint32_t v = (uint32_t)from[i] << 16;
        v |= n > 1 ? (uint32_t)from[i + 1] << 8 : 0;
        v |= n > 2 ? from[i + 2] : 0;
        for (size_t k = 0; k < 4; k++)
            add(b, k <= n ? &digits[v >> (18 - 6 * k) & 63] : "=", 1);
    }
}

/* LZ4 can hold up to 14 bytes as they are behind one byte that counts them. */
static inline void pack_block(packing how, const unsigned char *from, size_t size,
                              byte_buffer *packed)
{
    size_t n;
    if (how == LZ4) {
        const unsigned char token = (unsigned char)(size << 4);
        add(packed, &token, 1);
        add(packed, from, size);
        return;
    }
    unsigned char *zlib = pack_bytes(from, size, false, &n);
    add(packed, zlib, n);
    free(zlib);
}

/* Sizes that stand in front, and the numbers of an array in blocks. */
static inline void make_payload(const dialect *d, const byte_buffer *plain, byte_buffer *head,
                                byte_buffer *data)
{
    const size_t word = d->wide ? 8 : 4, size = plain->size;
    if (d->packing == PLAIN) {
        add_number(head, size, word, d->big);
        add(data, plain->at, size);
        return;
    }
    add_number(head, (size + VTK_BLOCK - 1) / VTK_BLOCK, word, d->big);
    add_number(head, VTK_BLOCK, word, d->big);
    add_number(head, size % VTK_BLOCK, word, d->big);
    for (size_t i = 0; i < size; i += VTK_BLOCK) {
        const size_t before = data->size;
        pack_block(d->packing, plain->at + i, size - i < VTK_BLOCK ? size - i : VTK_BLOCK,
                   data);
        add_number(head, data->size - before, word, d->big);
    }
}

/* An array of numbers, in the bytes that the dialect makes of them. */
static inline void add_payload(byte_buffer *file, const dialect *d, const byte_buffer *plain,
                               bool text)
{
    byte_buffer head = {.size = 0}, data = {.size = 0};
    make_payload(d, plain, &head, &data);
    if (d->joined || !text) {
        add(&head, data.at, data.size);
        data.size = 0;
    }
    if (text) {
        add_base64(file, head.at, head.size);
        add_base64(file, data.at, data.size);
    } else {
        add(file, head.at, head.size);
    }
}

static inline void add_file_tag(byte_buffer *file, const dialect *d, const char *type)
{
    static const char *const compressors[] = {"", "compressor='vtkZLibDataCompressor'",
                                              "compressor='vtkLZ4DataCompressor'"};
    char text[300];
    snprintf(text, sizeof text,
             "<?xml version='1.0'?>\n<VTKFile type='%s' version='1.0' byte_order='%s' "
             "header_type='%s' %s>",
             type, d->big ? "BigEndian" : "LittleEndian", d->wide ? "UInt64" : "UInt32",
             compressors[d->packing]);
    add_text(file, text);
}

static inline void save(const byte_buffer *file, const char *name)
{
    put_file(name, "", file->at, file->size);
}

#endif
