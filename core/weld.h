/* Which points are at the same place? */
#ifndef CORE_WELD_H
#define CORE_WELD_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Maps every point to the first one with equal coordinates (0 equals -0).
 * points  count x 3, finite; count below 2^32 - 1
 * map     count
 * Returns false when memory is out; takes 8 to 16 bytes a point. */
CW_API bool cwi_weld(const float *points, size_t count, uint32_t *map);

#ifdef __cplusplus
}
#endif

#endif
