/* The common parts of filters: their input, their result, and rows of values. */
#ifndef CORE_FILTER_FILTER_WORK_H
#define CORE_FILTER_FILTER_WORK_H

#include <cubewright/filter.h>

/* Widest Gaussians in voxels, and how far they reach in standard deviations. */
enum { CWI_GAUSS_MAX = 64, CWI_GAUSS_REACH = 4 };

/* Resolves the first component and step of a volume for a filter.
 * what     names the filter in errors
 * Returns  CW_ERR_UNSUPPORTED for grids that are not even */
CW_NODISCARD cw_status cwi_filter_input(const cw_volume *volume, const char *what,
                                        cw_volume *in, cw_error *err);

/* Fails if a result of this type and these dimensions is too large, before anything is allocated.
 * work     bytes for the work on it
 * Returns  CW_ERR_LIMIT when both exceed desc->max_bytes */
CW_NODISCARD cw_status cwi_filter_check_size(cw_type type, const size_t dim[3],
                                             const cw_filter_desc *desc, size_t work,
                                             cw_error *err);

/* Makes the result, with the frame and the scaling of the input.
 * type     of its voxels: the input's, or cw_filter_type() of it where values become fractions
 * work     bytes for the work on it
 * Returns  CW_ERR_LIMIT when both exceed desc->max_bytes */
CW_NODISCARD cw_status cwi_filter_result(const cw_volume *in, cw_type type, const size_t dim[3],
                                         const cw_filter_desc *desc, size_t work,
                                         cw_volume *out, cw_error *err);

/* Returns true if some voxel of the volume has no value: no data, or not finite. */
bool cwi_filter_has_gaps(const cw_volume *in, int threads);

/* Loads a row of stored values. valid: set to 1 for each value, to 0 for each that is missing,
 * which is loaded as 0; NULL: none is */
void cwi_filter_load(const cw_volume *in, size_t j, size_t k, double *values, double *valid);

/* Stores a value: rounded, within the type, and never as no data. */
void cwi_filter_store(const cw_volume *out, void *voxel, double value);

/* Stores that there is no value. */
void cwi_filter_store_gap(const cw_volume *out, void *voxel);

#endif
