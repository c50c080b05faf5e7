/* Finds chunks in shards by 64-bit numbers: Morton codes, hashes, and tables of minishards. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/precomputed/precomputed.h"
#include "formats/precomputed/shard_hash.h"
#include "formats/zarr/zarr_decode.h"

#include <string.h>

/* A shard begins with the places of its minishards' tables: first byte and end, behind all of them.
 * Such a table has numbers of chunks, then places, then sizes. */
enum { WORD = 8, PLACE_BYTES = 2 * WORD, ENTRY_WORDS = 3, ENTRY_BYTES = ENTRY_WORDS * WORD };

/* Interleaves the bits of a place, leaving out those that are 0 for all chunks of the grid. */
static uint64_t make_morton(const size_t grid[3], const size_t at[3])
{
    uint64_t code = 0;
    unsigned used = 0;
    for (unsigned bit = 0; bit < 64; bit++)
        for (int a = 0; a < 3; a++)
            if (grid[a] - 1 >= (size_t)1 << bit && used < 64)
                code |= (uint64_t)(at[a] >> bit & 1) << used++;
    return code;
}

cwi_shard_place cwi_find_shard(const cwi_chunk_storage *s, const size_t grid[3],
                               const size_t at[3])
{
    cwi_shard_place place = {.chunk = make_morton(grid, at)};
    const uint64_t shifted = s->preshift_bits < 64 ? place.chunk >> s->preshift_bits : 0;
    const uint64_t hash = s->is_hashed ? cwi_murmur_hash(shifted) : shifted;
    place.shard_minishard = hash & cwi_low_bits(s->shard_bits + s->minishard_bits);
    place.shard = place.shard_minishard >> s->minishard_bits;
    return place;
}

/* Returns the largest table that is read: an entry for each chunk of the volume. */
static size_t limit_table(const cwi_zarr_array *a)
{
    size_t bytes = ENTRY_BYTES;
    for (size_t d = 0; d < a->rank; d++)
        if (!cwi_size_mul(bytes, (a->shape[d] - 1) / a->chunk[d] + 1, &bytes))
            bytes = CWI_ZARR_INDEX_BYTES;
    return bytes < CWI_ZARR_INDEX_BYTES ? bytes : CWI_ZARR_INDEX_BYTES;
}

/* Reads bytes of a file that are there. */
static cw_status read_bytes(int fd, uint64_t offset, void *to, size_t size, cw_error *err)
{
    size_t got = 0;
    cw_status st = cwi_input_read_at(fd, offset, to, size, &got, err);
    return st == CW_OK && got < size
               ? cwi_fail(err, CW_ERR_FORMAT, "the file ends inside the index of a shard")
               : st;
}

static uint64_t get_word(const unsigned char *from)
{
    uint64_t word = 0;
    for (int n = WORD; n > 0; n--)
        word = word << 8 | from[n - 1];
    return word;
}

/* Decodes a table of `count` entries, and sums up its differences: an entry is the number, first byte
 * and size of a chunk. */
static cw_status sum_table(const unsigned char *table, uint64_t base, cwi_zarr_shard *shard,
                           cw_error *err)
{
    uint64_t number = 0, offset = base;
    for (size_t n = 0; n < shard->count; n++) {
        const uint64_t step = get_word(table + WORD * n);
        const uint64_t size = get_word(table + WORD * (2 * shard->count + n));
        if (n > 0 && (step == 0 || number + step < number))
            return cwi_fail(err, CW_ERR_FORMAT,
                            "the numbers of chunks in a minishard do not rise, at entry %zu",
                            n);
        number += step;
        offset += get_word(table + WORD * (shard->count + n));
        if (offset < base)
            return cwi_fail(
                err, CW_ERR_FORMAT,
                "a minishard places chunk %llu at byte %llu; the index ends at %llu",
                (unsigned long long)number, (unsigned long long)offset,
                (unsigned long long)base);
        shard->index[ENTRY_WORDS * n] = number;
        shard->index[ENTRY_WORDS * n + 1] = offset;
        shard->index[ENTRY_WORDS * n + 2] = size;
        offset += size;
    }
    return CW_OK;
}

