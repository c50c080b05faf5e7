/* Vertices with very many triangles, and the directions in which triangles are seen from them.
 * Boxes of long needles around one vertex overlap each other nearly all; the directions do not. */
#ifndef CORE_MESH_WIDE_FANS_H
#define CORE_MESH_WIDE_FANS_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

#define CWI_NO_FAN UINT32_MAX

/* The triangles around each hub: a vertex of more than CWI_WIDE_FAN triangles. A triangle at several
 * hubs belongs to the one with most triangles. Zeroed: none. */
typedef struct cwi_wide_fans {
    size_t count;
    uint32_t *hubs;      /* of each fan, rising */
    size_t *first;       /* count + 1 */
    uint32_t *triangles; /* those of fan f from first[f] to first[f + 1], rising */
    uint32_t *fan_of;    /* triangles: their fan, or CWI_NO_FAN; NULL where there is no fan */
} cwi_wide_fans;

/* Finds the wide fans of a mesh.
 * corners  triangles x 3; those for which `left_out` holds belong to no fan; it may be NULL
 * Returns  CW_ERR_NO_MEMORY; free with cwi_wide_fans_free(), also after a failure
 * Cost     linear */
CW_NODISCARD cw_status cwi_wide_fans_find(
    cwi_wide_fans *fans, size_t vertices, const uint32_t *corners, size_t triangles,
    bool (*left_out)(const void *context, size_t triangle), const void *context, cw_error *err);
void cwi_wide_fans_free(cwi_wide_fans *fans);

/* Computes the box of the unit vectors from a hub towards the points of a triangle. Two triangles
 * whose boxes are apart have no point in common, other than the hub where both have it as a vertex.
 * corners  finite
 * has_hub  the hub is a vertex of it; other vertices may be at the same point
 * box      low x, y, z, high x, y, z: never too small */
void cwi_direction_box(const float hub[3], const float *const corners[3], bool has_hub,
                       float box[6]);

#ifdef __cplusplus
}
#endif

#endif
