/* Reads sequential bytes of a file, decoding base64 or hexadecimal text and inflating gzip,
 * zlib or bzip2 on the way. */
#include "formats/bytes/inflate_stream.h"

#include "core/base/memory.h"
#include "core/base/read_ahead.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "formats/bytes/bzip2.h"
#include "formats/bytes/input_file.h"
#include "formats/bytes/isal.h"

#include <string.h>

/* Buffer sizes. A decompressor may read AHEAD_BYTES too far, and gives them back when the data
 * end. */
enum { BUFFER_BYTES = 1 << 16, DRAIN_BYTES = 1 << 16, AHEAD_BYTES = 8 };

static voidpf zlib_alloc(voidpf unused, uInt items, uInt size)
{
    (void)unused;
    return cwi_alloc_zeroed(items, size);
}

static void zlib_free(voidpf unused, voidpf memory)
{
    (void)unused;
    cwi_free(memory);
}

void cwi_zlib_use_memory(z_stream *z)
{
    z->zalloc = zlib_alloc;
    z->zfree = zlib_free;
}

/* Makes the buffer of compressed bytes, and zlib's struct, which may not move. */
static bool open_buffer(cwi_stream *s)
{
    s->buffer = cwi_alloc_array(BUFFER_BYTES, 1);
    s->z = cwi_alloc_zeroed(1, sizeof *s->z);
    if (!s->buffer || !s->z)
        return false;
    cwi_zlib_use_memory(s->z);
    s->z->next_in = s->buffer;
    return true;
}

cw_status cwi_stream_open(cwi_stream *s, int fd, uint64_t offset, bool deflated, cw_error *err)
{
    *s = (cwi_stream){.fd = fd, .offset = offset, .end = UINT64_MAX};
    if (!deflated)
        return CW_OK;
    const int ZLIB_OR_GZIP = 32; /* zlib or gzip, by the header found */
    s->deflated = open_buffer(s) && cwi_isal_open(&s->isal) &&
                  (s->isal || inflateInit2(s->z, MAX_WBITS + ZLIB_OR_GZIP) == Z_OK);
    if (s->deflated)
        return CW_OK;
    cwi_stream_close(s);
    return cwi_fail_memory(err);
}

cw_status cwi_stream_open_bare(cwi_stream *s, int fd, uint64_t offset, uint32_t crc,
                               cw_error *err)
{
    *s = (cwi_stream){
        .fd = fd, .offset = offset, .end = UINT64_MAX, .is_bare = true, .expected_crc = crc};
    s->deflated = open_buffer(s) && inflateInit2(s->z, -MAX_WBITS) == Z_OK;
    if (s->deflated)
        return CW_OK;
    cwi_stream_close(s);
    return cwi_fail_memory(err);
}

cw_status cwi_stream_open_bzip2(cwi_stream *s, int fd, uint64_t offset, cw_error *err)
{
    *s = (cwi_stream){.fd = fd, .offset = offset, .end = UINT64_MAX};
    if (!cwi_bzip2_present())
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "the data are compressed with bzip2; this build has no libbz2 "
                        "(libbz2-dev, CUBEWRIGHT_BZIP2)");
    s->deflated = open_buffer(s) && cwi_bzip2_open(&s->bzip2);
    if (s->deflated)
        return CW_OK;
    cwi_stream_close(s);
    return cwi_fail_memory(err);
}

void cwi_stream_end_at(cwi_stream *s, uint64_t end)
{
    s->end = end;
}

cw_status cwi_stream_from_base64(cwi_stream *s, cw_error *err)
{
    s->text = cwi_alloc_array(BUFFER_BYTES, 1);
    return s->text ? CW_OK : cwi_fail_memory(err);
}

cw_status cwi_stream_from_hex(cwi_stream *s, cw_error *err)
{
    s->text = cwi_alloc_array(BUFFER_BYTES, 1);
    s->is_hex = true;
    return s->text ? CW_OK : cwi_fail_memory(err);
}

