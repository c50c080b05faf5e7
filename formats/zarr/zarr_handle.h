/* The inside of an open Zarr array: its place, its metadata, and its caches. */
#ifndef FORMATS_ZARR_ZARR_HANDLE_H
#define FORMATS_ZARR_ZARR_HANDLE_H

#include "formats/zarr/zarr.h"
#include "formats/zarr/zarr_array.h"

#include <pthread.h>

/* Limits of what a handle keeps open. */
enum { CWI_ZARR_SHARDS = 64, CWI_ZARR_INDEX_BYTES = 64 << 20 };

/* An open shard. */
typedef struct cwi_zarr_shard {
    bool is_open;
    uint64_t key;   /* its number */
    uint64_t used;  /* time of the last use */
    unsigned users; /* threads that read from it */
    int fd;         /* -1: the file is missing */
    uint64_t size;
    uint64_t *index; /* count x offset and bytes; dialects may have other tables */
    size_t count;    /* of its entries */
    size_t bytes;    /* of its table */
} cwi_zarr_shard;

/* A decoded chunk that is kept. */
typedef struct cwi_zarr_slot {
    uint64_t key;  /* its number plus 1; 0: none */
    size_t row;    /* its place in z, in chunks */
    uint64_t call; /* the last call that used it */
    void *bytes;
} cwi_zarr_slot;

struct cwi_zarr_dialect;

struct cwi_zarr {
    const struct cwi_zarr_dialect *dialect;
    void *extra; /* what its dialect keeps of the array; may be NULL */
    char *path;
    cwi_input in;
    cwi_zarr_array array;
    cw_volume shape;
    int dimensions[CWI_ROLE_COUNT]; /* of the array, by role; -1: none */
    size_t sizes[CWI_ROLE_COUNT];
    int threads;
    size_t level_count;                             /* 0: not an image in several sizes */
    char axes[CWI_ZARR_RANK * CWI_ZARR_NAME_BYTES]; /* their names, with blanks between them */

    pthread_mutex_t lock; /* of everything below */
    uint64_t call, decoded, clock;
    cwi_zarr_shard *shards;
    size_t shard_slots;
    size_t index_bytes;   /* of the tables of all open shards */
    cwi_zarr_slot *slots; /* a chunk has its place at its number modulo slot_count */
    size_t slot_count;
    void **spare; /* memory of chunks that are no longer kept, for the next ones */
    size_t spare_count;
};

struct cwi_array_list;

/* Facts for the user, beside the array. */
typedef struct cwi_zarr_found {
    struct cwi_array_list *arrays; /* filled with those of a group; may be NULL */
    cw_label_table *labels;        /* filled with those of an image-label; may be NULL */
    char note[400];                /* "": nothing */
} cwi_zarr_found;

/* Opens as cwi_zarr_open(), and tells what it found. */
CW_NODISCARD cw_status cwi_zarr_open_found(const char *path, const cwi_zarr_desc *desc,
                                           cwi_zarr_found *found, cwi_zarr **zarr,
                                           cw_error *err);

/* Sets shape, sizes and dimensions from an array and its frame. */
struct cwi_zarr_frame;
CW_NODISCARD cw_status cwi_zarr_set_frame(cwi_zarr *zarr, const struct cwi_zarr_frame *frame,
                                          cw_error *err);

/* Decodes a chunk, or the inner chunk of a shard, at its place in the grid of such chunks.
 * *missing is set where it does not exist. *to is memory for a chunk, or NULL: it is then
 * allocated once the size of the file was found to be possible. Messages name the file.
 * Reentrant. */
CW_NODISCARD cw_status cwi_zarr_load_chunk(cwi_zarr *zarr, const size_t at[CWI_ZARR_RANK],
                                           void **to, bool *missing, cw_error *err);

/* --- parts that dialects share ---------------------------------------------------------------- */

/* Prints the path of a chunk's file below the store. */
void cwi_zarr_print_key(const cwi_zarr_array *array, const size_t at[CWI_ZARR_RANK],
                        char key[CWI_ZARR_KEY_BYTES]);

/* Reads an encoded chunk at an offset of a file, and decodes it to `bytes` bytes, at most
 * array->chunk_bytes. Nothing is allocated for a chunk that is too short or too long; *to gets
 * memory for a whole chunk where it is NULL. */
CW_NODISCARD cw_status cwi_zarr_decode_part(const cwi_zarr_array *array, int fd,
                                            uint64_t offset, uint64_t size, size_t bytes,
                                            void **to, cw_error *err);

/* Moves the numbers of a chunk that was cut off at `sizes`, packed, to their places in a whole
 * chunk. The others become 0. */
void cwi_zarr_spread(const cwi_zarr_array *array, const size_t sizes[CWI_ZARR_RANK],
                     void *chunk);

/* Opens a shard by the name of its file, or finds it open, and reads its index by the dialect. There
 * is a slot for every thread. Return it in any case but a failure. */
CW_NODISCARD cw_status cwi_zarr_take_shard(cwi_zarr *zarr, const char *name, uint64_t key,
                                           cwi_zarr_shard **taken, cw_error *err);
void cwi_zarr_return_shard(cwi_zarr *zarr, cwi_zarr_shard *shard);

/* Reads the index of a shard of Zarr 3. */
CW_NODISCARD cw_status cwi_zarr_read_index(const cwi_zarr *zarr, cwi_zarr_shard *shard,
                                           cw_error *err);

/* Closes all shards. */
void cwi_zarr_close_shards(cwi_zarr *zarr);

#endif
