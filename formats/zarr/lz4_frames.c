/* Decodes what LZ4BlockOutputStream of lz4-java writes: frames of a block each, with checksums. */
#include "formats/bytes/block_reader.h"
#include "formats/bytes/little_endian.h"
#include "formats/zarr/zarr_decode.h"

#include <string.h>

/* A frame: a mark, a byte whose high half is the method, packed size, size, and checksum. One of no
 * bytes ends the data. */
static const char MARK[] = "LZ4Block";
enum { MARK_BYTES = 8, HEADER_BYTES = MARK_BYTES + 13, METHOD_RAW = 0x10, METHOD_LZ4 = 0x20 };

/* The checksum is xxHash32 [Collet2012] with this seed, of which 28 bits are kept. */
static const uint32_t SEED = 0x9747b28c, KEPT_BITS = 0x0fffffff;
static const uint32_t PRIMES[] = {0x9e3779b1, 0x85ebca77, 0xc2b2ae3d, 0x27d4eb2f, 0x165667b1};

static uint32_t rotate_left(uint32_t x, int bits)
{
    return x << bits | x >> (32 - bits);
}

/* Mixes 16 bytes at a time into four sums, and returns them as one. */
static uint32_t hash_stripes(const unsigned char *bytes, size_t size)
{
    uint32_t sums[] = {SEED + PRIMES[0] + PRIMES[1], SEED + PRIMES[1], SEED, SEED - PRIMES[0]};
    for (size_t at = 0; at + 16 <= size; at += 16)
        for (size_t n = 0; n < 4; n++)
            sums[n] = PRIMES[0] *
                      rotate_left(sums[n] + PRIMES[1] * cwi_get_u32(bytes + at + 4 * n), 13);
    return rotate_left(sums[0], 1) + rotate_left(sums[1], 7) + rotate_left(sums[2], 12) +
           rotate_left(sums[3], 18);
}

static uint32_t hash_bytes(const unsigned char *bytes, size_t size)
{
    uint32_t hash = (size < 16 ? SEED + PRIMES[4] : hash_stripes(bytes, size)) + (uint32_t)size;
    size_t at = size / 16 * 16;
    for (; at + 4 <= size; at += 4)
        hash = PRIMES[3] * rotate_left(hash + PRIMES[2] * cwi_get_u32(bytes + at), 17);
    for (; at < size; at++)
        hash = PRIMES[0] * rotate_left(hash + PRIMES[4] * bytes[at], 11);
    hash = PRIMES[1] * (hash ^ hash >> 15);
    hash = PRIMES[2] * (hash ^ hash >> 13);
    return hash ^ hash >> 16;
}

bool cwi_zarr_lz4_frames_decode(const unsigned char *packed, size_t packed_size, void *to,
                                size_t capacity, size_t *got)
{
    unsigned char *out = to;
    *got = 0;
    for (size_t at = 0; at < packed_size;) {
        const unsigned char *header = packed + at;
        if (packed_size - at < HEADER_BYTES || memcmp(header, MARK, MARK_BYTES) != 0)
            return false;
        const int method = header[MARK_BYTES] & 0xf0;
        const size_t there = cwi_get_u32(header + 9), size = cwi_get_u32(header + 13);
        at += HEADER_BYTES;
        if (there > packed_size - at || size > capacity - *got)
            return false;
        if (size == 0)
            return there == 0 && at == packed_size;
        if (method == METHOD_RAW && there == size)
            memcpy(out + *got, packed + at, size);
        else if (method != METHOD_LZ4 || !cwi_lz4_decode(packed + at, there, out + *got, size))
            return false;
        if ((hash_bytes(out + *got, size) & KEPT_BITS) != cwi_get_u32(header + 17))
            return false;
        at += there;
        *got += size;
    }
    return true;
}
