/* The distance between patches before and after simplification. */
#ifndef SIMPLIFY_INTERFACES_PATCH_DISTANCE_H
#define SIMPLIFY_INTERFACES_PATCH_DISTANCE_H

#include <cubewright/labels.h>

/* Marks the triangles that are not certainly within a distance of the same patch of the other
 * surfaces. Patches with equal numbers of triangles count as equal.
 * in_beyond, out_beyond  one a triangle: set to 0 or 1
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_patches_measure(const cw_label_surfaces *in,
                                           const cw_label_surfaces *out, double error_mm,
                                           int threads, const cw_progress *progress,
                                           uint8_t *in_beyond, uint8_t *out_beyond,
                                           cw_error *err);

#endif
