/* Segments through a bounding volume hierarchy: the items whose boxes a ray may meet. */
#ifndef CORE_GEOMETRY_BVH_SEGMENT_H
#define CORE_GEOMETRY_BVH_SEGMENT_H

#include "core/geometry/bvh.h"
#include "core/geometry/vec3.h"

/* A segment from a point along a vector, prepared for cwi_boxes_crossed(). */
typedef struct cwi_boxes_segment {
    float near[3], far[3]; /* the start, moved so that boxes are widened by the slack */
    float inverse[3];      /* of the vector, kept finite */
    float begin, reach;    /* the fractions of it that count; a visitor may bring them nearer */
} cwi_boxes_segment;

/* Begins at the point, and ends at the end of the vector.
 * slack  boxes are widened by it: far more than rounding moves the start */
static inline cwi_boxes_segment cwi_boxes_segment_of(const double from[3],
                                                     const double vector[3], float slack)
{
    cwi_boxes_segment s = {.reach = 1};
    for (int a = 0; a < 3; a++) {
        s.inverse[a] = fabs(vector[a]) > 1e-30 ? (float)(1 / vector[a])
                                               : copysignf(1e30f, (float)vector[a]);
        const float outward = s.inverse[a] > 0 ? slack : -slack;
        s.near[a] = (float)from[a] + outward;
        s.far[a] = (float)from[a] - outward;
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

/* Return the greater or lesser number of each lane. */
static inline cwi_lanes cwi_greater_lanes(cwi_lanes a, cwi_lanes b)
{
#ifdef __SSE2__
    return (cwi_lanes)_mm_max_ps((__m128)a, (__m128)b);
#else
    const cwi_mask is_greater = a > b;
    return (cwi_lanes)(((cwi_mask)a & is_greater) | ((cwi_mask)b & ~is_greater));
#endif
}

static inline cwi_lanes cwi_lesser_lanes(cwi_lanes a, cwi_lanes b)
{
#ifdef __SSE2__
    return (cwi_lanes)_mm_min_ps((__m128)a, (__m128)b);
#else
    const cwi_mask is_less = a < b;
    return (cwi_lanes)(((cwi_mask)a & is_less) | ((cwi_mask)b & ~is_less));
#endif
}

/* Returns bit c for each box c of the node that the segment may meet. */
static inline unsigned cwi_boxes_crossed(const cwi_boxes_node *n, const cwi_boxes_segment *s)
{
    cwi_lanes enter[2], leave[2];
    for (int half = 0; half < 2; half++) {
        enter[half] = (cwi_lanes){s->begin, s->begin, s->begin, s->begin};
        leave[half] = (cwi_lanes){s->reach, s->reach, s->reach, s->reach};
    }
    for (int a = 0; a < 3; a++) {
        const bool rises = s->inverse[a] > 0;
        const float *first = rises ? n->low[a] : n->high[a],
                    *last = rises ? n->high[a] : n->low[a];
        for (int half = 0; half < 2; half++) {
            cwi_lanes near, far;
            memcpy(&near, first + 4 * half, sizeof near);
            memcpy(&far, last + 4 * half, sizeof far);
            enter[half] = cwi_greater_lanes((near - s->near[a]) * s->inverse[a], enter[half]);
            leave[half] = cwi_lesser_lanes((far - s->far[a]) * s->inverse[a], leave[half]);
        }
    }
    const cwi_mask meet[2] = {enter[0] <= leave[0], enter[1] <= leave[1]};
    return cwi_mask_bits(&meet[0]) | cwi_mask_bits(&meet[1]) << 4;
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
        for (; crossed; crossed &= crossed - 1) {
            const size_t child = e.node * CWI_WIDTH + (size_t)__builtin_ctz(crossed);
            if (e.level > 0)
                stack[depth++] = (struct entry){e.level - 1, child};
            else if (!visit(context, child))
                return;
        }
    }
}

#endif
