/* The places of segments in a mesh folder: two files each, or, where there are many, shards. */
#ifndef FORMATS_NEUROGLANCER_SEGMENT_STORE_H
#define FORMATS_NEUROGLANCER_SEGMENT_STORE_H

#include "formats/neuroglancer/segment_facts.h"

/* A segment in the shard that is being filled. */
typedef struct cwi_shard_entry {
    uint64_t id, minishard;
    uint64_t offset, size; /* of its manifest, behind the index */
} cwi_shard_entry;

/* A folder that is being written. Segments come in the order of cwi_segment_store_open(). Zero it
 * before, and close it in any case. */
typedef struct cwi_segment_store {
    cwi_outfolder *folder; /* borrowed */
    cwi_segment_bits bits;
    uint64_t shard;       /* number of the shard that is being filled */
    unsigned char *bytes; /* of it, behind its index */
    size_t size, capacity;
    cwi_shard_entry *entries; /* sorted by minishard, then by id */
    size_t entry_count, entry_capacity;
} cwi_segment_store;

/* Chooses files for up to 10,000 segments, else shards of about a thousand segments and 16 million
 * triangles at most. Sorts the segments as they are to be written.
 * triangles  of all segments
 * order      set to indices of segments, to be freed with cwi_free()
 * Returns    CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_segment_store_open(cwi_segment_store *store, cwi_outfolder *folder,
                                              const cwi_segments *segments, uint64_t triangles,
                                              size_t **order, cw_error *err);

/* Begin a segment, append a fragment of it, and end it with its manifest.
 * Return CW_ERR_OUTPUT, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_segment_begin(cwi_segment_store *store, uint64_t id, cw_error *err);
CW_NODISCARD cw_status cwi_segment_append(cwi_segment_store *store, const void *bytes,
                                          size_t size, cw_error *err);
CW_NODISCARD cw_status cwi_segment_end(cwi_segment_store *store, uint64_t id,
                                       const void *manifest, size_t size, cw_error *err);

/* Writes the last shard. */
CW_NODISCARD cw_status cwi_segment_store_finish(cwi_segment_store *store, cw_error *err);
void cwi_segment_store_close(cwi_segment_store *store);

#endif
