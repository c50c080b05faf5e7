/* Writes bytes to a file, plain or deflated by zlib. */
#include "formats/bytes/deflate_file.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/inflate_stream.h"

enum { BUFFER_BYTES = 1 << 16, LEVEL = 1 };

cw_status cwi_sink_open(cwi_sink *s, cwi_outfile *file, cwi_packing packing, cw_error *err)
{
    *s = (cwi_sink){.file = file};
    if (packing == CWI_STORED)
        return CW_OK;
    cwi_zlib_use_memory(&s->z);
    s->buffer = cwi_alloc_array(BUFFER_BYTES, 1);
    const int MEMORY_LEVEL = 8, bits = packing == CWI_DEFLATE ? -MAX_WBITS
                                       : packing == CWI_GZIP  ? MAX_WBITS + 16
                                                              : MAX_WBITS;
    s->deflates = s->buffer && deflateInit2(&s->z, LEVEL, Z_DEFLATED, bits, MEMORY_LEVEL,
                                            Z_DEFAULT_STRATEGY) == Z_OK;
    if (s->deflates)
        return CW_OK;
    cwi_sink_close(s);
    return cwi_fail_memory(err);
}

void cwi_sink_close(cwi_sink *s)
{
    if (s->deflates)
        deflateEnd(&s->z);
    cwi_free(s->buffer);
    *s = (cwi_sink){0};
}

static cw_status put_bytes(cwi_sink *s, const void *bytes, size_t size, cw_error *err)
{
    s->written += size;
    return s->file ? cwi_outfile_write(s->file, bytes, size, err) : CW_OK;
}

/* Runs deflate until it has taken all its input, and given all its output if that is
 * requested. */
static cw_status pump_deflate(cwi_sink *s, int flush, cw_error *err)
{
    cw_status st = CW_OK;
    do {
        s->z.next_out = s->buffer;
        s->z.avail_out = BUFFER_BYTES;
        deflate(&s->z, flush);
        st = put_bytes(s, s->buffer, BUFFER_BYTES - s->z.avail_out, err);
    } while (st == CW_OK && s->z.avail_out == 0);
    return st;
}

cw_status cwi_sink_write(cwi_sink *s, const void *bytes, size_t size, cw_error *err)
{
    const size_t MAX_PIECE_BYTES = 1 << 30; /* zlib counts bytes in 32 bits */
    if (!s->deflates)
        return put_bytes(s, bytes, size, err);
    cw_status st = CW_OK;
    for (const unsigned char *p = bytes; st == CW_OK && size > 0;) {
        const size_t n = size < MAX_PIECE_BYTES ? size : MAX_PIECE_BYTES;
        s->z.next_in = p;
        s->z.avail_in = (uInt)n;
        st = pump_deflate(s, Z_NO_FLUSH, err);
        p += n;
        size -= n;
    }
    return st;
}

cw_status cwi_sink_finish(cwi_sink *s, cw_error *err)
{
    if (!s->deflates)
        return CW_OK;
    s->z.avail_in = 0;
    return pump_deflate(s, Z_FINISH, err);
}
