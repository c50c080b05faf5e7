/* Statistics of a volume that comes in parts, such as some slices at a time: the range of all
 * parts first, then the bins. The result is that of cw_volume_statistics(). */
#ifndef CORE_VOLUME_HISTOGRAM_H
#define CORE_VOLUME_HISTOGRAM_H

#include <cubewright/volume.h>

/* Returns statistics without values. */
cw_statistics cwi_statistics_of(const cw_volume *shape);

/* Adds a part to the range and the counts. Returns CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_statistics_scan(cw_statistics *statistics, const cw_volume *part,
                                           int threads, cw_error *err);

/* Ends the range, and makes empty bins. Returns CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_statistics_divide(cw_statistics *statistics, size_t bin_count,
                                             cw_error *err);

/* Counts a part's values in bins. Returns CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_statistics_count(cw_statistics *statistics, const cw_volume *part,
                                            int threads, cw_error *err);

#endif
