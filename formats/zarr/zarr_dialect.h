/* The formats that keep chunked arrays in a folder as Zarr does. Each has a table of functions,
 * its dialect, for its metadata and for the files of its chunks; the rest is common to all. */
#ifndef FORMATS_ZARR_ZARR_DIALECT_H
#define FORMATS_ZARR_ZARR_DIALECT_H

#include "formats/volume/volume_reader.h"
#include "formats/zarr/zarr_handle.h"
#include "formats/zarr/zarr_image.h"

typedef struct cwi_zarr_dialect {
    const char *noun;     /* of the format, for messages: "Zarr" */
    const char *files;    /* names of its files of metadata, with blanks between them */
    const char *expected; /* those that a message names */

    /* Opens the node of a folder, as cwi_zarr_node_open(). */
    cw_status (*open_node)(cwi_zarr_node *node, const cwi_input *in, const char *path,
                           cw_error *err);
    /* Fills a zeroed array from the metadata of its node; its path and words are set. */
    cw_status (*parse_array)(const cwi_zarr_node *node, cwi_zarr_array *array, cw_error *err);
    /* Makes the frame of an array by itself. Messages do not name the file. */
    cw_status (*array_frame)(const cwi_zarr_node *node, const cwi_zarr_array *array,
                             cwi_zarr_frame *frame, cw_error *err);

    /* Tells if a node is an image in several sizes, counts its levels, finds the path of one, and
     * makes its frame. `level` is the node of the level's array. Messages of the last two name
     * the file. */
    bool (*is_image)(const cwi_zarr_node *node);
    size_t (*level_count)(const cwi_zarr_node *image);
    cw_status (*level_path)(const cwi_zarr_node *image, size_t number,
                            char path[CWI_ZARR_KEY_BYTES], cw_error *err);
    cw_status (*level_frame)(const cwi_zarr_node *image, size_t number,
                             const cwi_zarr_node *level, const cwi_zarr_array *array,
                             cwi_zarr_frame *frame, cw_error *err);

    /* Reads what an image tells beside its voxels, before its frame: if they are labels, names of
     * labels, and a note. NULL: nothing. Messages name the file. */
    cw_status (*read_facts)(cwi_zarr *zarr, const cwi_zarr_node *image, cwi_zarr_found *found,
                            cw_error *err);
    /* Sets zarr->extra for the chosen array, which the handle frees. NULL: nothing to set. */
    cw_status (*prepare)(cwi_zarr *zarr, cw_error *err);

    /* Decodes a chunk, as cwi_zarr_load_chunk(). */
    cw_status (*load_chunk)(cwi_zarr *zarr, const size_t at[CWI_ZARR_RANK], void **to,
                            bool *missing, cw_error *err);
    /* Sets `index` and `count` of a shard that was just opened; NULL: there are no shards. */
    cw_status (*read_index)(const cwi_zarr *zarr, cwi_zarr_shard *shard, cw_error *err);
} cwi_zarr_dialect;

/* Zarr itself. */
extern const cwi_zarr_dialect cwi_dialect_zarr;

/* Read a volume or a part of it, and list its levels, by a dialect; in->path is its folder or a
 * file of metadata in it. */
CW_NODISCARD cw_status cwi_zarr_read_as(const cwi_zarr_dialect *dialect, const cwi_input *in,
                                        const cw_read_desc *desc, cw_volume *volume,
                                        cw_error *err);
CW_NODISCARD cw_status cwi_zarr_levels_as(const cwi_zarr_dialect *dialect, const cwi_input *in,
                                          const cw_read_desc *desc, cw_level **levels,
                                          size_t *count, cw_error *err);

#endif
