/* Writes data in blocks compressed by zlib, behind a table of their sizes that is filled in at
 * the end. */
#include "formats/bytes/block_writer.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "formats/bytes/inflate_stream.h"
#include "formats/bytes/little_endian.h"

#include <assert.h>

/* Words before the sizes: number of blocks, bytes of each, bytes of a smaller last one. */
enum { BLOCK_BYTES = 256 << 10, HEAD_WORDS = 3, WORD = 8, LEVEL = 1, MAX_BLOCKS = 64 };

typedef struct cwi_block {
    z_stream z;
    bool deflates;
    unsigned char *plain, *packed;
    size_t packed_capacity, packed_bytes;
} cwi_block;

static bool open_block(cwi_block *b)
{
    cwi_zlib_use_memory(&b->z);
    b->deflates = deflateInit(&b->z, LEVEL) == Z_OK;
    b->packed_capacity = b->deflates ? deflateBound(&b->z, BLOCK_BYTES) : 0;
    b->plain = cwi_alloc_array(BLOCK_BYTES, 1);
    b->packed = cwi_alloc_array(b->packed_capacity, 1);
    return b->deflates && b->plain && b->packed;
}

static void close_block(cwi_block *b)
{
    if (b->deflates)
        deflateEnd(&b->z);
    cwi_free(b->plain);
    cwi_free(b->packed);
}

cw_status cwi_block_sink_open(cwi_block_sink *b, cwi_outfile *file, cw_error *err)
{
    const int threads = cwi_threads(0);
    *b = (cwi_block_sink){.file = file,
                          .capacity = (size_t)(threads < MAX_BLOCKS ? threads : MAX_BLOCKS)};
    b->blocks = cwi_alloc_zeroed(b->capacity, sizeof *b->blocks);
    bool is_open = b->blocks;
    for (size_t n = 0; n < b->capacity && is_open; n++)
        is_open = open_block(b->blocks + n);
    if (is_open)
        return CW_OK;
    cwi_block_sink_close(b);
    return cwi_fail_memory(err);
}

void cwi_block_sink_close(cwi_block_sink *b)
{
    for (size_t n = 0; n < b->capacity && b->blocks; n++)
        close_block(b->blocks + n);
    cwi_free(b->blocks);
    cwi_free(b->table);
    *b = (cwi_block_sink){0};
}

cw_status cwi_block_sink_begin(cwi_block_sink *b, uint64_t bytes, cw_error *err)
{
    const uint64_t last = bytes % BLOCK_BYTES;
    cwi_free(b->table);
    b->count = (size_t)(bytes / BLOCK_BYTES + (last > 0));
    b->table_bytes = (HEAD_WORDS + b->count) * WORD;
    b->next = b->full = b->held = 0;
    b->table_at = cwi_outfile_size(b->file);
    b->table = cwi_alloc_zeroed(b->table_bytes, 1);
    if (!b->table)
        return cwi_fail_memory(err);
    cwi_put_u64(cwi_put_u64(cwi_put_u64(b->table, b->count), BLOCK_BYTES), last);
    return cwi_outfile_write(b->file, b->table, b->table_bytes, err);
}

static void pack_block(void *context, size_t n)
{
    const cwi_block_sink *b = context;
    cwi_block *k = b->blocks + n;
    deflateReset(&k->z);
    k->z.next_in = k->plain;
    k->z.avail_in = (uInt)(n < b->full ? BLOCK_BYTES : b->held);
    k->z.next_out = k->packed;
    k->z.avail_out = (uInt)k->packed_capacity;
    deflate(&k->z, Z_FINISH); /* there is room for any output */
    k->packed_bytes = k->packed_capacity - k->z.avail_out;
}

/* Compresses and writes the full blocks, and the one begun. */
static cw_status flush_blocks(cwi_block_sink *b, cw_error *err)
{
    enum { WORTH = 1 << 19 }; /* each is worth a thread */
    const size_t count = b->full + (b->held > 0);
    cw_status st = CW_OK;
    cwi_parallel_for_all(count, WORTH, 0, pack_block, b);
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        const cwi_block *k = b->blocks + n;
        assert(b->next < b->count);
        cwi_put_u64(b->table + (HEAD_WORDS + b->next++) * WORD, k->packed_bytes);
        st = cwi_outfile_write(b->file, k->packed, k->packed_bytes, err);
    }
    b->full = b->held = 0;
    return st;
}

cw_status cwi_block_sink_put(void *sink, const void *bytes, size_t size, cw_error *err)
{
    cwi_block_sink *b = sink;
    cw_status st = CW_OK;
    for (const unsigned char *from = bytes; st == CW_OK && size > 0;) {
        const size_t left = BLOCK_BYTES - b->held, n = size < left ? size : left;
        memcpy(b->blocks[b->full].plain + b->held, from, n);
        b->held += n;
        from += n;
        size -= n;
        if (b->held == BLOCK_BYTES) {
            b->held = 0;
            b->full++;
        }
        if (b->full == b->capacity)
            st = flush_blocks(b, err);
    }
    return st;
}

cw_status cwi_block_sink_end(cwi_block_sink *b, cw_error *err)
{
    const cw_status st = flush_blocks(b, err);
    assert(st != CW_OK || b->next == b->count);
    return st == CW_OK ? cwi_outfile_patch(b->file, b->table_at, b->table, b->table_bytes, err)
                       : st;
}
