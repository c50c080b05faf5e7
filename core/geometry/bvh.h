/* A bounding volume hierarchy: a tree of boxes for nearest-point and overlap queries. */
#ifndef CORE_GEOMETRY_BVH_H
#define CORE_GEOMETRY_BVH_H

#include <cubewright/core.h>

#include <math.h>
#include <string.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_WIDTH = 8, CWI_LEVELS = 12 };

/* The boxes of eight neighbours, side by side, for arithmetic on several at a time. Missing
 * boxes are empty, low above high. */
typedef struct cwi_boxes_node {
    float low[3][CWI_WIDTH], high[3][CWI_WIDTH];
} cwi_boxes_node;

/* A tree of items sorted along a space-filling curve. Eight in a row make a node, eight nodes
 * one of the next level, up to a single one. So the tree has no pointers and a small depth: any
 * boxes, also equal ones, give the same shape. Zeroed: empty. */
typedef struct cwi_boxes {
    size_t count;
    uint32_t *order; /* items in the order of the tree: slot s holds item order[s] */
    cwi_boxes_node *nodes;
    int levels;
    size_t first[CWI_LEVELS]; /* node of each level; 0 holds items, the last is one node */
    float max;                /* the largest absolute coordinate */
} cwi_boxes;

/* Sorts boxes into a tree. They are not needed afterwards.
 * boxes    count x 6: low x, y, z, high x, y, z; no NaN; lows below infinity, highs above -infinity; fewer than 2^32
 * Returns  CW_ERR_NO_MEMORY; free with cwi_boxes_free()
 * Cost     28 bytes an item, 32 more meanwhile
 * Source   the curve's ranks [Hamilton2006] */
CW_NODISCARD cw_status cwi_boxes_build(cwi_boxes *tree, const float (*boxes)[6], size_t count,
                                       cw_error *err);

/* Does the same with a number of threads; 0: the default number. The tree is the same. */
CW_NODISCARD cw_status cwi_boxes_build_by(cwi_boxes *tree, const float (*boxes)[6],
                                          size_t count, int threads, cw_error *err);
void cwi_boxes_free(cwi_boxes *tree);

/* Calls visit for each node of level 0 that may hold boxes sharing a point with this box. It
 * starts at node `first`, goes in rising order, and stops when visit returns false. Item s of
 * the tree's order is box s % CWI_WIDTH of node s / CWI_WIDTH.
 * box  low x, y, z, high x, y, z; ends may be infinite */
void cwi_boxes_visit(const cwi_boxes *tree, const float box[6], size_t first,
                     bool (*visit)(void *context, size_t node), void *context);

/* Computes the box around a node's boxes. */
void cwi_boxes_around(const cwi_boxes_node *node, float box[6]);

/* Computes the box around a triangle. points: vertices x 3; v: three of them */
static inline void cwi_boxes_triangle(const float *points, const uint32_t v[3], float box[6])
{
    for (int a = 0; a < 3; a++) {
        const float *p = points + a;
        const float x = p[3 * (size_t)v[0]], y = p[3 * (size_t)v[1]], z = p[3 * (size_t)v[2]];
        box[a] = x < y ? (x < z ? x : z) : (y < z ? y : z);
        box[a + 3] = x > y ? (x > z ? x : z) : (y > z ? y : z);
    }
}

/* Sets box `child` of a row of nodes. */
static inline void cwi_boxes_put(cwi_boxes_node *nodes, size_t child, const float box[6])
{
    for (int a = 0; a < 3; a++) {
        nodes[child / CWI_WIDTH].low[a][child % CWI_WIDTH] = box[a];
        nodes[child / CWI_WIDTH].high[a][child % CWI_WIDTH] = box[a + 3];
    }
}

