/* A tree of the boxes of triangles that change their places and disappear. */
#ifndef SIMPLIFY_INTERFACES_MOVING_BOXES_H
#define SIMPLIFY_INTERFACES_MOVING_BOXES_H

#include "core/geometry/bvh.h"
#include "simplify/interfaces/label_complex.h"

/* The tree has the shape of the triangles when it was built. Later a triangle's box follows it,
 * and the boxes around it grow, but never shrink. */
typedef struct cwi_moving_boxes {
    cwi_boxes tree;
    uint32_t *slots; /* triangle_count: the place of a triangle in the tree */
    size_t built;    /* triangles at the time of building */
} cwi_moving_boxes;

/* Builds the tree of the triangles that are left. The tree must be zeroed, or built before.
 * Returns  CW_ERR_NO_MEMORY; free with cwi_moving_boxes_free() */
CW_NODISCARD cw_status cwi_moving_boxes_build(cwi_moving_boxes *m, const cwi_complex *c,
                                              cw_error *err);
void cwi_moving_boxes_free(cwi_moving_boxes *m);

/* Moves the box of a triangle that has changed. */
void cwi_moving_boxes_update(cwi_moving_boxes *m, const cwi_complex *c, uint32_t triangle);

/* Takes a triangle out. */
void cwi_moving_boxes_remove(cwi_moving_boxes *m, uint32_t triangle);

/* Calls visit for each triangle whose box shares a point with a box, until it returns true.
 * Returns the last result. Inline, so that visit becomes part of the loop. */
static inline bool cwi_moving_boxes_any(const cwi_moving_boxes *m, const float box[6],
                                        bool (*visit)(void *context, uint32_t triangle,
                                                      const float its_box[6]),
                                        void *context)
{
    struct entry {
        int level;
        size_t node;
    } stack[CWI_LEVELS * CWI_WIDTH];
    size_t depth = 0;
    if (m->tree.count)
        stack[depth++] = (struct entry){m->tree.levels - 1, 0};
    while (depth) {
        const struct entry e = stack[--depth];
        const cwi_boxes_node *node = m->tree.nodes + m->tree.first[e.level] + e.node;
        unsigned meeting = cwi_boxes_meeting(node, box);
        for (size_t n = 0; meeting; n++, meeting >>= 1) {
            const size_t child = e.node * CWI_WIDTH + n;
            if (!(meeting & 1))
                continue;
            if (e.level > 0) {
                stack[depth++] = (struct entry){e.level - 1, child};
                continue;
            }
            const float its_box[6] = {node->low[0][n],  node->low[1][n],  node->low[2][n],
                                      node->high[0][n], node->high[1][n], node->high[2][n]};
            if (visit(context, m->tree.order[child], its_box))
                return true;
        }
    }
    return false;
}

#endif
