/* Zip archives put together by hand: as they should be, and lying. */
#ifndef TESTS_ZIP_H
#define TESTS_ZIP_H

#include "support/files/reading.h"

typedef struct zip_entry {
    const char *name, *text;
    bool deflated;
} zip_entry;

enum { ZIP_MAX = 256 << 10 };

/* An archive, and where the records of its first entries are, for tests that change them. */
typedef struct zip {
    unsigned char bytes[ZIP_MAX];
    size_t size;
    size_t local[8], central[8], end;
} zip;

static inline void zip_put(zip *z, uint64_t value, size_t size)
{
    assert_true(z->size + size <= ZIP_MAX);
    for (size_t i = 0; i < size; i++)
        z->bytes[z->size++] = (unsigned char)(i < 8 ? value >> (8 * i) : 0);
}

static inline void zip_put_bytes(zip *z, const void *bytes, size_t size)
{
    assert_true(z->size + size <= ZIP_MAX);
    memcpy(z->bytes + z->size, bytes, size);
    z->size += size;
}

/* Writes the fields that both headers of an entry have, and its name. */
static inline void zip_put_head(zip *z, const zip_entry *e, size_t packed, bool central)
{
    const size_t size = strlen(e->text);
    zip_put(z, central ? 0x02014b50 : 0x04034b50, 4);
    if (central)
        zip_put(z, 20, 2);
    zip_put(z, 20, 2);
    zip_put(z, 0, 2);
    zip_put(z, e->deflated ? 8 : 0, 2);
    zip_put(z, 0x210000, 4);
    zip_put(z, crc32(0, (const Bytef *)e->text, (uInt)size), 4);
    zip_put(z, packed, 4);
    zip_put(z, size, 4);
    zip_put(z, strlen(e->name), 2);
    zip_put(z, 0, 2);
}

/* Deflated data are zlib's without its two bytes in front and four behind. */
static inline void zip_make(zip *z, const zip_entry *entries, size_t count)
{
    size_t packed[8];
    z->size = 0;
    for (size_t i = 0; i < count; i++) {
        const size_t size = strlen(entries[i].text);
        unsigned char *bytes = pack_bytes(entries[i].text, size, false, &packed[i]);
        packed[i] = entries[i].deflated ? packed[i] - 6 : size;
        z->local[i] = z->size;
        zip_put_head(z, &entries[i], packed[i], false);
        zip_put_bytes(z, entries[i].name, strlen(entries[i].name));
        zip_put_bytes(z, entries[i].deflated ? bytes + 2 : (const void *)entries[i].text,
                      packed[i]);
        free(bytes);
    }
    const size_t start = z->size;
    for (size_t i = 0; i < count; i++) {
        z->central[i] = z->size;
        zip_put_head(z, &entries[i], packed[i], true);
        zip_put(z, 0, 10);
        zip_put(z, z->local[i], 4);
        zip_put_bytes(z, entries[i].name, strlen(entries[i].name));
    }
    z->end = z->size;
    zip_put(z, 0x06054b50, 4);
    zip_put(z, 0, 4);
    zip_put(z, count, 2);
    zip_put(z, count, 2);
    zip_put(z, z->end - start, 4);
    zip_put(z, start, 4);
    zip_put(z, 0, 2);
}

static inline void zip_change(zip *z, size_t at, uint64_t value, size_t size)
{
    for (size_t i = 0; i < size; i++)
        z->bytes[at + i] = (unsigned char)(value >> (8 * i));
}

#endif