/* A stream that a thread inflates. The reader's own says how much it has taken. */
struct cwi_stream_ahead {
    cwi_stream stream;
    cwi_ahead *bytes;
};

/* Ends the thread; the stream is then where the thread has come to. */
static void join_ahead(cwi_stream *s)
{
    struct cwi_stream_ahead *a = s->ahead;
    cwi_ahead_stop(a->bytes);
    *s = a->stream;
    cwi_free(a);
}

void cwi_stream_close(cwi_stream *s)
{
    if (s->ahead)
        join_ahead(s);
    if (s->deflated && !s->isal && !s->bzip2)
        inflateEnd(s->z);
    cwi_bzip2_close(s->bzip2);
    cwi_free(s->isal);
    cwi_free(s->z);
    cwi_free(s->buffer);
    cwi_free(s->text);
    *s = (cwi_stream){.fd = -1};
}

/* Reads the bytes of the file as they are. */
static cw_status fetch_plain(cwi_stream *s, void *to, size_t size, size_t *got, cw_error *err)
{
    const uint64_t left = s->end > s->offset ? s->end - s->offset : 0;
    cw_status st =
        cwi_input_read_at(s->fd, s->offset, to, size < left ? size : (size_t)left, got, err);
    s->offset += *got;
    return st;
}

static cw_status fetch_base64(cwi_stream *s, unsigned char *to, size_t size, size_t *got,
                              cw_error *err)
{
    cw_status st = CW_OK;
    *got = 0;
    while (st == CW_OK && *got < size && !s->base64.ended) {
        size_t used;
        if (s->text_next == s->text_size) {
            s->text_next = 0;
            st = fetch_plain(s, s->text, BUFFER_BYTES, &s->text_size, err);
            if (st != CW_OK || s->text_size == 0)
                break;
        }
        *got += cwi_base64_decode(&s->base64, s->text + s->text_next,
                                  s->text_size - s->text_next, &used, to + *got, size - *got);
        s->text_next += used;
        if (s->base64.wrong)
            st = cwi_fail(err, CW_ERR_FORMAT, "byte %llu of the file is not base64",
                          (unsigned long long)(s->offset - s->text_size + s->text_next));
    }
    return st;
}

static int hex_digit(char c)
{
    const char letter = (char)(c | 32);
    return c >= '0' && c <= '9'             ? c - '0'
           : letter >= 'a' && letter <= 'f' ? letter - 'a' + 10
                                            : -1;
}

/* Decodes one character of the text; returns false where it is neither a digit nor a blank. */
static bool take_hex(cwi_stream *s, char c, unsigned char *to, size_t *got)
{
    const int digit = hex_digit(c);
    if (digit < 0)
        return c == ' ' || (c >= '\t' && c <= '\r');
    if (s->has_digit)
        to[(*got)++] = (unsigned char)(s->high << 4 | digit);
    s->high = (unsigned char)digit;
    s->has_digit = !s->has_digit;
    return true;
}

static cw_status fetch_hex(cwi_stream *s, unsigned char *to, size_t size, size_t *got,
                           cw_error *err)
{
    cw_status st = CW_OK;
    *got = 0;
    while (st == CW_OK && *got < size) {
        if (s->text_next == s->text_size) {
            s->text_next = 0;
            st = fetch_plain(s, s->text, BUFFER_BYTES, &s->text_size, err);
            if (st != CW_OK || s->text_size == 0)
                break;
        }
        if (!take_hex(s, s->text[s->text_next++], to, got))
            st =
                cwi_fail(err, CW_ERR_FORMAT, "byte %llu of the file is not a hexadecimal digit",
                         (unsigned long long)(s->offset - s->text_size + s->text_next - 1));
    }
    return st;
}

static cw_status fetch_bytes(cwi_stream *s, void *to, size_t size, size_t *got, cw_error *err)
{
    return !s->text    ? fetch_plain(s, to, size, got, err)
           : s->is_hex ? fetch_hex(s, to, size, got, err)
                       : fetch_base64(s, to, size, got, err);
}

/* Appends more of the file to the input of inflate. The input follows the bytes that may be
 * given back. */
