/* The surroundings of a loop as a mesh of their own, with the surface cut along the loop. */
#ifndef SIMPLIFY_HANDLES_LOOP_SURROUNDINGS_H
#define SIMPLIFY_HANDLES_LOOP_SURROUNDINGS_H

#include "simplify/handles/handle_state.h"

/* Vertices: the left rim, the right rim, then those of the surface. Triangles: those around the loop, then those near
 * it. A zeroed struct is valid and empty. */
typedef struct cwi_surroundings {
    const cwi_handles *h;
    const uint32_t *sides; /* of the loop */
    uint32_t rim;          /* vertices of either rim */
    cw_mesh mesh;          /* only positions and triangles */
    uint32_t *ids;         /* of its triangles in the surface */
    size_t around;         /* triangles around the loop */
    uint32_t *vertices; /* of the surface, rising; vertex n is vertex n + 2 rim of the mesh */
    size_t vertex_count;
    float *
        steps; /* 2 rims x 3: from each vertex of a rim to the middle of its neighbours beside the loop */
} cwi_surroundings;

/* Gathers the surroundings within a box. changed, ids: as of cwi_handles_plan().
 * Returns false when memory is out */
bool cwi_surroundings_gather(cwi_surroundings *near, const cwi_handles *h,
                             const cwi_loops *loops, const cwi_loop *loop,
                             const cwi_boxes *changed, const uint32_t *ids, const float box[6]);

/* Moves the rims apart: their vertices go a fraction of their steps. Returns false if a triangle turns by 90 degrees
 * or more, or loses its area. */
bool cwi_surroundings_part_rims(cwi_surroundings *near, float fraction);

void cwi_surroundings_free(cwi_surroundings *near);

#endif
