/* Triangles of rings of points in a plane, by clipping ears. */
#ifndef CORE_MESH_CLIP_EARS_H
#define CORE_MESH_CLIP_EARS_H

#include "core/geometry/exact_predicates.h"

/* A vertex of a ring. A vertex at which a hole is joined to a ring has two nodes. */
typedef struct cwi_ring_node {
    uint32_t vertex, next, prev;
    uint32_t loop; /* for the caller */
} cwi_ring_node;

/* Rings of nodes, seen in a plane, and what takes their triangles. */
typedef struct cwi_ears {
    const float *positions; /* of vertices, x 3 */
    cwi_ring_node *nodes;   /* changed: nodes are cut off */
    size_t node_count;
    int axis;      /* that is left out of the points */
    int direction; /* 1 or -1: what makes cwi_orient2d() positive where a ring is convex */
    double
        tolerance; /* nodes deeper in an ear than this are in it, where rounding makes rings cross */
    bool is_flipped;                                             /* triangles are turned over */
    bool (*add)(void *user, uint32_t a, uint32_t b, uint32_t c); /* false: memory is out */
    void *user;
    const cw_progress *progress; /* of the last 40 % of a step "fill"; NULL: none */
} cwi_ears;

/* Returns the axes of the plane's coordinates: rings run against the clock in them. */
static inline int cwi_ears_u(const cwi_ears *e)
{
    return (e->axis + (e->direction > 0 ? 1 : 2)) % 3;
}

static inline int cwi_ears_v(const cwi_ears *e)
{
    return (e->axis + (e->direction > 0 ? 2 : 1)) % 3;
}

/* Cuts ears from the ring with a node until nothing is left. Each edge of the ring is then an edge of
 * one triangle, even if the ring crosses itself. Time grows nearly as the nodes do.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Source   [Meisters1975] */
CW_NODISCARD cw_status cwi_clip_ears(cwi_ears *ears, uint32_t start, cw_error *err);

#endif