/* Fills a node with empty boxes. */
static inline void cwi_boxes_clear(cwi_boxes_node *node)
{
    const float empty[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
    for (size_t c = 0; c < CWI_WIDTH; c++)
        cwi_boxes_put(node, c, empty);
}

/* Four numbers at a time, as explicit vectors: compilers make jumps of loops this short. */
typedef float cwi_lanes __attribute__((vector_size(16)));
typedef int32_t cwi_mask __attribute__((vector_size(16)));

/* Returns bit c for each set lane c of a mask. */
static inline unsigned cwi_mask_bits(const cwi_mask *mask)
{
#ifdef __SSE2__
    return (unsigned)_mm_movemask_ps((__m128)*mask);
#else
    const cwi_mask bits = *mask & (cwi_mask){1, 2, 4, 8};
    return (unsigned)(bits[0] | bits[1] | bits[2] | bits[3]);
#endif
}

/* Returns bit c for each box c of the node that shares a point with the box. */
static inline unsigned cwi_boxes_meeting(const cwi_boxes_node *n, const float box[6])
{
    unsigned meeting = 0;
    for (int c = 0; c < CWI_WIDTH; c += 4) {
        cwi_mask meet = {-1, -1, -1, -1};
        for (int a = 0; a < 3; a++) {
            cwi_lanes low, high;
            memcpy(&low, n->low[a] + c, sizeof low);
            memcpy(&high, n->high[a] + c, sizeof high);
            meet &= (low <= box[a + 3]) & (high >= box[a]);
        }
        meeting |= cwi_mask_bits(&meet) << c;
    }
    return meeting;
}

/* Returns the number of nodes of level 0. */
static inline size_t cwi_boxes_nodes(const cwi_boxes *tree)
{
    return (tree->count + CWI_WIDTH - 1) / CWI_WIDTH;
}

/* Computes lower bounds of the squares of a point's distances from eight boxes: the boxes are
 * widened by slack. A point is beyond at most one of a box's ends. Returns bit c where the square
 * of box c is less than a limit. */
static inline unsigned cwi_boxes_squares(const cwi_boxes_node *n, const float p[3], float slack,
                                         float limit, float distances_sq[CWI_WIDTH])
{
    unsigned less = 0;
    for (int c = 0; c < CWI_WIDTH; c += 4) {
        cwi_lanes sum = {0, 0, 0, 0};
        for (int a = 0; a < 3; a++) {
            cwi_lanes low, high;
            memcpy(&low, n->low[a] + c, sizeof low);
            memcpy(&high, n->high[a] + c, sizeof high);
            const cwi_lanes below = low - (p[a] + slack), above = (p[a] - slack) - high;
            const cwi_mask is_below = below > 0, is_above = above > 0;
            const cwi_lanes d =
                (cwi_lanes)(((cwi_mask)below & is_below) | ((cwi_mask)above & is_above));
            sum += d * d;
        }
        const cwi_mask is_less = sum < limit;
        less |= cwi_mask_bits(&is_less) << c;
        memcpy(distances_sq + c, &sum, sizeof sum);
    }
    return less;
}

/* Lowers *square, a squared distance, to the minimum that `measure` finds among items in reach.
 * measure lowers *square for the item in a slot, if that is nearer. Inline, so that measure
 * becomes part of the loop. */
static inline void cwi_boxes_nearest(const cwi_boxes *tree, const double point[3],
                                     void (*measure)(void *context, size_t slot,
                                                     double *distance_sq),
                                     void *context, double *distance_sq)
{
    struct entry {
        float distance_sq;
        int level;
        size_t node;
    } stack[CWI_LEVELS * CWI_WIDTH];
    const struct entry root = {0, tree->levels - 1, 0};
    const float p[3] = {(float)point[0], (float)point[1], (float)point[2]};
    const float far = fmaxf(fmaxf(fabsf(p[0]), fabsf(p[1])), fmaxf(fabsf(p[2]), tree->max));
    const float slack = far * 0x1p-21f;
    size_t depth = 0;
    if (tree->count)
        stack[depth++] = root;
    while (depth) {
        const struct entry e = stack[--depth];
        if ((double)e.distance_sq * (1 - 0x1p-20) >= *distance_sq)
            continue;
        float distances_sq[CWI_WIDTH];
        const size_t child = e.node * CWI_WIDTH, base = depth;
        unsigned near = cwi_boxes_squares(tree->nodes + tree->first[e.level] + e.node, p, slack,
                                          (float)(*distance_sq * (1 + 0x1p-19)), distances_sq);
        for (; near; near &= near - 1) {
            const size_t c = (size_t)__builtin_ctz(near);
            if (e.level == 0) {
                if ((double)distances_sq[c] * (1 - 0x1p-20) < *distance_sq)
                    measure(context, child + c, distance_sq);
                continue;
            }
            const struct entry found = {distances_sq[c], e.level - 1, child + c};
            size_t s = depth++; /* the nearest one comes last, and is taken first */
            for (; s > base && stack[s - 1].distance_sq < distances_sq[c]; s--)
                stack[s] = stack[s - 1];
            stack[s] = found;
        }
    }
}

#ifdef __cplusplus
}
#endif

#endif
