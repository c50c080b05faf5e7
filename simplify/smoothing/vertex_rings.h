/* The neighbours of each vertex, and the rims of a mesh: its borders and junctions. */
#ifndef SIMPLIFY_SMOOTHING_VERTEX_RINGS_H
#define SIMPLIFY_SMOOTHING_VERTEX_RINGS_H

#include <cubewright/mesh.h>

/* Vertices that one thread works on at a time. */
enum { CWI_RING_PART = 1 << 13 };

/* Edges that a vertex is at. */
typedef enum cwi_vertex_border {
    CWI_BORDER_NONE,     /* edges of two triangles alone */
    CWI_BORDER_OPEN,     /* an edge of one triangle */
    CWI_BORDER_JUNCTION, /* an edge of three or more, and none of one */
} cwi_vertex_border;

/* Neighbours of a vertex are those at the other ends of its edges, each once and in rising order.
 * A vertex at a rim has the ends of the rim's edges alone. Not a corner table: smoothing reads
 * neighbours, never triangles, in every step. */
typedef struct cwi_rings {
    size_t vertices;
    size_t *begin;        /* first neighbour of each vertex; vertices + 1 */
    uint32_t *count;      /* neighbours of each vertex */
    uint32_t *neighbours; /* with gaps between those of two vertices */
    uint8_t *border;      /* of each vertex, a cwi_vertex_border */
} cwi_rings;

/* Finds the neighbours. Triangles that name a vertex twice have no edges.
 * rings  filled; free them with cwi_rings_free(), also after failure
 * Returns CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_rings_find(const cw_mesh *mesh, int threads,
                                      const cw_progress *progress, cwi_rings *rings,
                                      cw_error *err);
void cwi_rings_free(cwi_rings *rings);

#endif
