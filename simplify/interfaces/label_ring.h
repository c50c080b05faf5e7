/* The triangles around a collapse: before, after, and the space that they pass through. */
#ifndef SIMPLIFY_INTERFACES_LABEL_RING_H
#define SIMPLIFY_INTERFACES_LABEL_RING_H

#include "simplify/interfaces/label_quadrics.h"
#include "simplify/interfaces/moving_boxes.h"

enum {
    CWI_MOVED_TRIANGLES = 2 * CWI_RING_TRIANGLES,
    CWI_RING_NODES = CWI_MOVED_TRIANGLES / CWI_WIDTH,
};

/* A triangle after the collapse. Its corners follow each other as the vertex that stays, a, b. */
typedef struct cwi_moved_triangle {
    uint32_t triangle, a, b, patch;
    double normal[3]; /* twice the area long */
    double scale;     /* at least the product of the lengths that the normal is a product of */
} cwi_moved_triangle;

/* A tetrahedron between a triangle before the collapse and the vertex that stays. */
typedef struct cwi_swept {
    double p[4][3];
} cwi_swept;

typedef struct cwi_collapse_ring {
    cwi_label_move move;
    size_t triangle_count, gone_count, swept_count;
    cwi_moved_triangle triangles[CWI_MOVED_TRIANGLES];
    uint32_t gone[CWI_RING_TRIANGLES]; /* triangles at the edge */
    cwi_swept swept[CWI_MOVED_TRIANGLES];
    cwi_boxes_node triangle_boxes[CWI_RING_NODES], swept_boxes[CWI_RING_NODES];
    float box[6]; /* around all of that */
} cwi_collapse_ring;

/* Makes the ring of a collapse. Returns false if a triangle turns too far, or would have too
 * poor a shape. */
bool cwi_collapse_ring_make(cwi_collapse_ring *ring, const cwi_complex *c,
                            const cwi_label_move *move, const cwi_ring *keep_ring,
                            const cwi_ring *drop_ring);

/* Returns true if the ring's triangles meet each other or other triangles, or if another
 * triangle is in the space that they pass through.
 * marks  triangle_count, below `mark` */
bool cwi_collapse_ring_collides(const cwi_collapse_ring *ring, cwi_complex *c,
                                const cwi_moving_boxes *boxes, uint32_t *marks, uint32_t mark);

#endif
