/* Writes data in blocks compressed by zlib, behind a table of their sizes that is filled in at
 * the end. */
#include "formats/bytes/block_writer.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/inflate_stream.h"
#include "formats/bytes/little_endian.h"

#include <assert.h>

/* Words before the sizes: number of blocks, bytes of each, bytes of a smaller last one. */
enum { BLOCK_BYTES = 256 << 10, HEAD_WORDS = 3, WORD = 8, LEVEL = 1 };

cw_status cwi_block_sink_open(cwi_block_sink *b, cwi_outfile *file, cw_error *err)
{
    *b = (cwi_block_sink){.file = file};
    cwi_zlib_use_memory(&b->z);
    b->deflates = deflateInit(&b->z, LEVEL) == Z_OK;
    b->packed_capacity = b->deflates ? deflateBound(&b->z, BLOCK_BYTES) : 0;
    b->block = cwi_alloc_array(BLOCK_BYTES, 1);
    b->packed = cwi_alloc_array(b->packed_capacity, 1);
    if (b->deflates && b->block && b->packed)
        return CW_OK;
    cwi_block_sink_close(b);
    return cwi_fail_memory(err);
}

void cwi_block_sink_close(cwi_block_sink *b)
{
    if (b->deflates)
        deflateEnd(&b->z);
    cwi_free(b->block);
    cwi_free(b->packed);
    cwi_free(b->table);
    *b = (cwi_block_sink){0};
}

cw_status cwi_block_sink_begin(cwi_block_sink *b, uint64_t bytes, cw_error *err)
{
    const uint64_t last = bytes % BLOCK_BYTES;
    cwi_free(b->table);
    b->count = (size_t)(bytes / BLOCK_BYTES + (last > 0));
    b->table_bytes = (HEAD_WORDS + b->count) * WORD;
    b->next = b->held = 0;
    b->table_at = cwi_outfile_size(b->file);
    b->table = cwi_alloc_zeroed(b->table_bytes, 1);
    if (!b->table)
        return cwi_fail_memory(err);
    cwi_put_u64(cwi_put_u64(cwi_put_u64(b->table, b->count), BLOCK_BYTES), last);
    return cwi_outfile_write(b->file, b->table, b->table_bytes, err);
}

static cw_status flush_block(cwi_block_sink *b, cw_error *err)
{
    deflateReset(&b->z);
    b->z.next_in = b->block;
    b->z.avail_in = (uInt)b->held;
    b->z.next_out = b->packed;
    b->z.avail_out = (uInt)b->packed_capacity;
    deflate(&b->z, Z_FINISH); /* there is room for any output */
    const size_t packed = b->packed_capacity - b->z.avail_out;
    b->held = 0;
    assert(b->next < b->count);
    cwi_put_u64(b->table + (HEAD_WORDS + b->next++) * WORD, packed);
    return cwi_outfile_write(b->file, b->packed, packed, err);
}

cw_status cwi_block_sink_put(void *sink, const void *bytes, size_t size, cw_error *err)
{
    cwi_block_sink *b = sink;
    cw_status st = CW_OK;
    for (const unsigned char *from = bytes; st == CW_OK && size > 0;) {
        const size_t left = BLOCK_BYTES - b->held, n = size < left ? size : left;
        memcpy(b->block + b->held, from, n);
        b->held += n;
        from += n;
        size -= n;
        if (b->held == BLOCK_BYTES)
            st = flush_block(b, err);
    }
    return st;
}

cw_status cwi_block_sink_end(cwi_block_sink *b, cw_error *err)
{
    cw_status st = b->held ? flush_block(b, err) : CW_OK;
    assert(st != CW_OK || b->next == b->count);
    return st == CW_OK ? cwi_outfile_patch(b->file, b->table_at, b->table, b->table_bytes, err)
                       : st;
}
