/* Checks of an extraction's triangles and memory against the limits of its descriptor. */
#ifndef EXTRACT_COMMON_EXTRACT_LIMITS_H
#define EXTRACT_COMMON_EXTRACT_LIMITS_H

#include <cubewright/extract.h>

size_t cwi_extract_mesh_bytes(const cw_extract_counts *counts, bool normals);
CW_NODISCARD cw_status cwi_extract_check_limits(const cw_extract_desc *desc,
                                                const cw_extract_counts *counts, cw_error *err);

#endif