static cw_status refill_input(cwi_stream *s, size_t *got, cw_error *err)
{
    const size_t used = (size_t)(s->z->next_in - s->buffer);
    const size_t kept = used < AHEAD_BYTES ? used : AHEAD_BYTES, held = kept + s->z->avail_in;
    memmove(s->buffer, s->z->next_in - kept, held);
    s->z->next_in = s->buffer + kept;
    cw_status st = fetch_bytes(s, s->buffer + held, BUFFER_BYTES - held, got, err);
    s->z->avail_in += (uInt)*got;
    return st;
}

/* Checks the rest of a file whose compressed data end before it. Only zeros may follow, with
 * which tapes and some tools fill up their blocks. */
static cw_status check_padding(cwi_stream *s, cw_error *err)
{
    size_t got = 1;
    cw_status st = CW_OK;
    while (st == CW_OK && got > 0) {
        for (; s->z->avail_in > 0; s->z->avail_in--, s->z->next_in++)
            if (*s->z->next_in)
                return cwi_fail(
                    err, CW_ERR_FORMAT,
                    "byte %llu of the file is behind the end of the compressed data "
                    "and not zero",
                    (unsigned long long)(s->offset - s->z->avail_in));
        st = refill_input(s, &got, err);
    }
    return st;
}

/* Continues after one gzip member, or one stream of bzip2, when the next one follows. Otherwise
 * the data end. */
static cw_status start_next_member(cwi_stream *s, cw_error *err)
{
    const char *magic = s->bzip2 ? "BZh" : "\x1f\x8b";
    const size_t size = strlen(magic);
    size_t got;
    cw_status st = s->z->avail_in < size ? refill_input(s, &got, err) : CW_OK;
    s->ended = s->is_bare || s->z->avail_in < size || memcmp(s->z->next_in, magic, size) != 0;
    s->packed_end = s->offset - s->z->avail_in;
    if (st == CW_OK && !s->ended && !s->isal && !s->bzip2)
        inflateReset(s->z);
    return st;
}

static cw_status fail_inflate(const cwi_stream *s, int code, cw_error *err)
{
    if (code == Z_MEM_ERROR)
        return cwi_fail_memory(err);
    return cwi_fail(err, CW_ERR_FORMAT, "the compressed data are damaged after %llu bytes: %s",
                    (unsigned long long)(s->given),
                    s->z->msg             ? s->z->msg
                    : code == Z_NEED_DICT ? "a dictionary is asked for"
                                          : "no progress");
}

/* Calls inflate once. zlib's own totals are not used: they wrap at 4 GiB on some systems. */
static cw_status inflate_some(cwi_stream *s, unsigned char *to, size_t size, size_t *got,
                              cw_error *err)
{
    const uInt max = 1 << 30;
    size_t fetched = 0;
    *got = 0;
    if (s->z->avail_in == 0) {
        cw_status st = refill_input(s, &fetched, err);
        if (st != CW_OK)
            return st;
    }
    const uInt input = s->z->avail_in;
    s->z->next_out = to;
    s->z->avail_out = size < max ? (uInt)size : max;
    const uInt output = s->z->avail_out;
    const int code = s->bzip2  ? cwi_bzip2_inflate(s->bzip2, s->z)
                     : s->isal ? cwi_isal_inflate(s->isal, s->z)
                               : inflate(s->z, Z_NO_FLUSH);
    *got = output - s->z->avail_out;
    s->given += *got;
    if (s->is_bare)
        s->crc = (uint32_t)crc32_z(s->crc, to, *got);
    if (code == Z_STREAM_END)
        return start_next_member(s, err);
    const bool stuck = *got == 0 && s->z->avail_in == input;
    if ((code == Z_OK || code == Z_BUF_ERROR) && !(stuck && input))
        s->ended = s->truncated = stuck;
    else
        return fail_inflate(s, code, err);
    return CW_OK;
}

static cw_status read_plain(cwi_stream *s, void *to, size_t size, size_t *got, cw_error *err)
{
    cw_status st = fetch_bytes(s, to, size, got, err);
    s->given += *got;
    return st;
}

