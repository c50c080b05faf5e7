/* Finds and decodes single chunks of a Zarr array: files, and parts of shards. */
#define _GNU_SOURCE /* close */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/zarr/zarr_decode.h"
#include "formats/zarr/zarr_dialect.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

void cwi_zarr_print_key(const cwi_zarr_array *a, const size_t at[CWI_ZARR_RANK],
                        char key[CWI_ZARR_KEY_BYTES])
{
    const size_t capacity = CWI_ZARR_KEY_BYTES;
    size_t used = (size_t)snprintf(key, capacity, "%s%s%s", a->path, *a->path ? "/" : "",
                                   a->has_prefix ? "c" : "");
    for (size_t d = 0; d < a->rank && used < capacity; d++) {
        const bool separates = d > 0 || a->has_prefix;
        used += (size_t)snprintf(key + used, capacity - used, "%.*s%zu", separates ? 1 : 0,
                                 &a->separator, at[d]);
    }
}

cw_status cwi_zarr_decode_part(const cwi_zarr_array *a, int fd, uint64_t offset, uint64_t size,
                               size_t bytes, void **to, cw_error *err)
{
    size_t got = 0;
    cw_status st = cwi_zarr_packed_check(&a->chain, size, bytes, err);
    if (st != CW_OK)
        return st;
    if (!*to)
        *to = cwi_alloc_large(a->chunk_bytes, 1);
    unsigned char *packed = a->chain.count ? cwi_alloc_array((size_t)size, 1) : *to;
    if (!*to || !packed)
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_input_read_at(fd, offset, packed, (size_t)size, &got, err);
    if (st == CW_OK && got < size)
        st = cwi_fail(err, CW_ERR_FORMAT, "the file ends inside a chunk");
    if (st == CW_OK)
        st = cwi_zarr_decode(&a->chain, packed, (size_t)size, *to, bytes, a->stored_bytes, err);
    if (a->chain.count)
        cwi_free(packed);
    return st;
}

void cwi_zarr_spread(const cwi_zarr_array *a, const size_t sizes[CWI_ZARR_RANK], void *chunk)
{
    const size_t fastest = a->order[a->rank - 1];
    const size_t row = sizes[fastest] * a->stored_bytes;
    size_t rows = 1, end = a->chunk_bytes;
    char *bytes = chunk;
    for (size_t d = 0; d < a->rank; d++)
        rows *= d == fastest ? 1 : sizes[d];
    for (size_t n = rows; n > 0; n--) { /* the last first: no row is written over unread ones */
        size_t rest = n - 1, place = 0, stride = a->inner[fastest];
        for (size_t k = a->rank - 1; k > 0; k--) {
            const size_t d = a->order[k - 1];
            place += rest % sizes[d] * stride;
            rest /= sizes[d];
            stride *= a->inner[d];
        }
        place *= a->stored_bytes;
        memmove(bytes + place, bytes + (n - 1) * row, row);
        memset(bytes + place + row, 0, end - place - row);
        end = place;
    }
}

static cw_status load_file(const cwi_zarr *z, const char *key, void **to, bool *missing,
                           cw_error *err)
{
    uint64_t size = 0;
    int fd;
    cw_status st = cwi_input_find_side(&z->in, key, &fd, &size, err);
    *missing = st == CW_OK && fd < 0;
    if (st == CW_OK && fd >= 0) {
        st = cwi_zarr_decode_part(&z->array, fd, 0, size, z->array.chunk_bytes, to, err);
        close(fd);
    }
    return st;
}

/* --- shards ------------------------------------------------------------------------------- */

static void close_shard(cwi_zarr *z, cwi_zarr_shard *shard)
{
    if (shard->is_open && shard->fd >= 0)
        close(shard->fd);
    z->index_bytes -= shard->bytes;
    cwi_free(shard->index);
    *shard = (cwi_zarr_shard){0};
}

void cwi_zarr_close_shards(cwi_zarr *z)
{
    for (size_t n = 0; z->shards && n < z->shard_slots; n++)
        close_shard(z, &z->shards[n]);
    cwi_free(z->shards);
    z->shards = NULL;
}

cw_status cwi_zarr_read_index(const cwi_zarr *z, cwi_zarr_shard *shard, cw_error *err)
{
    const cwi_zarr_array *a = &z->array;
    bool exact;
    size_t got = 0;
    const size_t bytes = 16 * a->shard_count;
    const size_t packed = cwi_zarr_packed_max(&a->index_chain, bytes, &exact);
    if (shard->size < packed)
        return cwi_fail(err, CW_ERR_FORMAT, "a shard has %llu bytes; its index alone takes %zu",
                        (unsigned long long)shard->size, packed);
    unsigned char *text = cwi_alloc_array(packed, 1);
    shard->index = cwi_alloc_array(a->shard_count, 16);
    cw_status st = CW_OK;
    if (!text || !shard->index)
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_input_read_at(shard->fd, a->index_at_start ? 0 : shard->size - packed, text,
                               packed, &got, err);
    if (st == CW_OK && got < packed)
        st = cwi_fail(err, CW_ERR_FORMAT, "the file ends inside the index of a shard");
    if (st == CW_OK)
        st = cwi_zarr_decode(&a->index_chain, text, packed, shard->index, bytes, 8, err);
    shard->count = a->shard_count;
    shard->bytes = bytes;
    cwi_free(text);
    return st;
}

