/* Finds and decodes the chunks of precomputed volumes. */
#define _GNU_SOURCE /* close */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/little_endian.h"
#include "formats/precomputed/precomputed.h"
#include "formats/zarr/zarr_decode.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* The bytes of an encoded chunk, and its sizes, which are smaller at the end of the volume. */
typedef struct stored_chunk {
    size_t sizes[CWI_ZARR_RANK];
    size_t bytes; /* of its numbers */
    int fd;
    uint64_t offset, size; /* of the encoded bytes in the file */
    bool is_gzip;
} stored_chunk;

/* --- finding ------------------------------------------------------------------------------ */

static void measure_chunk(const cwi_zarr_array *a, const size_t at[CWI_ZARR_RANK],
                          stored_chunk *chunk)
{
    chunk->bytes = a->stored_bytes;
    for (size_t d = 0; d < a->rank; d++) {
        const size_t left = a->shape[d] - at[d] * a->chunk[d];
        chunk->sizes[d] = left < a->chunk[d] ? left : a->chunk[d];
        chunk->bytes *= chunk->sizes[d];
    }
}

/* Prints the path of a chunk's file: its first voxel and its end along each axis. */
static void print_name(const cwi_zarr *z, const size_t at[CWI_ZARR_RANK],
                       const stored_chunk *chunk, char name[CWI_ZARR_KEY_BYTES])
{
    const cwi_chunk_storage *s = z->extra;
    size_t used = (size_t)snprintf(name, CWI_ZARR_KEY_BYTES, "%s/", z->array.path);
    for (int a = 0; a < 3; a++) {
        const int64_t first = s->offset[a] + (int64_t)(at[a] * z->array.chunk[a]);
        used += (size_t)snprintf(name + used, CWI_ZARR_KEY_BYTES - used, "%s%lld-%lld",
                                 a ? "_" : "", (long long)first,
                                 (long long)(first + (int64_t)chunk->sizes[a]));
    }
}

/* Looks if a file is a gzip file that has lost its extension. One of as many bytes as the numbers have
 * must also end with their count. */
static cw_status look_for_gzip(const cwi_chunk_storage *s, stored_chunk *chunk, cw_error *err)
{
    enum { HEAD = 2, TAIL = 4 };
    unsigned char head[HEAD] = {0}, tail[TAIL] = {0};
    size_t got = 0;
    cw_status st = cwi_input_read_at(chunk->fd, 0, head, HEAD, &got, err);
    chunk->is_gzip = st == CW_OK && head[0] == 0x1f && head[1] == 0x8b;
    if (!chunk->is_gzip || s->has_blocks || chunk->size != chunk->bytes || chunk->size < TAIL)
        return st;
    st = cwi_input_read_at(chunk->fd, chunk->size - TAIL, tail, TAIL, &got, err);
    chunk->is_gzip = st == CW_OK && cwi_get_u32(tail) == chunk->bytes;
    return st;
}

/* Opens the file of a chunk, plain or compressed. */
static cw_status open_file(const cwi_zarr *z, const char *name, stored_chunk *chunk,
                           cw_error *err)
{
    char packed[CWI_ZARR_KEY_BYTES + 4];
    cw_status st = cwi_input_find_side(&z->in, name, &chunk->fd, &chunk->size, err);
    if (st == CW_OK && chunk->fd < 0) {
        snprintf(packed, sizeof packed, "%s.gz", name);
        st = cwi_input_find_side(&z->in, packed, &chunk->fd, &chunk->size, err);
        chunk->is_gzip = true;
    } else if (st == CW_OK) {
        st = look_for_gzip(z->extra, chunk, err);
    }
    if (st == CW_OK && chunk->fd < 0) {
        snprintf(packed, sizeof packed, "%s.br", name);
        if (cwi_zarr_has_file(&z->in, packed))
            st = cwi_fail(err, CW_ERR_UNSUPPORTED,
                          "compressed with brotli, which is not read; decompress the files "
                          "that end in .br");
    }
    return st;
}

/* --- decoding ----------------------------------------------------------------------------- */

static cw_status decode_raw(const cwi_zarr_array *a, const stored_chunk *chunk, void **to,
                            cw_error *err)
{
    cwi_zarr_array encoded = *a;
    encoded.chain =
        (cwi_zarr_chain){.count = chunk->is_gzip ? 1 : 0, .codecs = {CWI_ZARR_GZIP}};
    return cwi_zarr_decode_part(&encoded, chunk->fd, chunk->offset, chunk->size, chunk->bytes,
                                to, err);
}

/* Inflates a chunk whose decoded size is not known, but its bounds are. */
static cw_status inflate_blocks(unsigned char **packed, size_t *size, size_t max, cw_error *err)
{
    const size_t most =
        *size < SIZE_MAX / CWI_ZARR_DEFLATE_RATIO ? *size * CWI_ZARR_DEFLATE_RATIO : SIZE_MAX;
    const size_t limit = max < INT32_MAX ? max : INT32_MAX;
    const size_t capacity = most < limit ? most : limit;
    unsigned char *inflated = cwi_alloc_array(capacity, 1);
    if (!inflated)
        return cwi_fail_memory(err);
    cw_status st =
        cwi_zarr_unpack(CWI_ZARR_GZIP, *packed, *size, inflated, capacity, size, err);
    cwi_free(*packed);
    *packed = inflated;
    return st;
}

