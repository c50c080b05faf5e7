/* The components of a surface that passes by in pieces, and the volumes that they enclose. In
 * memory are only the vertices at its front: those that later triangles may still name. */
#ifndef CORE_MESH_COMPONENT_FRONT_H
#define CORE_MESH_COMPONENT_FRONT_H

#include "core/mesh/enclosed_volume.h"

#include <cubewright/mesh.h>

/* The link of a vertex that leaves the front: to a vertex of its component that leaves later, so
 * many numbers ahead; or the verdict about its component, which has no later vertex. */
enum { CWI_LINK_DROPPED = 0 };
#define CWI_LINK_KEPT UINT32_MAX

struct cwi_front_component;

/* A front. Zero it and set `least_mm3`, `max_bytes` and `unit`; free it with cwi_front_free(). */
typedef struct cwi_component_front {
    double least_mm3;     /* as in cw_mesh_drop_volumes() */
    size_t max_bytes;     /* limit of its arrays; 0: none */
    cwi_volume_unit unit; /* for all coordinates */

    size_t begin, end; /* vertices of the front */
    uint32_t *sets;    /* union-find; numbers count from `begin` on. After
                          cwi_front_settle(): links of the settled vertices */
    uint32_t *slots;   /* components of the sets' first vertices */
    int32_t (*points)[3];
    size_t capacity;

    struct cwi_front_component *components;
    size_t component_count, component_capacity;
    uint32_t free_slot; /* list of unused components, by their number plus 1 */

    cw_drop_counts
        counts; /* of components that are complete; dropped_mm3 and triangles are 0 */
    cwi_volume_sum dropped; /* twelve times the volume */
    size_t farthest;        /* the longest link so far */
} cwi_component_front;

/* Returns true if the front has no place for more vertices. Then settle those that are final, and
 * reserve. */
bool cwi_front_is_full(const cwi_component_front *front, size_t vertices);

/* Makes room for more vertices, and an eighth beside that. Settling a full front takes time, and
 * must not happen for every few vertices.
 * Returns CW_ERR_LIMIT: max_bytes; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_front_reserve(cwi_component_front *front, size_t vertices,
                                         cw_error *err);

/* Appends vertices, for which there is room.
 * Returns CW_ERR_ARGUMENT  a position is not finite */
CW_NODISCARD cw_status cwi_front_append(cwi_component_front *front, const float *positions,
                                        size_t vertices, cw_error *err);

/* Adds a triangle of three vertices of the front. Returns as cwi_front_reserve(). */
CW_NODISCARD cw_status cwi_front_join(cwi_component_front *front, const uint32_t corners[3],
                                      cw_error *err);

/* Turns the first vertices into links, up to vertex `final`, and judges the components that are
 * complete. The links are front->sets. Then drop these vertices. */
void cwi_front_settle(cwi_component_front *front, size_t final);
void cwi_front_drop(cwi_component_front *front, size_t final);

/* Returns the bytes of the front's arrays. */
size_t cwi_front_bytes(const cwi_component_front *front);

void cwi_front_free(cwi_component_front *front);

#endif
