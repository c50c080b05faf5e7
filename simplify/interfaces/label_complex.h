/* The interfaces of labels as a complex of triangles, and edge collapses that keep its
 * topology. */
#ifndef SIMPLIFY_INTERFACES_LABEL_COMPLEX_H
#define SIMPLIFY_INTERFACES_LABEL_COMPLEX_H

#include <cubewright/labels.h>

/* The order of a vertex: the lowest dimension of the parts of the complex that meet there.
 * Around an inner vertex the triangles of one patch form a disk. At a vertex of a curve, sectors
 * of triangles join two edges of the curve. All other vertices are points, which stay. A held
 * vertex takes part in no collapse, and neither do its triangles. */
enum { CWI_ORDER_INNER, CWI_ORDER_CURVE, CWI_ORDER_POINT, CWI_ORDER_HELD };

/* Triangles and neighbours of one vertex that a collapse can handle. */
enum { CWI_RING_TRIANGLES = 96, CWI_RING_NEIGHBOURS = 2 * CWI_RING_TRIANGLES };

#define CWI_NO_INDEX UINT32_MAX

/* Triangles, vertices and edges with indices that stay. A side of a triangle has the number of
 * the corner across from it. Not a corner table: an edge may have any number of triangles, and
 * collapses take triangles away. */
typedef struct cwi_complex {
    size_t vertex_count, triangle_count, edge_count; /* at first */
    size_t live;                                     /* triangles left */
    float *points;       /* vertex_count x 3, scaled by a power of two */
    uint32_t *corners;   /* triangle_count x 3; CWI_NO_INDEX: the triangle is gone */
    uint32_t *patches;   /* triangle_count */
    uint32_t *next;      /* 3 x triangle_count: the next corner at the same vertex */
    uint32_t *heads;     /* vertex_count: the first corner; CWI_NO_INDEX: no triangle */
    uint32_t *sides;     /* triangle_count x 3: edges */
    uint32_t (*ends)[2]; /* edge_count; the first is CWI_NO_INDEX: the edge is gone */
    bool *is_curve;      /* edge_count: of a curve, a border or a junction of patches */
    uint8_t *orders;     /* vertex_count */
} cwi_complex;

/* A triangle around a vertex, whose corners follow each other as vertex, a, b. */
typedef struct cwi_ring_triangle {
    uint32_t triangle, a, b;
} cwi_ring_triangle;

typedef struct cwi_neighbour {
    uint32_t vertex, edge;
    uint32_t triangles; /* at the edge, 2 at an edge inside of a patch */
    int32_t balance;    /* 0 if as many triangles run one way along the edge as the other */
} cwi_neighbour;

/* The triangles around a vertex, and the vertices across its edges. */
typedef struct cwi_ring {
    size_t triangle_count, neighbour_count;
    cwi_ring_triangle triangles[CWI_RING_TRIANGLES];
    cwi_neighbour neighbours[CWI_RING_NEIGHBOURS];
} cwi_ring;

/* Builds the complex of all patches. Points are multiplied with the scale.
 * surfaces  checked: patches in order, no triangle with a vertex twice
 * Returns   CW_ERR_NO_MEMORY; free with cwi_complex_free() */
CW_NODISCARD cw_status cwi_complex_build(cwi_complex *c, const cw_label_surfaces *surfaces,
                                         double scale, cw_error *err);
void cwi_complex_free(cwi_complex *c);

/* Gathers the ring of a vertex. Returns false if it has too many triangles. */
bool cwi_ring_gather(const cwi_complex *c, uint32_t vertex, cwi_ring *ring);

/* Finds a neighbour of a ring; NULL: the vertex is none. */
const cwi_neighbour *cwi_ring_find(const cwi_ring *ring, uint32_t vertex);

/* Decides which end of an edge stays if it collapses, by their orders. Returns false where no
 * collapse is allowed. */
bool cwi_complex_choose(const cwi_complex *c, uint32_t edge, uint32_t *keep, uint32_t *drop);

/* Tests the link condition of a collapse [Dey1999]: the complex stays homeomorphic, with its
 * curves and points. */
bool cwi_complex_links_allow(const cwi_complex *c, uint32_t edge, uint32_t keep, uint32_t drop,
                             const cwi_ring *keep_ring, const cwi_ring *drop_ring);

/* Joins the vertex `drop` to `keep`, which must have passed both tests. Triangles at the edge
 * go. */
void cwi_complex_collapse(cwi_complex *c, uint32_t edge, uint32_t keep, uint32_t drop,
                          const cwi_ring *keep_ring, const cwi_ring *drop_ring);

#endif
