/* Hashes numbers for shards. */
#include "formats/precomputed/shard_hash.h"

static uint32_t rotate_left(uint32_t x, int bits)
{
    return x << bits | x >> (32 - bits);
}

static uint32_t mix_word(uint32_t x)
{
    x = (x ^ x >> 16) * 0x85ebca6b;
    x = (x ^ x >> 13) * 0xc2b2ae35;
    return x ^ x >> 16;
}

/* Eight bytes are all in the tail of [Appleby2011]; its last two words start equal and stay so. */
uint64_t cwi_murmur_hash(uint64_t number)
{
    enum { BYTES = 8 };
    const uint32_t low = (uint32_t)number, high = (uint32_t)(number >> 32);
    uint32_t h1 = rotate_left(low * 0x239b961b, 15) * 0xab0e9789;
    uint32_t h2 = rotate_left(high * 0xab0e9789, 16) * 0x38b34ae5, rest = BYTES;
    h1 ^= BYTES;
    h2 ^= BYTES;
    h1 += h2 + 2 * rest;
    h2 += h1;
    rest += h1;
    h1 = mix_word(h1);
    h2 = mix_word(h2);
    rest = mix_word(rest);
    h1 += h2 + 2 * rest;
    h2 += h1;
    return (uint64_t)h2 << 32 | h1;
}
