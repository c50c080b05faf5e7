/* Functions that the public calls of extraction share. */
#ifndef EXTRACT_EXTRACT_INTERNAL_H
#define EXTRACT_EXTRACT_INTERNAL_H

#include "extract/bricks/brick_set.h"
#include "extract/dense/dense_plan.h"

struct cw_extractor {
    cwi_plan plan;
    bool has_nodata; /* as the volume was given: the plan's is false while no voxel equals it */
    cwi_brick_set bricks; /* empty until changed bricks are asked for */
};

/* Makes a zeroed plan for a volume of any kind; free it with cwi_plan_free(). */
CW_NODISCARD cw_status cwi_plan_init(cwi_plan *plan, const cwi_engine *engine,
                                     const cw_volume *volume, cw_error *err);

/* Returns false for sparse and irregular grids, which are extracted at once. */
bool cwi_plan_is_dense(const cwi_plan *plan);

/* Classifies and counts a dense grid: all that is known of the surface before it is made. */
CW_NODISCARD cw_status cwi_plan_make(cwi_plan *plan, const cw_extract_desc *desc,
                                     cw_error *err);

/* Extracts a grid that is not dense; mesh NULL: counts it. */
CW_NODISCARD cw_status cwi_extract_at_once(cwi_plan *plan, const cw_extract_desc *desc,
                                           cw_mesh *mesh, cw_error *err);

/* cw_extract() and cw_extractor_new() with an engine of the caller's choice, for tests.
 * leaf_bytes: as in cwi_octree; 0: only wanted leaves are read, however many they are. */
CW_NODISCARD cw_status cwi_extract_with(const cwi_engine *engine, const cw_volume *volume,
                                        const cw_extract_desc *desc, cw_mesh *mesh,
                                        cw_extract_counts *counts, cw_error *err);
CW_NODISCARD cw_status cwi_extractor_new_with(const cwi_engine *engine, size_t leaf_bytes,
                                              const cw_volume *volume, cw_extractor **out,
                                              cw_error *err);

#endif
