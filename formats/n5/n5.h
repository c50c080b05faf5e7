/* N5: chunked arrays in folders with attributes.json. Its dimensions, and the numbers in the paths
 * of its blocks, stand with the fastest first. */
#ifndef FORMATS_N5_N5_H
#define FORMATS_N5_N5_H

#include "formats/zarr/zarr_dialect.h"

enum { CWI_N5_LEVELS = 64 };

/* The file of metadata, and the keys that hold for all arrays below a folder. */
#define CWI_N5_FILE "attributes.json"

/* Opens the node of a folder. Its `attrs` hold what it and the folders above say of frames. */
CW_NODISCARD cw_status cwi_n5_open_node(cwi_zarr_node *node, const cwi_input *in,
                                        const char *path, cw_error *err);

/* Fills an array from its attributes. Returns CW_ERR_FORMAT, CW_ERR_LIMIT, CW_ERR_UNSUPPORTED for
 * a codec that is not in this build */
CW_NODISCARD cw_status cwi_n5_parse(const cwi_zarr_node *node, cwi_zarr_array *array,
                                    cw_error *err);

/* Make the frame of an array by itself, and of the level of an image. The centre of the first voxel
 * of level 0 is the origin; one of a level of factor f is (f - 1) / 2 voxels of level 0 farther. */
CW_NODISCARD cw_status cwi_n5_array_frame(const cwi_zarr_node *node,
                                          const cwi_zarr_array *array, cwi_zarr_frame *frame,
                                          cw_error *err);
CW_NODISCARD cw_status cwi_n5_level_frame(const cwi_zarr_node *image, size_t number,
                                          const cwi_zarr_node *level,
                                          const cwi_zarr_array *array, cwi_zarr_frame *frame,
                                          cw_error *err);

/* Decodes a block: a header with its sizes, and its numbers, the first byte of each the highest. */
CW_NODISCARD cw_status cwi_n5_load_block(cwi_zarr *zarr, const size_t at[CWI_ZARR_RANK],
                                         void **to, bool *missing, cw_error *err);

#endif
