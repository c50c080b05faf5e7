/* Writes segments to files of their own, or to shards. A shard is kept in memory until it is whole, as
 * its index, which is its beginning, tells where everything lies. */
#include "formats/neuroglancer/segment_store.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/little_endian.h"
#include "formats/precomputed/shard_hash.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    MAX_FILES = 10000,         /* segments that get files of their own */
    SHARD_SEGMENTS = 1024,     /* in a shard on average */
    SHARD_TRIANGLES = 1 << 24, /* ... of a few bytes each, at most */
    MINISHARD_BITS = 4,        /* tables of about 64 segments */
    WORD = 8,
    ENTRY_WORDS = 3,
    NAME_BYTES = 40
};

/* --- order -------------------------------------------------------------------------------- */

/* A segment's place, to sort by. */
typedef struct placed {
    uint64_t shard, minishard, id;
    size_t index;
} placed;

static uint64_t hash_id(const cwi_segment_bits *bits, uint64_t id)
{
    return cwi_murmur_hash(id) & cwi_low_bits(bits->shard + bits->minishard);
}

static int compare_places(const void *a, const void *b)
{
    const placed *p = a, *q = b;
    if (p->shard != q->shard)
        return p->shard < q->shard ? -1 : 1;
    if (p->minishard != q->minishard)
        return p->minishard < q->minishard ? -1 : 1;
    return (p->id > q->id) - (p->id < q->id);
}

static cw_status sort_segments(const cwi_segment_bits *bits, const cwi_segments *segments,
                               size_t *order, cw_error *err)
{
    placed *places = cwi_alloc_array(segments->count, sizeof *places);
    if (!places)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < segments->count; n++) {
        const uint64_t hash = hash_id(bits, segments->items[n].id);
        places[n] = (placed){.shard = hash >> bits->minishard,
                             .minishard = hash & cwi_low_bits(bits->minishard),
                             .id = segments->items[n].id,
                             .index = n};
    }
    qsort(places, segments->count, sizeof *places, compare_places);
    for (size_t n = 0; n < segments->count; n++)
        order[n] = places[n].index;
    cwi_free(places);
    return CW_OK;
}

cw_status cwi_segment_store_open(cwi_segment_store *store, cwi_outfolder *folder,
                                 const cwi_segments *segments, uint64_t triangles,
                                 size_t **order, cw_error *err)
{
    cwi_segment_bits *bits = &store->bits;
    *store = (cwi_segment_store){.folder = folder};
    *order = cwi_alloc_array(segments->count, sizeof **order);
    if (!*order)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < segments->count; n++)
        (*order)[n] = n;
    if (segments->count <= MAX_FILES)
        return CW_OK;
    *bits = (cwi_segment_bits){.is_sharded = true, .minishard = MINISHARD_BITS};
    while (segments->count >> bits->shard > SHARD_SEGMENTS ||
           triangles >> bits->shard > SHARD_TRIANGLES)
        bits->shard++;
    return sort_segments(bits, segments, *order, err);
}

/* --- shards ------------------------------------------------------------------------------- */

static cw_status append_bytes(cwi_segment_store *s, const void *bytes, size_t size,
                              cw_error *err)
{
    size_t end;
    if (!cwi_size_add(s->size, size, &end))
        return cwi_fail_memory(err);
    if (end > s->capacity) {
        const size_t capacity = end + end / 2;
        unsigned char *longer = cwi_realloc_array(s->bytes, capacity, 1);
        if (!longer)
            return cwi_fail_memory(err);
        s->bytes = longer;
        s->capacity = capacity;
    }
    memcpy(s->bytes + s->size, bytes, size);
    s->size = end;
    return CW_OK;
}

/* Appends the table of the entries of one minishard, as differences: numbers, places of manifests behind
 * the end of the one before, and their sizes. */
