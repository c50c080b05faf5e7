/* Decodes chunks of Zarr by their codecs, the last first. */
#include "formats/zarr/zarr_decode.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/block_reader.h"
#include "formats/bytes/byte_order.h"
#include "formats/bytes/bzip2.h"
#include "formats/bytes/isal.h"

#include <string.h>

static const char *const codec_names[CWI_ZARR_CODEC_COUNT] = {
#define ROW(constant, name) [constant] = name,
    CWI_ZARR_CODEC_TABLE(ROW)
#undef ROW
};

cw_status cwi_zarr_codec_check(cwi_zarr_codec codec, cw_error *err)
{
    const bool needs_lz4 = codec == CWI_ZARR_LZ4 || codec == CWI_ZARR_LZ4_FRAMES;
    const bool is_missing = (codec == CWI_ZARR_ZSTD && !cwi_zarr_zstd_present()) ||
                            (codec == CWI_ZARR_BLOSC && !cwi_zarr_blosc_present()) ||
                            (codec == CWI_ZARR_BZ2 && !cwi_bzip2_present()) ||
                            (needs_lz4 && !cwi_lz4_present());
    return is_missing ? cwi_fail(err, CW_ERR_UNSUPPORTED,
                                 "compressed with %s, which this build lacks (lib%s-dev)",
                                 codec_names[codec], needs_lz4 ? "lz4" : codec_names[codec])
                      : CW_OK;
}

/* --- sizes -------------------------------------------------------------------------------- */

enum { CHECKSUM_BYTES = 4 };

static size_t add_codec_bytes(cwi_zarr_codec codec, size_t size, bool *exact)
{
    if (codec == CWI_ZARR_CRC32C)
        return size + CHECKSUM_BYTES;
    *exact = false;
    return size + size / (codec == CWI_ZARR_LZ4_FRAMES ? 2 : 8) + CWI_ZARR_SLACK_BYTES;
}

size_t cwi_zarr_packed_max(const cwi_zarr_chain *chain, size_t size, bool *exact)
{
    *exact = true;
    for (size_t n = 0; n < chain->count; n++)
        size = add_codec_bytes(chain->codecs[n], size, exact);
    return size;
}

/* Returns the bytes that one packed byte can stand for at most. Deflate packs 1032, LZ4 255. A
 * block of Zstandard packs 128 KiB into 4 bytes, and one of Blosc may be such blocks. One of bzip2
 * holds runs of runs. */
static uint64_t find_ratio(cwi_zarr_codec codec)
{
    switch (codec) {
    case CWI_ZARR_ZLIB:
    case CWI_ZARR_GZIP:
        return CWI_ZARR_DEFLATE_RATIO;
    case CWI_ZARR_LZ4:
    case CWI_ZARR_LZ4_FRAMES:
        return 255;
    case CWI_ZARR_BZ2:
        return CWI_BZIP2_BLOCK / CWI_BZIP2_PACKED;
    case CWI_ZARR_ZSTD:
    case CWI_ZARR_BLOSC:
        return 32768;
    default:
        return 1;
    }
}

cw_status cwi_zarr_packed_check(const cwi_zarr_chain *chain, uint64_t packed, size_t size,
                                cw_error *err)
{
    bool exact;
    const size_t max = cwi_zarr_packed_max(chain, size, &exact);
    if (exact && packed != max)
        return cwi_fail(err, CW_ERR_FORMAT, "a chunk has %llu bytes; %zu were expected",
                        (unsigned long long)packed, max);
    if (packed > max)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "a chunk has %llu bytes; its %zu bytes of numbers take %zu at most",
                        (unsigned long long)packed, size, max);
    uint64_t max_size = packed;
    for (size_t n = chain->count; n > 0 && max_size < size; n--)
        max_size = max_size >> 40 ? max_size : max_size * find_ratio(chain->codecs[n - 1]);
    if (max_size < size)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "a chunk has %llu bytes, too few for its %zu bytes of numbers",
                        (unsigned long long)packed, size);
    return CW_OK;
}

