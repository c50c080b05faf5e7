/* Quadrics of a label complex: the cost of a collapse, and the best position for its vertex. */
#ifndef SIMPLIFY_INTERFACES_LABEL_QUADRICS_H
#define SIMPLIFY_INTERFACES_LABEL_QUADRICS_H

#include "simplify/interfaces/label_complex.h"

/* A weighted sum of squared distances from planes and lines: x A x + 2 b x + c. */
typedef struct cwi_label_quadric {
    double a[6], b[3], c; /* A by rows: xx, xy, xz, yy, yz, zz */
} cwi_label_quadric;

/* A collapse that is planned: which vertex stays, where, and at which cost. */
typedef struct cwi_label_move {
    uint32_t edge, keep, drop;
    float position[3];
    float cost; /* INFINITY: no collapse is allowed */
} cwi_label_move;

/* Computes the quadrics of all vertices: of the planes of their triangles in all patches, by
 * area, and of the lines of their curves, by squared length.
 * quadrics  vertex_count */
void cwi_label_quadrics_build(const cwi_complex *c, cwi_label_quadric *quadrics);

/* Plans the collapse of an edge. Inner vertices join where the sum of their quadrics is least;
 * vertices of a curve join on the edge. A vertex of higher order stays in its position. */
cwi_label_move cwi_label_move_plan(const cwi_complex *c, const cwi_label_quadric *quadrics,
                                   uint32_t edge);

/* Adds the quadric of the vertex that goes to that of the vertex that stays. */
void cwi_label_quadrics_join(cwi_label_quadric *quadrics, uint32_t keep, uint32_t drop);

#endif
