/* Decompresses bzip2 data by libbz2, behind an interface like zlib's inflate(). */
#include "formats/bytes/bzip2.h"

#include "core/base/memory.h"

#include <bzlib.h>

typedef struct decompressor {
    bool begun; /* a stream was begun */
    bz_stream bz;
} decompressor;

static void *take_memory(void *unused, int count, int size)
{
    (void)unused;
    return cwi_alloc_zeroed((size_t)count, (size_t)size);
}

static void give_memory(void *unused, void *memory)
{
    (void)unused;
    cwi_free(memory);
}

bool cwi_bzip2_present(void)
{
    return true;
}

bool cwi_bzip2_open(void **state)
{
    *state = cwi_alloc_zeroed(1, sizeof(decompressor));
    return *state;
}

static void end_stream(decompressor *d)
{
    if (d->begun)
        BZ2_bzDecompressEnd(&d->bz);
    d->begun = false;
}

void cwi_bzip2_close(void *state)
{
    if (state)
        end_stream(state);
    cwi_free(state);
}

static int begin_stream(decompressor *d)
{
    d->bz = (bz_stream){.bzalloc = take_memory, .bzfree = give_memory};
    const int code = BZ2_bzDecompressInit(&d->bz, 0, 0);
    d->begun = code == BZ_OK;
    return code;
}

static int to_zlib_code(int code, z_stream *z)
{
    static char no_header[] = "incorrect header check", wrong[] = "invalid block or checksum";
    if (code == BZ_OK || code == BZ_STREAM_END)
        return code == BZ_OK ? Z_OK : Z_STREAM_END;
    if (code == BZ_MEM_ERROR)
        return Z_MEM_ERROR;
    z->msg = code == BZ_DATA_ERROR_MAGIC ? no_header : wrong;
    return Z_DATA_ERROR;
}

int cwi_bzip2_inflate(void *state, z_stream *z)
{
    decompressor *d = state;
    if (!d->begun && !z->avail_in)
        return Z_BUF_ERROR;
    int code = d->begun ? BZ_OK : begin_stream(d);
    if (code != BZ_OK)
        return to_zlib_code(code, z);
    d->bz.next_in = (char *)(uintptr_t)z->next_in;
    d->bz.avail_in = z->avail_in;
    d->bz.next_out = (char *)z->next_out;
    d->bz.avail_out = z->avail_out;
    code = BZ2_bzDecompress(&d->bz);
    z->next_in = (const Bytef *)d->bz.next_in;
    z->avail_in = d->bz.avail_in;
    z->next_out = (Bytef *)d->bz.next_out;
    z->avail_out = d->bz.avail_out;
    if (code == BZ_STREAM_END)
        end_stream(d);
    return to_zlib_code(code, z);
}