/* --- single codecs ------------------------------------------------------------------------ */

/* Inflates by ISA-L, which takes half the time. Returns false for damaged data, and where it
 * cannot tell. */
static bool inflate_by_isal(z_stream *z)
{
    void *isal = NULL;
    int code = Z_OK;
    if (!cwi_isal_open(&isal) || !isal)
        return false;
    while (code == Z_OK || (code == Z_STREAM_END && z->avail_in > 0)) {
        const uInt in = z->avail_in, out = z->avail_out;
        code = cwi_isal_inflate(isal, z);
        if (code == Z_OK && in == z->avail_in && out == z->avail_out)
            break;
    }
    cwi_free(isal);
    return code == Z_STREAM_END;
}

/* Inflates gzip members, or one zlib stream. zlib is the judge of what ISA-L does not take. */
static bool inflate_bytes(const unsigned char *packed, size_t packed_size, void *to,
                          size_t capacity, size_t *got, bool *starved)
{
    const z_stream start = {.next_in = packed,
                            .avail_in = (uInt)packed_size,
                            .next_out = to,
                            .avail_out = (uInt)capacity};
    z_stream z = start;
    *starved = false;
    if (inflate_by_isal(&z)) {
        *got = capacity - z.avail_out;
        return true;
    }
    z = start;
    cwi_zlib_use_memory(&z);
    int code = inflateInit2(&z, MAX_WBITS + 32); /* gzip or zlib, by the header found */
    while (code == Z_OK) {
        code = inflate(&z, Z_FINISH);
        if (code != Z_STREAM_END || z.avail_in == 0)
            break;
        code = inflateReset(&z);
    }
    *starved = code == Z_MEM_ERROR;
    *got = capacity - z.avail_out;
    inflateEnd(&z);
    return code == Z_STREAM_END;
}

/* Decodes a block of LZ4 behind its decoded size, as numcodecs stores it. */
static bool decode_lz4(const unsigned char *packed, size_t packed_size, void *to,
                       size_t capacity, size_t *got)
{
    if (packed_size < 4)
        return false;
    *got = (size_t)packed[0] | (size_t)packed[1] << 8 | (size_t)packed[2] << 16 |
           (size_t)packed[3] << 24;
    return *got <= capacity && cwi_lz4_decode(packed + 4, packed_size - 4, to, *got);
}

/* Decompresses streams of bzip2 in a row. */
static bool decode_bz2(const unsigned char *packed, size_t packed_size, void *to,
                       size_t capacity, size_t *got, bool *starved)
{
    z_stream z = {.next_in = packed,
                  .avail_in = (uInt)packed_size,
                  .next_out = to,
                  .avail_out = (uInt)capacity};
    void *state;
    int code = cwi_bzip2_open(&state) ? Z_OK : Z_MEM_ERROR;
    while (code == Z_OK || (code == Z_STREAM_END && z.avail_in > 0)) {
        const uInt in = z.avail_in, out = z.avail_out;
        code = cwi_bzip2_inflate(state, &z);
        if (code == Z_OK && in == z.avail_in && out == z.avail_out)
            break;
    }
    cwi_bzip2_close(state);
    *starved = code == Z_MEM_ERROR;
    *got = capacity - z.avail_out;
    return code == Z_STREAM_END;
}

static bool check_crc(const unsigned char *packed, size_t packed_size, void *to,
                      size_t capacity, size_t *got)
{
    if (packed_size < CHECKSUM_BYTES || packed_size - CHECKSUM_BYTES > capacity)
        return false;
    *got = packed_size - CHECKSUM_BYTES;
    const unsigned char *sum = packed + *got;
    memcpy(to, packed, *got);
    return cwi_crc32c(packed, *got) == ((uint32_t)sum[0] | (uint32_t)sum[1] << 8 |
                                        (uint32_t)sum[2] << 16 | (uint32_t)sum[3] << 24);
}