static cw_status inflate_all(void *stream, void *to, size_t size, size_t *got, cw_error *err)
{
    cwi_stream *s = stream;
    cw_status st = CW_OK;
    size_t n;
    for (*got = 0; st == CW_OK && *got < size && !s->ended; *got += n)
        st = inflate_some(s, (unsigned char *)to + *got, size - *got, &n, err);
    return st;
}

void cwi_stream_inflate_ahead(cwi_stream *s)
{
    struct cwi_stream_ahead *a = NULL;
    if (!s->deflated || s->ended || s->ahead || cwi_threads(0) < 2)
        return;
    a = cwi_alloc_zeroed(1, sizeof *a);
    if (!a)
        return;
    a->stream = *s;
    a->bytes = cwi_ahead_start(inflate_all, &a->stream);
    if (a->bytes)
        s->ahead = a;
    else
        cwi_free(a);
}

static cw_status take_ahead(cwi_stream *s, void *to, size_t size, size_t *got, cw_error *err)
{
    const cw_status st = cwi_ahead_take(s->ahead->bytes, to, size, got, err);
    s->given += *got;
    if (st == CW_OK && *got < size)
        join_ahead(s);
    return st;
}

cw_status cwi_stream_some(cwi_stream *s, void *to, size_t size, size_t *got, cw_error *err)
{
    return s->ahead      ? take_ahead(s, to, size, got, err)
           : s->deflated ? inflate_all(s, to, size, got, err)
                         : read_plain(s, to, size, got, err);
}

cw_status cwi_stream_read(cwi_stream *s, void *to, size_t size, cw_error *err)
{
    const uint64_t start = s->given;
    size_t got;
    cw_status st = cwi_stream_some(s, to, size, &got, err);
    if (st == CW_OK && got < size)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "%s: wanted %zu bytes from byte %llu on, there were %zu",
                        s->truncated ? "the compressed data break off" : "the data end early",
                        size, (unsigned long long)start, got);
    return st;
}

cw_status cwi_stream_skip(cwi_stream *s, uint64_t size, cw_error *err)
{
    unsigned char waste[4096];
    if (!s->deflated && !s->text) {
        s->offset += size;
        s->given += size;
        return CW_OK;
    }
    cw_status st = CW_OK;
    while (st == CW_OK && size > 0) {
        const size_t n = size < sizeof waste ? (size_t)size : sizeof waste;
        st = cwi_stream_read(s, waste, n, err);
        size -= n;
    }
    return st;
}

cw_status cwi_stream_finish(cwi_stream *s, cw_error *err)
{
    unsigned char waste[4096];
    size_t got;
    cw_status st = CW_OK;
    if (!s->deflated)
        return CW_OK;
    const uint64_t enough = s->given + (s->given > DRAIN_BYTES ? s->given : DRAIN_BYTES);
    while (st == CW_OK && !s->ended && s->given < enough)
        st = cwi_stream_some(s, waste, sizeof waste, &got, err);
    if (st == CW_OK && s->truncated)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the compressed data break off after %llu bytes, before their checksum",
                        (unsigned long long)s->given);
    if (st == CW_OK && s->is_bare && s->ended && s->crc != s->expected_crc)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the compressed data are damaged: their checksum is another");
    return st == CW_OK && s->ended ? check_padding(s, err) : st;
}

cw_status cwi_stream_head(int fd, void *to, size_t size, size_t *got, bool *gzipped,
                          cw_error *err)
{
    unsigned char magic[2];
    cwi_stream stream = {0};
    cw_status st = cwi_input_read_at(fd, 0, magic, sizeof magic, got, err);
    *gzipped = *got == 2 && magic[0] == 0x1f && magic[1] == 0x8b;
    if (st == CW_OK)
        st = cwi_stream_open(&stream, fd, 0, *gzipped, err);
    if (st == CW_OK)
        st = cwi_stream_some(&stream, to, size, got, err);
    cwi_stream_close(&stream);
    return st;
}
