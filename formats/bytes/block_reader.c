/* Reads data in separately compressed blocks (zlib or LZ4) behind a table of their sizes, as in
 * VTK's XML files. */
#include "formats/bytes/block_reader.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <limits.h>
#include <string.h>

/* Bounds of the codecs: the maximum gain per byte, and the bytes of a block besides. */
static const struct {
    const char *name;
    uint64_t ratio, besides;
} codecs[CWI_CODEC_COUNT] = {
    [CWI_CODEC_ZLIB] = {"zlib", 1032, 0}, [CWI_CODEC_LZ4] = {"LZ4", 255, 64}};

enum { HEAD_WORDS = 3 }; /* number of blocks, bytes of each, bytes of a smaller last one */

static uint64_t word_at(const cwi_packed_blocks *b, const unsigned char *words, size_t index)
{
    const size_t n = b->form.word_bytes;
    const unsigned char *word = words + index * n;
    uint64_t value = 0;
    for (size_t i = 0; i < n; i++)
        value = value << 8 | word[b->form.big_endian ? i : n - 1 - i];
    return value;
}

static size_t block_bytes(const cwi_packed_blocks *b, size_t index)
{
    return index + 1 == b->count ? b->last : b->bytes;
}

/* Checks that the counts before the table give the wanted bytes. */
static cw_status check_head(cwi_packed_blocks *b, const unsigned char *head, uint64_t expected,
                            uint64_t there, cw_error *err)
{
    const uint64_t count = word_at(b, head, 0), bytes = word_at(b, head, 1);
    const uint64_t last = word_at(b, head, 2);
    uint64_t total;
    if (count < 1 || bytes < 1 || last > bytes ||
        __builtin_mul_overflow(last ? count - 1 : count, bytes, &total) ||
        __builtin_add_overflow(total, last, &total) || total != expected)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the table of compressed blocks lists %llu blocks of %llu bytes, the "
                        "last of %llu; %llu bytes are needed in all",
                        (unsigned long long)count, (unsigned long long)bytes,
                        (unsigned long long)(last ? last : bytes),
                        (unsigned long long)expected);
    if (bytes > INT_MAX)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the compressed blocks have %llu bytes each; at most %d are read",
                        (unsigned long long)bytes, INT_MAX);
    if (count > there / b->form.word_bytes)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the table of compressed blocks lists %llu; the file holds %llu bytes",
                        (unsigned long long)count, (unsigned long long)there);
    b->count = (size_t)count;
    b->bytes = (size_t)bytes;
    b->last = (size_t)(last ? last : bytes);
    return CW_OK;
}

/* Checks the table; sets *most to the size of the largest compressed block. */
static cw_status check_table(const cwi_packed_blocks *b, uint64_t there, uint64_t *max,
                             cw_error *err)
{
    const uint64_t ratio = codecs[b->form.codec].ratio, besides = codecs[b->form.codec].besides;
    uint64_t sum = (uint64_t)b->count * b->form.word_bytes;
    *max = 0;
    for (size_t i = 0; i < b->count; i++) {
        const uint64_t packed = word_at(b, b->table, i);
        if (__builtin_add_overflow(sum, packed, &sum) || sum > there)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "compressed block %zu of %zu has %llu bytes; the file ends before",
                            i, b->count, (unsigned long long)packed);
        if (block_bytes(b, i) > packed * ratio + besides)
            return cwi_fail(
                err, CW_ERR_FORMAT,
                "block %zu of %zu has %zu bytes, compressed %llu; %s data cannot be "
                "packed so closely",
                i, b->count, block_bytes(b, i), (unsigned long long)packed,
                codecs[b->form.codec].name);
        *max = packed > *max ? packed : *max;
    }
    return CW_OK;
}

cw_status cwi_blocks_open(cwi_packed_blocks *b, cwi_stream *stream, const cwi_block_form *form,
                          uint64_t expected, uint64_t there, cw_error *err)
{
    unsigned char head[HEAD_WORDS * 8];
    const size_t head_bytes = HEAD_WORDS * form->word_bytes;
    uint64_t max = 0;
    *b = (cwi_packed_blocks){.stream = stream, .form = *form};
    cw_status st = cwi_stream_read(stream, head, head_bytes, err);
    there = there > head_bytes ? there - head_bytes : 0;
    if (st == CW_OK)
        st = check_head(b, head, expected, there, err);
    if (st == CW_OK && !(b->table = cwi_alloc_array(b->count, form->word_bytes)))
        return cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_stream_read(stream, b->table, b->count * form->word_bytes, err);
    if (st == CW_OK)
        st = check_table(b, there, &max, err);
    if (st == CW_OK && !(b->packed = cwi_alloc_array((size_t)max, 1)))
        st = cwi_fail_memory(err);
    return st;
}