cw_status cwi_zarr_unpack(cwi_zarr_codec codec, const unsigned char *packed, size_t packed_size,
                          void *to, size_t capacity, size_t *got, cw_error *err)
{
    bool starved = false, fine = false;
    switch (codec) {
    case CWI_ZARR_ZLIB:
    case CWI_ZARR_GZIP:
        fine = inflate_bytes(packed, packed_size, to, capacity, got, &starved);
        break;
    case CWI_ZARR_ZSTD:
        fine = cwi_zarr_zstd_decode(packed, packed_size, to, capacity, got, &starved);
        break;
    case CWI_ZARR_BLOSC:
        fine = cwi_zarr_blosc_decode(packed, packed_size, to, capacity, got, &starved);
        break;
    case CWI_ZARR_LZ4:
        fine = decode_lz4(packed, packed_size, to, capacity, got);
        break;
    case CWI_ZARR_LZ4_FRAMES:
        fine = cwi_zarr_lz4_frames_decode(packed, packed_size, to, capacity, got);
        break;
    case CWI_ZARR_BZ2:
        fine = decode_bz2(packed, packed_size, to, capacity, got, &starved);
        break;
    default:
        fine = check_crc(packed, packed_size, to, capacity, got);
        break;
    }
    if (starved)
        return cwi_fail_memory(err);
    if (!fine && codec == CWI_ZARR_CRC32C)
        return cwi_fail(err, CW_ERR_FORMAT, "a chunk is damaged: its checksum is wrong");
    return fine ? CW_OK
                : cwi_fail(err, CW_ERR_FORMAT,
                           "a chunk is damaged, or has more than its %zu bytes (%s)", capacity,
                           codec_names[codec]);
}

/* --- all codecs --------------------------------------------------------------------------- */

/* The buffers between two codecs, in turn. */
typedef struct stages {
    unsigned char *between[2];
    const unsigned char *from;
    size_t from_size;
} stages;

/* Decodes all codecs behind the first into memory of their own. */
static cw_status decode_stages(const cwi_zarr_chain *chain, size_t size, stages *s,
                               cw_error *err)
{
    for (size_t n = chain->count; n > 1; n--) {
        cwi_zarr_chain below = *chain;
        bool exact;
        size_t got;
        below.count = n - 1;
        const size_t capacity = cwi_zarr_packed_max(&below, size, &exact);
        unsigned char **to = &s->between[n % 2];
        cwi_free(*to);
        *to = cwi_alloc_array(capacity, 1);
        if (!*to)
            return cwi_fail_memory(err);
        cw_status st = cwi_zarr_unpack(chain->codecs[n - 1], s->from, s->from_size, *to,
                                       capacity, &got, err);
        if (st != CW_OK)
            return st;
        s->from = *to;
        s->from_size = got;
    }
    return CW_OK;
}

cw_status cwi_zarr_decode(const cwi_zarr_chain *chain, const unsigned char *packed,
                          size_t packed_size, void *to, size_t size, size_t number,
                          cw_error *err)
{
    stages s = {.from = packed, .from_size = packed_size};
    size_t got = packed_size;
    cw_status st = decode_stages(chain, size, &s, err);
    if (st == CW_OK && chain->count > 0)
        st = cwi_zarr_unpack(chain->codecs[0], s.from, s.from_size, to, size, &got, err);
    else if (st == CW_OK && got == size && to != packed)
        memcpy(to, packed, size);
    cwi_free(s.between[0]);
    cwi_free(s.between[1]);
    if (st == CW_OK && got != size)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "a chunk has %zu bytes of numbers; %zu were expected", got, size);
    if (st == CW_OK && chain->big_endian != cwi_machine_is_big_endian())
        cwi_swap_bytes(to, size / number, number);
    return st;
}
