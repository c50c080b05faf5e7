/* The hash by which Neuroglancer spreads numbers of chunks and segments over shards. */
#ifndef FORMATS_PRECOMPUTED_SHARD_HASH_H
#define FORMATS_PRECOMPUTED_SHARD_HASH_H

#include <stdint.h>

/* Returns the low 64 bits of MurmurHash3_x86_128 of a number, low byte first, with seed 0
 * [Appleby2011]. */
uint64_t cwi_murmur_hash(uint64_t number);

/* Returns a number whose lowest bits are ones; `count` of them, at most 64. */
static inline uint64_t cwi_low_bits(unsigned count)
{
    return count >= 64 ? UINT64_MAX : ((uint64_t)1 << count) - 1;
}

#endif