/* Reads the encoded bytes of a table, and decodes them. */
static cw_status read_table(const cwi_zarr *z, cwi_zarr_shard *shard, uint64_t offset,
                            size_t packed_size, uint64_t base, cw_error *err)
{
    const cwi_chunk_storage *s = z->extra;
    const size_t limit = limit_table(&z->array);
    const size_t capacity = !s->index_is_gzip ? packed_size
                            : packed_size > limit / CWI_ZARR_DEFLATE_RATIO
                                ? limit
                                : packed_size * CWI_ZARR_DEFLATE_RATIO;
    size_t got = packed_size;
    if (capacity > limit || packed_size > limit + limit / 8 + CWI_ZARR_SLACK_BYTES)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the table of a minishard has %zu bytes; its chunks take %zu at most",
                        packed_size, limit);
    unsigned char *packed = cwi_alloc_array(packed_size, 1);
    unsigned char *table = s->index_is_gzip ? cwi_alloc_array(capacity, 1) : packed;
    cw_status st = packed && table ? read_bytes(shard->fd, offset, packed, packed_size, err)
                                   : cwi_fail_memory(err);
    if (st == CW_OK && s->index_is_gzip)
        st = cwi_zarr_unpack(CWI_ZARR_GZIP, packed, packed_size, table, capacity, &got, err);
    if (st == CW_OK && got % ENTRY_BYTES)
        st = cwi_fail(err, CW_ERR_FORMAT,
                      "the table of a minishard has %zu bytes; a multiple of %d was expected",
                      got, ENTRY_BYTES);
    if (st == CW_OK) {
        shard->count = got / ENTRY_BYTES;
        shard->index = cwi_alloc_array(shard->count, ENTRY_BYTES);
        shard->bytes = shard->index ? got : 0;
        st = shard->index ? sum_table(table, base, shard, err) : cwi_fail_memory(err);
    }
    if (table != packed)
        cwi_free(table);
    cwi_free(packed);
    return st;
}

cw_status cwi_minishard_read(const cwi_zarr *z, cwi_zarr_shard *shard, cw_error *err)
{
    const cwi_chunk_storage *s = z->extra;
    const uint64_t base = (uint64_t)PLACE_BYTES << s->minishard_bits;
    const uint64_t number = shard->key & cwi_low_bits(s->minishard_bits);
    unsigned char place[PLACE_BYTES];
    if (shard->size < base)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "a shard has %llu bytes; its index alone takes %llu",
                        (unsigned long long)shard->size, (unsigned long long)base);
    cw_status st = read_bytes(shard->fd, PLACE_BYTES * number, place, sizeof place, err);
    if (st != CW_OK)
        return st;
    const uint64_t first = get_word(place), end = get_word(place + WORD);
    if (first == end)
        return CW_OK;
    if (first > end || end > shard->size - base)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the index of a shard places minishard %llu at bytes %llu to %llu; the "
                        "file has %llu behind it",
                        (unsigned long long)number, (unsigned long long)first,
                        (unsigned long long)end, (unsigned long long)(shard->size - base));
    return read_table(z, shard, base + first, (size_t)(end - first), base, err);
}

cw_status cwi_minishard_find(const cwi_zarr_shard *shard, uint64_t chunk, uint64_t *offset,
                             uint64_t *size, bool *missing, cw_error *err)
{
    size_t low = 0, high = shard->count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (shard->index[ENTRY_WORDS * middle] < chunk)
            low = middle + 1;
        else
            high = middle;
    }
    *missing = low == shard->count || shard->index[ENTRY_WORDS * low] != chunk;
    if (*missing)
        return CW_OK;
    *offset = shard->index[ENTRY_WORDS * low + 1];
    *size = shard->index[ENTRY_WORDS * low + 2];
    return *offset <= shard->size && *size <= shard->size - *offset
               ? CW_OK
               : cwi_fail(
                     err, CW_ERR_FORMAT,
                     "a minishard places chunk %llu at byte %llu, %llu bytes long; the file "
                     "has %llu",
                     (unsigned long long)chunk, (unsigned long long)*offset,
                     (unsigned long long)*size, (unsigned long long)shard->size);
}
