/* Measures the topology of a surface around some of its vertices. */
#ifndef SIMPLIFY_QUALITY_VERTEX_STARS_H
#define SIMPLIFY_QUALITY_VERTEX_STARS_H

#include "simplify/quality/open_loops.h"

#include <cubewright/quality.h>

/* Triangles that hold all those around each vertex of a range. */
typedef struct cwi_stars {
    const uint32_t *triangles; /* count x 3 vertices */
    size_t count;
    uint32_t begin, end; /* the range */
    int threads;
} cwi_stars;

/* Adds to q the counts of the range's vertices, and of edges and duplicates whose lowest vertex
 * is in the range; euler too, but for triangles. The border gets the ends of open edges at these
 * vertices. components is increased by the vertices of triangles that name three.
 * False when memory is out. */
bool cwi_measure_stars(const cwi_stars *stars, cw_quality *q, cwi_border *border);

#endif
