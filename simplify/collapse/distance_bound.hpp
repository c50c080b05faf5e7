// The distance that a surface and its original keep.
#ifndef SIMPLIFY_COLLAPSE_DISTANCE_BOUND_HPP
#define SIMPLIFY_COLLAPSE_DISTANCE_BOUND_HPP

#include "simplify/collapse/star_overlay.hpp"
#include "simplify/collapse/triangle_packet.hpp"

namespace cw
{

// Numbers for vertices, in the order in which they come.
class Numbers
{
public:
    void clear(size_t max_count);

    // *fresh: it had none yet.
    uint32_t of(uint32_t vertex, bool *fresh);

private:
    struct Slot {
        uint32_t vertex, number;
    };

    std::vector<Slot> slots;
    uint32_t count;
};

// Each point of the original is listed with the triangle nearest to it. When a star changes,
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

    bool is_kept(const Surface &surface, const Star &star);
    void change(const Star &star);

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
    void collect(const Star &star);
    float allowed() const;
    bool is_straight() const;
    bool is_near(const Vec &position, float distance_sq);
    bool are_listed(const Star &star, float distance);
    bool is_star_near(const Star &star, uint32_t spokes, float distance);
    void add_around(const Surface &surface, const Star &star);
    void see_points(const Vec &position);
    bool is_triangle_near(uint32_t triangle, uint32_t first, const Vec &position);
    bool is_original_near(const Surface &surface, const Star &star);
    bool are_doubts_near(const Surface &surface, const Star &star);
    bool is_covered(const Surface &surface, const Star &star, float distance);

    const cwi_original *original;
    float error;
    bool requested = false;                 // also of a block without triangles
    std::vector<uint32_t> heads;            // first point of a face's list
    std::vector<uint32_t> points, spoke_of; // of the star; the nearest spoke
    Overlay overlay;
    std::vector<uint32_t> under;    // triangles of the original under the star
    uint32_t nearest;               // triangle of the original to the moved vertex
    Facets facets;                  // the star's, then those around, from its vertex
    Numbers numbers;                // of the points, then of others at their triangles
    std::vector<Facets::Seen> seen; // all of these
    std::vector<uint32_t> marks;    // faces of the star and around have the last number
    uint32_t mark = 0;
};

} // namespace cw

#endif