void cwi_blocks_close(cwi_packed_blocks *b)
{
    cwi_free(b->table);
    cwi_free(b->packed);
    cwi_free(b->held);
    *b = (cwi_packed_blocks){0};
}

/* Inflates one whole zlib stream, with its checksum, and nothing behind it. */
static cw_status inflate_block(const cwi_packed_blocks *b, size_t packed, unsigned char *to,
                               size_t size, bool *whole, cw_error *err)
{
    z_stream z = {.next_in = b->packed, .avail_in = (uInt)packed};
    z.next_out = to;
    z.avail_out = (uInt)size;
    cwi_zlib_use_memory(&z);
    if (packed > UINT_MAX)
        return CW_OK;
    if (inflateInit(&z) != Z_OK)
        return cwi_fail_memory(err);
    const int code = inflate(&z, Z_FINISH);
    *whole = code == Z_STREAM_END && z.avail_out == 0 && z.avail_in == 0;
    inflateEnd(&z);
    if (code == Z_MEM_ERROR)
        return cwi_fail_memory(err);
    return CW_OK;
}

/* Decodes the next block into memory with enough room. */
static cw_status decode_block(cwi_packed_blocks *b, unsigned char *to, cw_error *err)
{
    const size_t index = b->next++, size = block_bytes(b, index);
    const size_t packed = (size_t)word_at(b, b->table, index);
    bool whole = false;
    cw_status st = cwi_stream_read(b->stream, b->packed, packed, err);
    if (st == CW_OK && b->form.codec == CWI_CODEC_ZLIB)
        st = inflate_block(b, packed, to, size, &whole, err);
    else if (st == CW_OK)
        whole = cwi_lz4_decode(b->packed, packed, to, size);
    if (st == CW_OK && !whole)
        st = cwi_fail(
            err, CW_ERR_FORMAT,
            "compressed block %zu of %zu is damaged: its %zu bytes are not %s data for "
            "%zu",
            index, b->count, packed, codecs[b->form.codec].name, size);
    return st;
}

/* Decodes the next block into a buffer, from which it is taken in parts. */
static cw_status hold_block(cwi_packed_blocks *b, cw_error *err)
{
    if (!b->held && !(b->held = cwi_alloc_array(block_bytes(b, 0), 1)))
        return cwi_fail_memory(err);
    b->held_next = 0;
    b->held_bytes = block_bytes(b, b->next);
    return decode_block(b, b->held, err);
}

static void skip_held(cwi_packed_blocks *b)
{
    const size_t rest = b->held_bytes - b->held_next;
    const size_t n = b->skipped < rest ? (size_t)b->skipped : rest;
    b->held_next += n;
    b->skipped -= n;
}

void cwi_blocks_skip(cwi_packed_blocks *b, uint64_t bytes)
{
    b->skipped += bytes;
}

/* Skips the bytes to leave out. */
static cw_status settle_block(cwi_packed_blocks *b, cw_error *err)
{
    cw_status st = CW_OK;
    skip_held(b);
    for (; st == CW_OK && b->next < b->count && b->skipped >= block_bytes(b, b->next);
         b->next++) {
        b->skipped -= block_bytes(b, b->next);
        st = cwi_stream_skip(b->stream, word_at(b, b->table, b->next), err);
    }
    if (st == CW_OK && b->skipped > 0)
        st = hold_block(b, err);
    skip_held(b);
    return st;
}

cw_status cwi_blocks_some(cwi_packed_blocks *b, unsigned char *to, size_t capacity, size_t *got,
                          cw_error *err)
{
    cw_status st = settle_block(b, err);
    if (st == CW_OK && b->held_next == b->held_bytes && capacity >= block_bytes(b, b->next)) {
        *got = block_bytes(b, b->next);
        return decode_block(b, to, err);
    }
    if (st == CW_OK && b->held_next == b->held_bytes)
        st = hold_block(b, err);
    const size_t rest = b->held_bytes - b->held_next;
    *got = capacity < rest ? capacity : rest;
    if (st == CW_OK)
        memcpy(to, b->held + b->held_next, *got);
    b->held_next += *got;
    return st;
}