static cw_status decode_blocks(const cwi_zarr *z, const stored_chunk *chunk, void **to,
                               cw_error *err)
{
    const cwi_chunk_storage *s = z->extra;
    const cwi_zarr_array *a = &z->array;
    const size_t channels = a->rank > 3 ? chunk->sizes[3] : 1;
    size_t min, max, got = 0, size = (size_t)chunk->size;
    cwi_segmentation_bounds(chunk->sizes, s->block, channels, a->stored_bytes, &min, &max);
    if (chunk->size > max || chunk->size > INT32_MAX || (!chunk->is_gzip && size < min))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "a chunk has %llu bytes; its blocks take %zu to %zu",
                        (unsigned long long)chunk->size, min, max);
    unsigned char *packed = cwi_alloc_array(size, 1);
    cw_status st = packed ? cwi_input_read_at(chunk->fd, chunk->offset, packed, size, &got, err)
                          : cwi_fail_memory(err);
    if (st == CW_OK && got < size)
        st = cwi_fail(err, CW_ERR_FORMAT, "the file ends inside a chunk");
    if (st == CW_OK && chunk->is_gzip)
        st = inflate_blocks(&packed, &size, max, err);
    if (st == CW_OK && size < min)
        st = cwi_fail(err, CW_ERR_FORMAT, "a chunk has %zu bytes; its blocks take %zu at least",
                      size, min);
    if (st == CW_OK && !*to)
        *to = cwi_alloc_large(a->chunk_bytes, 1);
    if (st == CW_OK)
        st = *to ? cwi_segmentation_decode(packed, size, chunk->sizes, s->block, channels,
                                           a->stored_bytes, *to, err)
                 : cwi_fail_memory(err);
    cwi_free(packed);
    return st;
}

static cw_status decode_chunk(const cwi_zarr *z, const stored_chunk *chunk, void **to,
                              cw_error *err)
{
    const cwi_zarr_array *a = &z->array;
    const cwi_chunk_storage *s = z->extra;
    cw_status st =
        s->has_blocks ? decode_blocks(z, chunk, to, err) : decode_raw(a, chunk, to, err);
    if (st == CW_OK && memcmp(chunk->sizes, a->inner, a->rank * sizeof *a->inner) != 0)
        cwi_zarr_spread(a, chunk->sizes, *to);
    return st;
}

/* --- loading ------------------------------------------------------------------------------ */

static cw_status load_file(const cwi_zarr *z, const char *name, stored_chunk *chunk, void **to,
                           bool *missing, cw_error *err)
{
    cw_status st = open_file(z, name, chunk, err);
    *missing = st == CW_OK && chunk->fd < 0;
    if (st == CW_OK && chunk->fd >= 0)
        st = decode_chunk(z, chunk, to, err);
    if (chunk->fd >= 0)
        close(chunk->fd);
    return st;
}

/* Refuses shards of the first draft, whose index stands in a file of its own. */
static cw_status refuse_draft(const cwi_zarr *z, const char *name, cw_error *err)
{
    char index[CWI_ZARR_KEY_BYTES];
    snprintf(index, sizeof index, "%.*sindex", (int)(strlen(name) - strlen("shard")), name);
    return cwi_zarr_has_file(&z->in, index)
               ? cwi_fail(err, CW_ERR_UNSUPPORTED,
                          "the index of this shard is a file of its own, as in a draft of the "
                          "format, which is not read; join .index and .data to .shard")
               : CW_OK;
}

static cw_status load_sharded(cwi_zarr *z, const char *name, const cwi_shard_place *place,
                              stored_chunk *chunk, void **to, bool *missing, cw_error *err)
{
    const cwi_chunk_storage *s = z->extra;
    cwi_zarr_shard *shard = NULL;
    cw_status st = cwi_zarr_take_shard(z, name, place->shard_minishard, &shard, err);
    if (st != CW_OK)
        return st;
    *missing = shard->fd < 0;
    if (*missing)
        st = refuse_draft(z, name, err);
    else
        st =
            cwi_minishard_find(shard, place->chunk, &chunk->offset, &chunk->size, missing, err);
    chunk->fd = shard->fd;
    chunk->is_gzip = s->data_is_gzip;
    if (st == CW_OK && !*missing) {
        st = decode_chunk(z, chunk, to, err);
        if (st != CW_OK && st != CW_ERR_NO_MEMORY) {
            char subject[40];
            snprintf(subject, sizeof subject, "chunk %llu", (unsigned long long)place->chunk);
            cwi_fail_in(err, st, subject);
        }
    }
    cwi_zarr_return_shard(z, shard);
    return st;
}

cw_status cwi_precomputed_load(cwi_zarr *z, const size_t at[CWI_ZARR_RANK], void **to,
                               bool *missing, cw_error *err)
{
    const cwi_chunk_storage *s = z->extra;
    const cwi_zarr_array *a = &z->array;
    char name[CWI_ZARR_KEY_BYTES];
    stored_chunk chunk = {.fd = -1};
    cw_status st;
    measure_chunk(a, at, &chunk);
    if (s->is_sharded) {
        size_t grid[3];
        for (int n = 0; n < 3; n++)
            grid[n] = (a->shape[n] - 1) / a->chunk[n] + 1;
        const cwi_shard_place place = cwi_find_shard(s, grid, at);
        snprintf(name, sizeof name, "%.*s/%0*llx.shard", CWI_ZARR_KEY_BYTES / 2, a->path,
                 (int)(s->shard_bits + 3) / 4, (unsigned long long)place.shard);
        st = load_sharded(z, name, &place, &chunk, to, missing, err);
    } else {
        print_name(z, at, &chunk, name);
        st = load_file(z, name, &chunk, to, missing, err);
    }
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, name);
}
