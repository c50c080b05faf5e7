/* Zarr volumes, with random access: any box of voxels is read from the chunks that meet it. */
#ifndef FORMATS_ZARR_ZARR_H
#define FORMATS_ZARR_ZARR_H

#include "formats/volume/voxel_source.h"

/* An open array of a store. It keeps the metadata, an open folder, and the caches stated below. */
typedef struct cwi_zarr cwi_zarr;

/* Options of opening. A zero field means the default named beside it. */
typedef struct cwi_zarr_desc {
    const char *array;   /* path of an array or image below the store; default: its own image,
                            else its first array of 3 dimensions or more */
    size_t level;        /* of an image in several sizes; default 0, the finest */
    bool allow_external; /* follow links that leave the store; default: refused */
    size_t
        cache_bytes; /* limit of decoded chunks that are kept between calls; default 256 MiB */
    int threads;     /* default: one per processor */
    const struct cwi_zarr_dialect *dialect; /* default: Zarr itself */
} cwi_zarr_desc;

/* Opens the array of a path: a folder with .zarray, .zgroup or zarr.json, or such a file.
 *
 * zarr     set to the handle, to be closed with cwi_zarr_close(); NULL on failure
 * Returns  CW_ERR_FORMAT    metadata that are wrong or not read; names file and key
 *          CW_ERR_ARGUMENT  no such array or level
 *          CW_ERR_UNSAFE    a path that leaves the store; CW_ERR_UNSUPPORTED: a codec that is not
 *          in this build; CW_ERR_LIMIT; CW_ERR_IO; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_zarr_open(const char *path, const cwi_zarr_desc *desc,
                                     cwi_zarr **zarr, cw_error *err);
void cwi_zarr_close(cwi_zarr *zarr);

/* Returns the shape: everything of a volume but the voxels. Strides are those of packed voxels,
 * x fastest, then y, z, components, steps. */
const cw_volume *cwi_zarr_shape(const cwi_zarr *zarr);

/* Returns the voxels along x, y and z that are decoded at once. Boxes whose ends are multiples of
 * these decode every chunk once, whatever the cache. */
void cwi_zarr_chunk_size(const cwi_zarr *zarr, size_t size[3]);

/* A box of voxels. Arrays are in the order of cwi_role: x, y, z, component, step. */
typedef struct cwi_zarr_box {
    size_t first[CWI_ROLE_COUNT];
    size_t count[CWI_ROLE_COUNT]; /* at least 1 */
    size_t every[CWI_ROLE_COUNT]; /* only every n-th of them; 0 means 1 */
} cwi_zarr_box;

/* Makes the box of one component and step: of all voxels for NULL. */
cwi_zarr_box cwi_zarr_make_box(const cwi_zarr *zarr, const cw_box *box, size_t component,
                               size_t step);

/* Keeps integers of 64 bits as they are (CWI_I64, CWI_U64), for those who replace them. */
void cwi_zarr_keep_wide(cwi_zarr *zarr);

/* Reads a box into packed voxels: x fastest, then y, z, components, steps.
 *
 * Each chunk that meets the box is decoded once, several at a time. Chunks that the box takes only
 * in part are kept for the next boxes, until a box begins behind them in z: two rows at most, where
 * a row is all chunks of one place in z, and at most cache_bytes. So slabs of rising z decode each
 * chunk once if the rows that a slab meets fit, two at most. Memory beside the box: those rows, and
 * for each thread one chunk and its packed bytes; for shards the indexes of 64 of them, or 64 MiB.
 * A missing chunk has the fill value.
 *
 * to       as many voxels as the box has, of the shape's type
 * Returns  CW_ERR_FORMAT    a damaged chunk, which the message names; a number of 64 bits that
 *          does not fit 32; CW_ERR_ARGUMENT: a box that leaves the array; CW_ERR_UNSAFE,
 *          CW_ERR_IO, CW_ERR_NO_MEMORY, CW_ERR_CANCELLED
 * Threads  one call at a time for a handle; the result is the same for any number of threads */
CW_NODISCARD cw_status cwi_zarr_read_box(cwi_zarr *zarr, const cwi_zarr_box *box, void *to,
                                         const cw_progress *progress, cw_error *err);

/* Returns the number of chunks that were decoded so far, for tests and benchmarks. */
uint64_t cwi_zarr_decoded(const cwi_zarr *zarr);

#endif
