/* Medians of cubes of any size, with gaps. */
#ifndef CORE_FILTER_MEDIAN_TILES_H
#define CORE_FILTER_MEDIAN_TILES_H

#include "core/filter/filter_work.h"

/* Sets the voxels of a result to the medians of cubes around those of the input.
 * radius   1 to 3
 * out      as of cwi_filter_result(); it is freed on failure
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_median_tiles(const cw_volume *in, size_t radius,
                                        const cw_filter_desc *desc, cw_volume *out,
                                        cw_error *err);

#endif
