/* Welding: finds points at the same place. */
#ifndef CORE_MESH_WELD_H
#define CORE_MESH_WELD_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Maps every point to the first one with equal coordinates (0 equals -0).
 * points  count x 3, finite; count below 2^32 - 1
 * map     count
 * Returns false when memory is out; takes 8 to 16 bytes a point. */
bool cwi_weld(const float *points, size_t count, uint32_t *map);

/* Points added one after another; each place is kept once. Zeroed, it has none. */
typedef struct cwi_welder {
    float *points; /* count x 3, the first met at each place */
    size_t count, capacity;
    uint32_t *table; /* of slots, a power of two: point + 1, or 0 */
    size_t slots;
} cwi_welder;

/* Sets each index to that of a finite point (count x 3), which is new when its place was not
 * met before. Many points per call are faster than many calls, since their slots are prefetched
 * together. Returns false when memory is out, or after 2^32 - 2 points. */
bool cwi_welder_add(cwi_welder *w, const float *points, size_t count, uint32_t *indices);
void cwi_welder_free(cwi_welder *w);

#ifdef __cplusplus
}
#endif

#endif
