/* Decodes chunks of labels as compressed_segmentation: blocks of voxels that are short numbers of
 * entries in tables. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/little_endian.h"
#include "formats/precomputed/precomputed.h"

#include <string.h>

/* A block has two words: the place of its table in the low 24 bits and the bits of a voxel in the high 8,
 * and the place of its voxels. Places count words of 4 bytes from the start of the channel. */
enum { WORD = 4, HEADER_WORDS = 2, TABLE_BITS = 24 };

/* The data of a channel, and one block of it. */
typedef struct channel {
    const unsigned char *words;
    size_t count; /* of words */
    const size_t *sizes, *block;
    size_t grid[3];
    size_t number; /* bytes of a label */
} channel;

static uint32_t get_word(const channel *c, size_t at)
{
    return cwi_get_u32(c->words + WORD * at);
}

/* Multiplies, and stops at the largest number. */
static size_t multiply(size_t a, size_t b)
{
    size_t product;
    return cwi_size_mul(a, b, &product) ? product : SIZE_MAX;
}

void cwi_segmentation_bounds(const size_t sizes[3], const size_t block[3], size_t channels,
                             size_t number, size_t *min, size_t *max)
{
    size_t blocks = 1, voxels = 1, bytes;
    for (int a = 0; a < 3; a++) {
        blocks = multiply(blocks, (sizes[a] - 1) / block[a] + 1);
        voxels = multiply(voxels, block[a]);
    }
    *min = multiply(channels, WORD * (1 + HEADER_WORDS * blocks));
    bytes = multiply(voxels, WORD + number);
    bytes = cwi_size_add(bytes, WORD * HEADER_WORDS + WORD, &bytes) ? bytes : SIZE_MAX;
    bytes = multiply(bytes, blocks);
    *max = multiply(channels, cwi_size_add(bytes, WORD, &bytes) ? bytes : SIZE_MAX);
}

static cw_status fail_block(size_t block, const char *field, uint64_t place, size_t words,
                            cw_error *err)
{
    return cwi_fail(err, CW_ERR_FORMAT,
                    "block %zu of a chunk has its %s at word %llu; its channel has %zu words",
                    block, field, (unsigned long long)place, words);
}

/* Decodes the block at a place of the grid into its voxels of the chunk. */
static cw_status decode_block(const channel *c, const size_t at[3], unsigned char *to,
                              cw_error *err)
{
    const size_t index = at[0] + c->grid[0] * (at[1] + c->grid[1] * at[2]);
    const uint32_t head = get_word(c, HEADER_WORDS * index);
    const uint64_t values = get_word(c, HEADER_WORDS * index + 1);
    const uint64_t table = head & (((uint32_t)1 << TABLE_BITS) - 1);
    const unsigned bits = head >> TABLE_BITS;
    const uint64_t mask = ((uint64_t)1 << bits % 64) - 1;
    size_t first[3], end[3];
    if (bits > 32 || (bits & (bits - 1)))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "block %zu of a chunk has %u bits a voxel; 0, 1, 2, 4, 8, 16 or 32 were "
            "expected",
            index, bits);
    for (int a = 0; a < 3; a++) {
        first[a] = at[a] * c->block[a];
        end[a] = first[a] + c->block[a] < c->sizes[a] ? first[a] + c->block[a] : c->sizes[a];
    }
    for (size_t z = first[2]; z < end[2]; z++)
        for (size_t y = first[1]; y < end[1]; y++)
            for (size_t x = first[0]; x < end[0]; x++) {
                const size_t voxel =
                    x - first[0] + c->block[0] * (y - first[1] + c->block[1] * (z - first[2]));
                const uint64_t word = values + (uint64_t)voxel * bits / 32;
                if (bits && word >= c->count)
                    return fail_block(index, "voxels", word, c->count, err);
                const uint64_t entry =
                    bits ? get_word(c, (size_t)word) >> (uint64_t)voxel * bits % 32 & mask : 0;
                const uint64_t label = table + entry * (c->number / WORD);
                if (label + c->number / WORD > c->count)
                    return fail_block(index, "labels", label, c->count, err);
                uint64_t value = get_word(c, (size_t)label);
                const uint32_t narrow = (uint32_t)value;
                if (c->number == 2 * WORD)
                    value |= (uint64_t)get_word(c, (size_t)label + 1) << 32;
                memcpy(to + c->number * (x + c->sizes[0] * (y + c->sizes[1] * z)),
                       c->number == WORD ? (const void *)&narrow : (const void *)&value,
                       c->number);
            }
    return CW_OK;
}

static cw_status decode_channel(channel *c, unsigned char *to, cw_error *err)
{
    size_t at[3];
    cw_status st = CW_OK;
    for (at[2] = 0; at[2] < c->grid[2]; at[2]++)
        for (at[1] = 0; at[1] < c->grid[1]; at[1]++)
            for (at[0] = 0; st == CW_OK && at[0] < c->grid[0]; at[0]++)
                st = decode_block(c, at, to, err);
    return st;
}

cw_status cwi_segmentation_decode(const unsigned char *packed, size_t packed_size,
                                  const size_t sizes[3], const size_t block[3], size_t channels,
                                  size_t number, void *to, cw_error *err)
{
    const size_t words = packed_size / WORD;
    size_t blocks = 1, voxels = 1;
    cw_status st = CW_OK;
    channel c = {.sizes = sizes, .block = block, .number = number};
    for (int a = 0; a < 3; a++) {
        c.grid[a] = (sizes[a] - 1) / block[a] + 1;
        blocks *= c.grid[a];
        voxels *= sizes[a];
    }
    for (size_t n = 0; st == CW_OK && n < channels; n++) {
        const size_t start = n < words ? cwi_get_u32(packed + WORD * n) : SIZE_MAX;
        if (start > words || words - start < HEADER_WORDS * blocks)
            return cwi_fail(
                err, CW_ERR_FORMAT,
                "channel %zu of a chunk starts at word %zu of %zu; %zu blocks do not "
                "fit behind it",
                n, start, words, blocks);
        c.words = packed + WORD * start;
        c.count = words - start;
        st = decode_channel(&c, (unsigned char *)to + n * voxels * number, err);
    }
    return st;
}
