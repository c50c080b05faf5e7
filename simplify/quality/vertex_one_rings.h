/* Measures the topology of a surface around some of its vertices. */
#ifndef SIMPLIFY_QUALITY_VERTEX_ONE_RINGS_H
#define SIMPLIFY_QUALITY_VERTEX_ONE_RINGS_H

#include "simplify/quality/open_loops.h"

#include <cubewright/quality.h>

struct cwi_vertex_ranges;

/* Reasons why the surface around a vertex bounds no volume. */
enum { CWI_OPEN = 1, CWI_UNORIENTED = 2 };

/* Triangles that hold all those around each vertex of a range. The arrays that a whole mesh
 * wants are NULL for a part of one. */
typedef struct cwi_one_rings {
    const uint32_t *triangles; /* count x 3 vertices */
    size_t count;
    const struct cwi_vertex_ranges *ranges; /* of the triangles */
    uint32_t begin, end;                    /* the vertices that were filed */
    int threads;
    const cw_progress *progress;
    uint8_t *defects;   /* of each triangle: bits of cw_defect are set; may be NULL */
    uint32_t *sets;     /* of vertices: union-find; triangles join their corners */
    uint8_t *used;      /* of vertices: set to 1 for those of triangles that name three */
    uint8_t *unbounded; /* of vertices: set to CWI_OPEN and CWI_UNORIENTED for the edges to
                           higher vertices; may be NULL */
} cwi_one_rings;

/* Adds to q the counts of the range's vertices, and of edges and duplicates whose lowest vertex
 * is in the range. The border gets the ends of open edges at these vertices; it may be NULL.
 * components is increased by the vertices of triangles that name three, euler by these less
 * edges. With sets, both are those of the whole mesh.
 * False when memory is out, or when the progress has cancelled. */
bool cwi_measure_one_rings(const cwi_one_rings *rings, cw_quality *q, cwi_border *border);

/* Counts the loops of a mesh's open edges.
 * open_edges  their number
 * False when memory is out, or when the progress has cancelled. */
bool cwi_count_loops(const cwi_one_rings *rings, size_t open_edges, size_t *loops);

#endif
