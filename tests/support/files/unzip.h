/* Entries of zip archives, found by a reader that trusts them: for tests of what
 * writes them. */
#ifndef TESTS_UNZIP_H
#define TESTS_UNZIP_H

#include "support/support.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

static inline uint64_t number_at(const char *bytes, size_t size)
{
    uint64_t number = 0;
    for (size_t i = size; i > 0; i--)
        number = number << 8 | (unsigned char)bytes[i - 1];
    return number;
}

/* The directory's record of an entry; NULL when there is none. */
static inline const char *find_record(const char *bytes, size_t size, const char *name)
{
    const char *end = bytes + size - 22, *record = bytes + number_at(end + 16, 4);
    assert_int_equal(number_at(end, 4), 0x06054b50);
    for (uint64_t n = number_at(end + 10, 2); n > 0; n--) {
        const size_t length = (size_t)number_at(record + 28, 2);
        assert_int_equal(number_at(record, 4), 0x02014b50);
        if (length == strlen(name) && memcmp(record + 46, name, length) == 0)
            return record;
        record += 46 + length + number_at(record + 30, 2);
    }
    return NULL;
}

/* The text of an entry; free it. Sizes and checksum must be right in both headers. */
static inline char *unzip(const char *path, const char *name)
{
    size_t size;
    char *bytes = test_file_read(path, &size);
    const char *record = find_record(bytes, size, name);
    assert_non_null(record);
    const char *local = bytes + number_at(record + 42, 4);
    const size_t packed = number_at(record + 20, 4), whole = number_at(record + 24, 4);
    assert_int_equal(number_at(local, 4), 0x04034b50);
    assert_memory_equal(local + 8, record + 10, 10);
    if (number_at(local + 28, 2) == 0)
        assert_memory_equal(local + 18, record + 20, 8);
    char *text = malloc(whole + 1);
    assert_non_null(text);
    z_stream z = {
        .next_in = (Bytef *)(uintptr_t)(local + 30 + strlen(name) + number_at(local + 28, 2)),
        .avail_in = (uInt)packed,
        .next_out = (Bytef *)text,
        .avail_out = (uInt)whole};
    assert_int_equal(inflateInit2(&z, -MAX_WBITS), Z_OK);
    assert_int_equal(inflate(&z, Z_FINISH), Z_STREAM_END);
    assert_int_equal(z.avail_out, 0);
    inflateEnd(&z);
    text[whole] = '\0';
    assert_int_equal(crc32(0, (Bytef *)text, (uInt)whole), number_at(record + 16, 4));
    free(bytes);
    return text;
}

#endif