/* Finds the slot of a shard: its own, an empty one, or that of the shard unused for longest. */
static cwi_zarr_shard *find_slot(cwi_zarr *z, uint64_t key)
{
    cwi_zarr_shard *slot = NULL;
    for (size_t n = 0; n < z->shard_slots; n++) {
        cwi_zarr_shard *s = &z->shards[n];
        if (s->is_open && s->key == key)
            return s;
        if (s->users == 0 && (!slot || s->used < slot->used))
            slot = s;
    }
    return slot;
}

/* Closes those unused for longest until their tables fit the limit, but for one. */
static void limit_tables(cwi_zarr *z, const cwi_zarr_shard *kept)
{
    while (z->index_bytes > CWI_ZARR_INDEX_BYTES) {
        cwi_zarr_shard *oldest = NULL;
        for (size_t n = 0; n < z->shard_slots; n++) {
            cwi_zarr_shard *s = &z->shards[n];
            if (s->is_open && s != kept && !s->users && (!oldest || s->used < oldest->used))
                oldest = s;
        }
        if (!oldest)
            return;
        close_shard(z, oldest);
    }
}

/* Opens the file of a shard in a slot, and reads its index. A missing file has none. */
static cw_status open_shard(cwi_zarr *z, const char *name, uint64_t key, cwi_zarr_shard *s,
                            cw_error *err)
{
    close_shard(z, s);
    cw_status st = cwi_input_find_side(&z->in, name, &s->fd, &s->size, err);
    s->is_open = st == CW_OK;
    s->key = key;
    if (st == CW_OK && s->fd >= 0)
        st = z->dialect->read_index(z, s, err);
    z->index_bytes += s->bytes;
    if (st != CW_OK)
        close_shard(z, s);
    else
        limit_tables(z, s);
    return st;
}

cw_status cwi_zarr_take_shard(cwi_zarr *z, const char *name, uint64_t key,
                              cwi_zarr_shard **taken, cw_error *err)
{
    cw_status st = CW_OK;
    pthread_mutex_lock(&z->lock);
    if (!z->shards)
        z->shards = cwi_alloc_zeroed(z->shard_slots, sizeof *z->shards);
    cwi_zarr_shard *s = z->shards ? find_slot(z, key) : NULL;
    if (!s)
        st = cwi_fail_memory(err);
    else if (!s->is_open || s->key != key)
        st = open_shard(z, name, key, s, err);
    if (st == CW_OK) {
        s->users++;
        s->used = ++z->clock;
        *taken = s;
    }
    pthread_mutex_unlock(&z->lock);
    return st;
}

void cwi_zarr_return_shard(cwi_zarr *z, cwi_zarr_shard *shard)
{
    pthread_mutex_lock(&z->lock);
    shard->users--;
    pthread_mutex_unlock(&z->lock);
}

static cw_status read_shard(const cwi_zarr_array *a, const cwi_zarr_shard *s, size_t number,
                            void **to, bool *missing, cw_error *err)
{
    if (s->fd < 0) {
        *missing = true;
        return CW_OK;
    }
    const uint64_t offset = s->index[2 * number], size = s->index[2 * number + 1];
    *missing = offset == UINT64_MAX && size == UINT64_MAX;
    if (*missing)
        return CW_OK;
    if (offset > s->size || size > s->size - offset)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the index of a shard places inner chunk %zu at byte %llu, %llu bytes "
                        "long; the file has %llu",
                        number, (unsigned long long)offset, (unsigned long long)size,
                        (unsigned long long)s->size);
    cw_status st = cwi_zarr_decode_part(a, s->fd, offset, size, a->chunk_bytes, to, err);
    if (st != CW_OK && st != CW_ERR_NO_MEMORY) {
        char subject[48];
        snprintf(subject, sizeof subject, "inner chunk %zu", number);
        return cwi_fail_in(err, st, subject);
    }
    return st;
}

cw_status cwi_zarr_load_chunk(cwi_zarr *z, const size_t at[CWI_ZARR_RANK], void **to,
                              bool *missing, cw_error *err)
{
    const cwi_zarr_array *a = &z->array;
    char key[CWI_ZARR_KEY_BYTES];
    size_t outer[CWI_ZARR_RANK];
    uint64_t shard_number = 0, number = 0;
    cw_status st;
    for (size_t d = 0; d < a->rank; d++)
        outer[d] = at[d] / (a->chunk[d] / a->inner[d]);
    cwi_zarr_print_key(a, outer, key);
    if (!a->is_sharded) {
        st = load_file(z, key, to, missing, err);
    } else {
        cwi_zarr_shard *shard = NULL;
        for (size_t d = 0; d < a->rank; d++)
            shard_number = shard_number * ((a->shape[d] - 1) / a->chunk[d] + 1) + outer[d];
        for (size_t n = 0; n < a->rank; n++) {
            const size_t d = a->shard_order[n], along = a->chunk[d] / a->inner[d];
            number = number * along + at[d] % along;
        }
        st = cwi_zarr_take_shard(z, key, shard_number, &shard, err);
        if (st == CW_OK) {
            st = read_shard(a, shard, (size_t)number, to, missing, err);
            cwi_zarr_return_shard(z, shard);
        }
    }
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, key);
}
