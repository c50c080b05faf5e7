// The distance that a surface and its original keep.
#ifndef SIMPLIFY_COLLAPSE_DISTANCE_BOUND_HPP
#define SIMPLIFY_COLLAPSE_DISTANCE_BOUND_HPP

#include "simplify/collapse/edge_trace.hpp"
#include "simplify/collapse/triangle_packet.hpp"

namespace cw
{

// Numbers vertices in the order in which they are met.
class Numbers
{
public:
    void clear(size_t max_count);

    // Returns the number of a vertex. *fresh: set to true if it had none yet.
    uint32_t of(uint32_t vertex, bool *fresh);

private:
    struct Slot {
        uint32_t vertex, number;
    };

    std::vector<Slot> slots;
    uint32_t count;
};

// Each point of the original is listed with the triangle nearest to it. When a ring changes,
// all of it must be near the original; and all triangles of the original at its points, or that
// it was found to lie over, near it or what is around it. Bounds decide both [Tang2009].
class Bound
{
public:
    Bound(const cwi_mesh_block &block, const cwi_original *original, double error);

    bool is_requested() const
    {
        return requested;
    }

    uint32_t list(uint32_t face) const
    {
        return heads[face];
    }

    bool is_kept(const Surface &surface, const OneRing &ring);
    void change(const OneRing &ring);

private:
    Vec point(uint32_t p) const
    {
        return Vec(original->fans.points + 3 * size_t(p));
    }

    const uint32_t *corners(uint32_t triangle) const
    {
        return original->fans.corners + 3 * size_t(triangle);
    }

    void collect(uint32_t face);
    void collect(const OneRing &ring);
    float allowed() const;
    bool is_straight() const;
    bool is_near(const Vec &position, float distance_sq);
    bool are_listed(const OneRing &ring, float distance);
    bool is_ring_near(const OneRing &ring, bool only_doubts, float distance);
    void add_around(const Surface &surface, const OneRing &ring);
    void see_points(const Vec &position);
    bool is_triangle_near(uint32_t triangle, uint32_t first, const Vec &position);
    bool is_original_near(const Surface &surface, const OneRing &ring);
    bool is_ring_at(const Vec &place, float distance) const;
    void doubt_folds(const Vec &position, float distance);
    void forget_other_doubts();
    bool are_doubts_near(const Surface &surface, const OneRing &ring);
    bool is_covered(const Surface &surface, const OneRing &ring, float distance);

    const cwi_original *original;
    float error;
    bool requested = false;                    // also of a block without triangles
    bool has_limits = false;                   // points with limits of their own are listed
    std::vector<uint32_t> heads;               // first point of a face's list
    std::vector<uint32_t> points, triangle_of; // of the ring; the nearest ring triangle
    EdgeTrace trace;
    std::vector<uint32_t> under;    // triangles of the original under the ring
    uint32_t nearest;               // triangle of the original to the moved vertex
    Facets facets;                  // the ring's, then those around, from its vertex
    Numbers numbers;                // of the points, then of others at their triangles
    std::vector<Facets::Seen> seen; // all of these
    std::vector<uint32_t> marks;    // faces of the ring and around have the last number
    uint32_t mark = 0;
};

} // namespace cw

#endif
