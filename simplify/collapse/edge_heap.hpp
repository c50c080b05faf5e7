// Edges by cost, the least first.
#ifndef SIMPLIFY_COLLAPSE_EDGE_HEAP_HPP
#define SIMPLIFY_COLLAPSE_EDGE_HEAP_HPP

#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

namespace cw
{

// Heap with four children at each node. An entry is one number, its cost in the upper half:
// costs are not negative, so their bits are in order too, and equal ones are in order of their
// edges.
class Queue
{
public:
    static uint64_t entry(float cost, uint32_t edge)
    {
        uint32_t bits;
        std::memcpy(&bits, &cost, sizeof bits);
        return uint64_t(bits) << 32 | edge;
    }

    static uint32_t edge(uint64_t entry)
    {
        return uint32_t(entry);
    }

    static float cost(uint64_t entry)
    {
        const uint32_t bits = uint32_t(entry >> 32);
        float cost;
        std::memcpy(&cost, &bits, sizeof cost);
        return cost;
    }

    bool empty() const
    {
        return heap.empty();
    }

    uint64_t top() const
    {
        return heap.front();
    }

    void reserve(size_t count)
    {
        heap.reserve(count);
    }

    // Appends an entry; the heap has no order until build().
    void append(uint64_t e)
    {
        heap.push_back(e);
    }

    void build()
    {
        for (size_t i = heap.size() / 4 + 1; i-- > 0;)
            if (i < heap.size())
                sink(i, heap[i]);
    }

    void push(uint64_t e)
    {
        size_t i = heap.size();
        heap.push_back(e);
        for (; i && e < heap[(i - 1) / 4]; i = (i - 1) / 4)
            heap[i] = heap[(i - 1) / 4];
        heap[i] = e;
    }

    void pop()
    {
        const uint64_t last = heap.back();
        heap.pop_back();
        if (!heap.empty())
            sink(0, last);
    }

    void replace_top(uint64_t e)
    {
        sink(0, e);
    }

private:
    void sink(size_t i, uint64_t e)
    {
        const size_t count = heap.size();
        for (size_t child = 4 * i + 1; child < count; child = 4 * i + 1) {
            size_t best = child;
            for (size_t c = child + 1; c < child + 4 && c < count; c++)
                best = heap[c] < heap[best] ? c : best;
            if (e <= heap[best])
                break;
            heap[i] = heap[best];
            i = best;
        }
        heap[i] = e;
    }

    std::vector<uint64_t> heap;
};

} // namespace cw

#endif
