/* Segments through a bounding volume hierarchy: the items whose boxes a ray may meet. */
#ifndef CORE_GEOMETRY_BVH_SEGMENT_H
#define CORE_GEOMETRY_BVH_SEGMENT_H

#include "core/geometry/bvh.h"
#include "core/geometry/vec3.h"

/* A segment from a point along a vector, prepared for cwi_boxes_crossed(). */
typedef struct cwi_boxes_segment {
    float from[3], inverse[3]; /* of the vector, kept finite */
    float slack;               /* boxes are widened by it */
    float reach;               /* the fraction of it that counts; a visitor may shorten it */
} cwi_boxes_segment;

static inline cwi_boxes_segment cwi_boxes_segment_of(const double from[3],
                                                     const double vector[3], float slack)
{
    cwi_boxes_segment s = {.slack = slack, .reach = 1};
    for (int a = 0; a < 3; a++) {
        s.from[a] = (float)from[a];
        s.inverse[a] = fabs(vector[a]) > 1e-30 ? (float)(1 / vector[a])
                                               : copysignf(1e30f, (float)vector[a]);
    }
    return s;
}

/* Finds two directions across a ray, the same for equal ones. direction: unit */
static inline void cwi_find_across(const double direction[3], double across[2][3])
{
    const int a = fabs(direction[0]) < 0.6 ? 0 : 1;
    const double axis[3] = {a == 0, a == 1, 0};
    cwi_cross(direction, axis, across[0]);
    cwi_normalise(across[0]);
    cwi_cross(direction, across[0], across[1]);
}

/* Returns bit c for each box c of the node that the segment may meet. */
static inline unsigned cwi_boxes_crossed(const cwi_boxes_node *n, const cwi_boxes_segment *s)
{
    unsigned crossed = 0;
    for (int c = 0; c < CWI_WIDTH; c += 4) {
        cwi_lanes enter = {0, 0, 0, 0}, leave = {s->reach, s->reach, s->reach, s->reach};
        for (int a = 0; a < 3; a++) {
            const bool rises = s->inverse[a] > 0;
            cwi_lanes near, far;
            memcpy(&near, (rises ? n->low : n->high)[a] + c, sizeof near);
            memcpy(&far, (rises ? n->high : n->low)[a] + c, sizeof far);
            const float slack = rises ? s->slack : -s->slack;
            near = (near - slack - s->from[a]) * s->inverse[a];
            far = (far + slack - s->from[a]) * s->inverse[a];
            const cwi_mask later = near > enter, sooner = far < leave;
            enter = (cwi_lanes)(((cwi_mask)near & later) | ((cwi_mask)enter & ~later));
            leave = (cwi_lanes)(((cwi_mask)far & sooner) | ((cwi_mask)leave & ~sooner));
        }
        const cwi_mask meet = enter <= leave;
        crossed |= cwi_mask_bits(&meet) << c;
    }
    return crossed;
}

/* Calls visit for each item whose box a segment may meet, by its slot in the tree's order;
 * stops when visit returns false. Inline, so that visit becomes part of the loop. */
static inline void cwi_boxes_pierce(const cwi_boxes *tree, const cwi_boxes_segment *segment,
                                    bool (*visit)(void *context, size_t slot), void *context)
{
    struct entry {
        int level;
        size_t node;
    } stack[CWI_LEVELS * CWI_WIDTH];
    size_t depth = 0;
    if (tree->count)
        stack[depth++] = (struct entry){tree->levels - 1, 0};
    while (depth) {
        const struct entry e = stack[--depth];
        const cwi_boxes_node *node = tree->nodes + tree->first[e.level] + e.node;
        unsigned crossed = cwi_boxes_crossed(node, segment);
        for (size_t c = 0; crossed; c++, crossed >>= 1) {
            const size_t child = e.node * CWI_WIDTH + c;
            if (!(crossed & 1))
                continue;
            if (e.level > 0)
                stack[depth++] = (struct entry){e.level - 1, child};
            else if (!visit(context, child))
                return;
        }
    }
}

#endif
