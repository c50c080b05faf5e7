/* The segments of a mesh folder, what is measured of them, and the JSON files that tell it. */
#ifndef FORMATS_NEUROGLANCER_SEGMENT_FACTS_H
#define FORMATS_NEUROGLANCER_SEGMENT_FACTS_H

#include "formats/neuroglancer/lod_grid.h"

/* A segment: parts that are its levels of detail, from the finest on. */
typedef struct cwi_segment {
    uint64_t id;
    const cwi_part *levels;
    size_t level_count;
} cwi_segment;

typedef struct cwi_segments {
    cwi_segment *items;
    size_t count, max_levels; /* the most levels of one */
} cwi_segments;

/* Bits of the hash of a segment's number that choose its shard, and its minishard in that. */
typedef struct cwi_segment_bits {
    bool is_sharded;
    unsigned shard, minishard;
} cwi_segment_bits;

/* Groups parts as segments. The id is the label's value; without labels, ids count from 1.
 * Returns CW_ERR_ARGUMENT for the label 0, for one that is there twice, and for parts of which
 * only some have a label; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_segments_list(const cwi_parts *parts, cwi_segments *segments,
                                         cw_error *err);
void cwi_segments_free(cwi_segments *segments);

/* Returns the mean length of the edges of a part's triangles, in millimetres. */
double cwi_mean_edge(const cwi_part *part);

/* Writes the file `info` of the meshes. Returns CW_ERR_OUTPUT, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_mesh_info_write(cwi_outfolder *folder, const cwi_lod_grid *grid,
                                           const cwi_segment_bits *bits, cw_error *err);

/* Writes names, areas and triangle counts of segments, and volumes if all of them are closed.
 * Returns CW_ERR_OUTPUT, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_segment_properties_write(cwi_outfolder *folder,
                                                    const cwi_segments *segments,
                                                    cw_error *err);

#endif
