// A bounding volume hierarchy of triangles that move.
#ifndef SIMPLIFY_COLLAPSE_DYNAMIC_BVH_HPP
#define SIMPLIFY_COLLAPSE_DYNAMIC_BVH_HPP

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/bvh.h"

#include <new>
#include <vector>

namespace cw
{

// A box in a query or of a triangle: low x, y, z, high x, y, z.
struct Box {
    float side[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};

    template <typename Point> void add(const Point &p)
    {
        for (int k = 0; k < 3; k++) {
            side[k] = std::min(side[k], p[k]);
            side[k + 3] = std::max(side[k + 3], p[k]);
        }
    }

    bool meets(const Box &other) const
    {
        for (int k = 0; k < 3; k++)
            if (side[k] > other.side[k + 3] || other.side[k] > side[k + 3])
                return false;
        return true;
    }
};

// The tree of boxes as it was at first; then a triangle's box follows it, and boxes around it
// grow, but never shrink.
class Nearby
{
public:
    // Builds the tree of some triangles, whose numbers are below `capacity`.
    Nearby(const std::vector<uint32_t> &triangles, const std::vector<Box> &boxes,
           size_t capacity)
        : slots(capacity)
    {
        cw_error err;
        if (boxes.empty())
            return;
        const float(*sides)[6] = &boxes.data()->side;
        if (cwi_boxes_build(&tree, sides, boxes.size(), &err) != CW_OK)
            throw std::bad_alloc();
        for (size_t s = 0; s < boxes.size(); s++) {
            tree.order[s] = triangles[tree.order[s]];
            slots[tree.order[s]] = uint32_t(s);
        }
    }

    ~Nearby()
    {
        cwi_boxes_free(&tree);
    }

    Nearby(const Nearby &) = delete;
    Nearby &operator=(const Nearby &) = delete;

    void move(uint32_t triangle, const Box &box)
    {
        size_t slot = slots[triangle];
        cwi_boxes_put(tree.nodes, slot, box.side);
        for (int level = 1; level < tree.levels; level++) {
            slot /= CWI_WIDTH;
            if (!grow(node(level, slot), slot, box.side))
                break;
        }
    }

    void remove(uint32_t triangle)
    {
        const size_t slot = slots[triangle];
        cwi_boxes_put(tree.nodes, slot, Box().side);
    }

    // Shrinks the boxes around triangles after many of them were removed.
    void shrink()
    {
        for (int level = 1; level < tree.levels; level++) {
            const size_t below = tree.first[level] - tree.first[level - 1];
            for (size_t n = 0; n < below; n++) {
                float around[6];
                cwi_boxes_around(tree.nodes + tree.first[level - 1] + n, around);
                cwi_boxes_put(tree.nodes + tree.first[level], n, around);
            }
        }
    }

    // Calls visit(triangle, its box) for triangles whose boxes share a point with `box`, until
    // it returns true.
    template <typename Visit>
    __attribute__((always_inline)) bool any(const Box &box, Visit &&visit) const
    {
        struct {
            int level;
            size_t node;
        } stack[CWI_LEVELS * CWI_WIDTH];
        size_t depth = 0;
        if (tree.levels)
            stack[depth++] = {tree.levels - 1, 0};
        while (depth) {
            const auto [level, n] = stack[--depth];
            const cwi_boxes_node &boxes = tree.nodes[tree.first[level] + n];
            unsigned meeting = cwi_boxes_meeting(&boxes, box.side);
            for (; meeting; meeting &= meeting - 1) {
                const auto c = size_t(__builtin_ctz(meeting));
                if (level) {
                    stack[depth++] = {level - 1, n * CWI_WIDTH + c};
                    continue;
                }
                const float side[6] = {boxes.low[0][c],  boxes.low[1][c],  boxes.low[2][c],
                                       boxes.high[0][c], boxes.high[1][c], boxes.high[2][c]};
                if (visit(tree.order[n * CWI_WIDTH + c], side))
                    return true;
            }
        }
        return false;
    }

private:
    cwi_boxes_node *node(int level, size_t slot)
    {
        return tree.nodes + tree.first[level] + slot / CWI_WIDTH;
    }

    // Widens the box of a child; returns true if it was too small.
    static bool grow(cwi_boxes_node *n, size_t slot, const float side[6])
    {
        bool grown = false;
        for (int k = 0; k < 3; k++) {
            float &low = n->low[k][slot % CWI_WIDTH], &high = n->high[k][slot % CWI_WIDTH];
            grown |= side[k] < low || side[k + 3] > high;
            low = std::min(low, side[k]);
            high = std::max(high, side[k + 3]);
        }
        return grown;
    }

    cwi_boxes tree = {};
    std::vector<uint32_t> slots;
};

} // namespace cw

#endif
