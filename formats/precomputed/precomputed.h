/* Neuroglancer's precomputed volumes: one file `info` in a folder, and chunks in files or shards.
 * Dimensions stand with x first; several channels are the last one. */
#ifndef FORMATS_PRECOMPUTED_PRECOMPUTED_H
#define FORMATS_PRECOMPUTED_PRECOMPUTED_H

#include "formats/zarr/zarr_dialect.h"

#define CWI_PRECOMPUTED_FILE "info"

/* How the chunks of a scale are stored, beside the array's sizes. */
typedef struct cwi_chunk_storage {
    int64_t offset[3];  /* of the first voxel in the grid of all */
    bool has_blocks;    /* encoded as compressed_segmentation */
    size_t block[3];    /* its blocks, in voxels */
    bool is_sharded;    /* by 64-bit numbers of chunks, version 1 */
    bool is_hashed;     /* by MurmurHash3_x86_128; else by the number itself */
    bool index_is_gzip; /* tables of minishards are compressed */
    bool data_is_gzip;  /* chunks of shards are */
    unsigned preshift_bits, minishard_bits, shard_bits;
} cwi_chunk_storage;

/* Opens the node of the whole, for "", or of the scale with a key. */
CW_NODISCARD cw_status cwi_precomputed_open_node(cwi_zarr_node *node, const cwi_input *in,
                                                 const char *path, cw_error *err);

/* Fills an array from a scale. Returns CW_ERR_FORMAT, CW_ERR_LIMIT */
CW_NODISCARD cw_status cwi_precomputed_parse(const cwi_zarr_node *node, cwi_zarr_array *array,
                                             cw_error *err);

/* Reads how the chunks of a scale are stored. */
CW_NODISCARD cw_status cwi_precomputed_storage(const json_t *scale, cwi_chunk_storage *storage,
                                               cw_error *err);

/* Makes the frame of a scale: voxel v has its centre at (v + 1/2) times the resolution, in
 * nanometres. */
CW_NODISCARD cw_status cwi_precomputed_frame(const cwi_zarr_node *node,
                                             const cwi_zarr_array *array, cwi_zarr_frame *frame,
                                             cw_error *err);

/* Reads the names of segments into found->labels, and marks segmentations as labels. */
CW_NODISCARD cw_status cwi_precomputed_facts(cwi_zarr *zarr, const cwi_zarr_node *image,
                                             cwi_zarr_found *found, cw_error *err);

/* Decodes a chunk, from its file or shard; it may be cut off at the end of the volume. */
CW_NODISCARD cw_status cwi_precomputed_load(cwi_zarr *zarr, const size_t at[CWI_ZARR_RANK],
                                            void **to, bool *missing, cw_error *err);

/* --- shards ------------------------------------------------------------------------------- */

/* The place of a chunk in the shards. */
typedef struct cwi_shard_place {
    uint64_t chunk;           /* its number: the compressed Morton code of its place */
    uint64_t shard;           /* number of the file */
    uint64_t shard_minishard; /* number of the minishard among those of all shards */
} cwi_shard_place;

cwi_shard_place cwi_find_shard(const cwi_chunk_storage *storage, const size_t grid[3],
                               const size_t at[3]);

/* Reads the table of one minishard, whose number is shard->key. It has the number, the first byte and
 * the size of each of shard->count chunks. */
CW_NODISCARD cw_status cwi_minishard_read(const cwi_zarr *zarr, cwi_zarr_shard *shard,
                                          cw_error *err);

/* Finds a chunk in the table of a minishard; *missing is set where it is not there.
 * Returns CW_ERR_FORMAT for a place beyond the file */
CW_NODISCARD cw_status cwi_minishard_find(const cwi_zarr_shard *shard, uint64_t chunk,
                                          uint64_t *offset, uint64_t *size, bool *missing,
                                          cw_error *err);

/* --- compressed segmentation ---------------------------------------------------------------- */

/* Decodes channels of labels of 4 or 8 bytes, packed, x fastest, in this machine's order.
 * sizes    of the chunk in voxels
 * Returns  CW_ERR_FORMAT, naming block and field */
CW_NODISCARD cw_status cwi_segmentation_decode(const unsigned char *packed, size_t packed_size,
                                               const size_t sizes[3], const size_t block[3],
                                               size_t channels, size_t number, void *to,
                                               cw_error *err);

/* Returns the bytes that such a chunk takes at least and at most. */
void cwi_segmentation_bounds(const size_t sizes[3], const size_t block[3], size_t channels,
                             size_t number, size_t *min, size_t *max);

#endif