static cw_status append_table(cwi_segment_store *s, size_t first, size_t end, cw_error *err)
{
    const size_t count = end - first, bytes = WORD * ENTRY_WORDS * count;
    unsigned char *table = cwi_alloc_array(bytes, 1), *to = table;
    if (!table)
        return cwi_fail_memory(err);
    for (size_t n = first; n < end; n++)
        to = cwi_put_u64(to, s->entries[n].id - (n > first ? s->entries[n - 1].id : 0));
    for (size_t n = first; n < end; n++) {
        const cwi_shard_entry *before = n > first ? &s->entries[n - 1] : NULL;
        to = cwi_put_u64(to,
                         s->entries[n].offset - (before ? before->offset + before->size : 0));
    }
    for (size_t n = first; n < end; n++)
        to = cwi_put_u64(to, s->entries[n].size);
    cw_status st = append_bytes(s, table, bytes, err);
    cwi_free(table);
    return st;
}

/* Writes the shard that was filled: its index, segments, and the tables of its minishards. */
static cw_status write_shard(cwi_segment_store *s, cw_error *err)
{
    char name[NAME_BYTES];
    unsigned char index[2 * WORD << MINISHARD_BITS] = {0};
    cw_status st = CW_OK;
    if (!s->entry_count)
        return CW_OK;
    for (size_t first = 0, end; st == CW_OK && first < s->entry_count; first = end) {
        const uint64_t minishard = s->entries[first].minishard;
        for (end = first; end < s->entry_count && s->entries[end].minishard == minishard;)
            end++;
        unsigned char *to = cwi_put_u64(index + 2 * WORD * minishard, s->size);
        st = append_table(s, first, end, err);
        cwi_put_u64(to, s->size);
    }
    snprintf(name, sizeof name, "%0*" PRIx64 ".shard", (int)(s->bits.shard + 3) / 4, s->shard);
    if (st == CW_OK)
        st = cwi_outfolder_begin(s->folder, name, err);
    if (st == CW_OK)
        st = cwi_outfolder_write(s->folder, index, sizeof index, err);
    if (st == CW_OK)
        st = cwi_outfolder_write(s->folder, s->bytes, s->size, err);
    if (st == CW_OK)
        st = cwi_outfolder_end(s->folder, err);
    s->size = s->entry_count = 0;
    return st;
}

/* --- segments ----------------------------------------------------------------------------- */

cw_status cwi_segment_begin(cwi_segment_store *s, uint64_t id, cw_error *err)
{
    char name[NAME_BYTES];
    cw_status st = CW_OK;
    if (!s->bits.is_sharded) {
        snprintf(name, sizeof name, "%" PRIu64, id);
        return cwi_outfolder_begin(s->folder, name, err);
    }
    const uint64_t shard = hash_id(&s->bits, id) >> s->bits.minishard;
    if (shard != s->shard)
        st = write_shard(s, err);
    s->shard = shard;
    return st;
}

cw_status cwi_segment_append(cwi_segment_store *s, const void *bytes, size_t size,
                             cw_error *err)
{
    return s->bits.is_sharded ? append_bytes(s, bytes, size, err)
                              : cwi_outfolder_write(s->folder, bytes, size, err);
}

cw_status cwi_segment_end(cwi_segment_store *s, uint64_t id, const void *manifest, size_t size,
                          cw_error *err)
{
    char name[NAME_BYTES];
    if (!s->bits.is_sharded) {
        snprintf(name, sizeof name, "%" PRIu64 ".index", id);
        cw_status st = cwi_outfolder_end(s->folder, err);
        return st == CW_OK ? cwi_outfolder_save(s->folder, name, manifest, size, err) : st;
    }
    cwi_shard_entry *longer =
        cwi_grow_array(s->entries, s->entry_count, &s->entry_capacity, sizeof *s->entries);
    if (!longer)
        return cwi_fail_memory(err);
    s->entries = longer;
    s->entries[s->entry_count++] =
        (cwi_shard_entry){.id = id,
                          .minishard = hash_id(&s->bits, id) & cwi_low_bits(s->bits.minishard),
                          .offset = s->size,
                          .size = size};
    return append_bytes(s, manifest, size, err);
}

cw_status cwi_segment_store_finish(cwi_segment_store *s, cw_error *err)
{
    return write_shard(s, err);
}

void cwi_segment_store_close(cwi_segment_store *s)
{
    cwi_free(s->bytes);
    cwi_free(s->entries);
    *s = (cwi_segment_store){0};
}
