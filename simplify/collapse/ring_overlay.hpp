// A ring and the original below it, seen along the ring's normal.
#ifndef SIMPLIFY_COLLAPSE_RING_OVERLAY_HPP
#define SIMPLIFY_COLLAPSE_RING_OVERLAY_HPP

#include "core/geometry/bvh.h"
#include "simplify/collapse/collapse_checks.hpp"

#include <memory>

namespace cw
{

// Edges cut a ring and the original into common pieces. A piece of either is near the other if its
// corners are, as the distance from one triangle is convex [Tang2009]. Corners are vertices,
// which others look at, and places where edges cross.
class Overlay
{
public:
    explicit Overlay(const cwi_original *original);

    // Lays a ring out. Returns false if it does not open like a fan along its normal.
    bool lay(const OneRing &ring);

    // Compares edges of the original's triangles at points with edges of the ring that they
    // cross. Notes the triangles and the ring triangles at edges that are not within the distance for
    // certain. Returns true if all are. Stops at wide fans of the original:
    // meets_wide_fan is true then, and nothing is decided.
    bool compare(const std::vector<uint32_t> &points, float distance);

    bool meets_wide_fan;

    uint32_t ring_triangles_in_doubt;         // bit n: ring triangle n
    std::vector<uint32_t> triangles_in_doubt; // of the original

private:
    enum { MAX_TRIANGLES = 32 };

    // A vertex of the original in the ring's frame. Bit n: it is to the left of the ray to
    // corner a of ring triangle n, on its side of the center, beyond the outer side of ring triangle n, or near
    // the plane of ring triangle n, along the axis.
    struct Corner {
        Vec at;
        uint32_t left, ahead, beyond, near;
    };

    // Rays, outer sides and planes of four ring triangles.
    struct Four {
        cwi_lanes ray[2], out[2], reach, slope[2], thickness;
    };

    bool lay_along(const OneRing &ring, Vec axis);
    bool add_triangle(const RingTriangle &ring_triangle);
    uint32_t locate(uint32_t vertex);
    void look(Corner &corner) const;
    void set_thickness(float sure, float reach);
    void locate_fans(uint32_t point_count);
    bool is_edge_near(uint32_t i, uint32_t j, bool *crosses);
    const uint32_t *compare_fan(uint32_t i, uint32_t point_count, const uint32_t *others);
    void compare_outer(uint32_t triangle, uint32_t point_count);
    bool has_point(const uint32_t v[3], uint32_t point_count) const;
    void look_across(uint32_t i, uint32_t j, uint32_t point_count);
    void add_outer(uint32_t triangle);
    void doubt_triangles(uint32_t from, uint32_t to);
    bool is_crossing_near(const Corner &p, const Corner &q, const Vec &a, const Vec &b,
                          bool *crosses) const;
    void doubt_ring_triangles(uint32_t corner);

    const cwi_original *original;
    std::unique_ptr<uint32_t, void (*)(void *)>
        numbers; // vertices: their place, if it is theirs
    std::unique_ptr<uint32_t, void (*)(void *)>
        outer_numbers;              // triangles: their place in `outer`, if it is theirs
    std::vector<uint32_t> vertices; // that have a place
    std::vector<Corner> corners;
    std::vector<uint32_t> across; // places of the other corners of triangles at points
    std::vector<Four> fours;
    std::vector<uint32_t> outer; // triangles of the original across the ring, no point at them
    std::vector<Vec> corners_a, corners_b; // of the ring triangles
    Vec center, axes[3];                   // of the frame
    const OneRing *ring;
    float distance_sq; // of the distance
};

} // namespace cw

#endif
