/* Voxels inside of a level, and their change to the other side. */
#ifndef CORE_FILTER_INSIDE_H
#define CORE_FILTER_INSIDE_H

#include "core/filter/filter_work.h"

#include <stdint.h>

/* Returns true if a stored number is inside. */
bool cwi_value_is_inside(const cw_volume *in, const cw_inside *inside, double stored);

/* Sets a byte a voxel, in the order of packed voxels: 1 inside, 0 outside and where no value is.
 * Returns CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_find_inside(const cw_volume *in, const cw_inside *inside,
                                       const cw_filter_desc *desc, uint8_t *to, cw_error *err);

/* Makes a volume whose voxels are inside as `selected` says. Those that are on the other side become
 * their mirror image at the level, so that the surface passes midway between equal values. All
 * others keep their bytes.
 * selected  a byte a voxel
 * work      bytes of memory beside the result, for desc->max_bytes
 * Returns   CW_ERR_ARGUMENT if the type has no number on the other side; as a filter */
CW_NODISCARD cw_status cwi_change_inside(const cw_volume *in, const cw_inside *inside,
                                         const uint8_t *selected, size_t work,
                                         const cw_filter_desc *desc, cw_volume *out,
                                         cw_error *err);

/* Sets the bytes of voxels within an ellipsoid of one whose byte is `value`: 1 there, else 0.
 * radius   in voxels, along each axis
 * from     a byte a voxel
 * to       another array
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_spread_bytes(const uint8_t *from, uint8_t value, const size_t dim[3],
                                        const double radius[3], const cw_filter_desc *desc,
                                        uint8_t *to, cw_error *err);

/* Fails for a level that is no number, or a radius out of range. */
CW_NODISCARD cw_status cwi_check_inside(const cw_inside *inside, cw_error *err);
CW_NODISCARD cw_status cwi_check_radius(const double radius[3], cw_error *err);

#endif
