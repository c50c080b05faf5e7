// Conditions that a collapse must not break. Each check looks at the one-ring: the triangles around
// the edge as they are, and as they would be.
#ifndef SIMPLIFY_COLLAPSE_COLLAPSE_CHECKS_HPP
#define SIMPLIFY_COLLAPSE_COLLAPSE_CHECKS_HPP

#include "simplify/collapse/dynamic_bvh.hpp"
#include "simplify/collapse/halfedge_mesh.hpp"

#include "core/mesh/wide_fans.h"

#include <memory>
#include <vector>

namespace cw
{

// A triangle that stays, with the moved vertex for a corner and two others across from it.
struct RingTriangle {
    uint32_t face, a, b;
    Vec pa, pb;     // of a and b
    Vec old_normal; // these are not of unit length: twice the area
    Vec normal;
};

// Collapses around which more triangles would stay are not tried: their cost grows with the square
// of that number. The fan shrinks by collapses at its rim, and is tried then.
enum { MAX_RING = CWI_WIDE_FAN };

struct OneRing {
    // Returns true if at most MAX_RING triangles are around an edge.
    static bool is_small(const Surface &surface, HalfedgeHandle edge);

    // Collects the triangles around a halfedge whose start collapses into its end, which moves
    // to `to`.
    bool gather(const Surface &surface, HalfedgeHandle collapsed, const Vec &to);

    Box box(const RingTriangle &ring_triangle) const;

    uint32_t vertex; // that stays
    Vec position;
    Vec old[2];  // positions of both ends of the edge
    bool closed; // the triangles form a closed ring
    std::vector<RingTriangle> triangles;
    std::vector<uint32_t> gone; // triangles at the edge
};

// Checks that triangles keep their orientation and a good shape, and vertices their box.
class Shape
{
public:
    explicit Shape(const cwi_mesh_block &block)
        : low(Vec(block.low)), high(Vec(block.high)), along(Vec(block.along)), from(block.from),
          to(block.to)
    {
    }

    bool is_inside(const Vec &position) const;
    bool is_kept(const OneRing &ring) const;

private:
    Vec low, high, along;
    float from, to;
};

// Eight ring triangles side by side, for arithmetic on several at a time: their boxes, planes through
// the moved vertex, and planes through the sides across from it, facing outward. Doubts are
// what a point's height above a plane is wrong by at most, for a way of length 1.
struct Eight {
    cwi_boxes_node boxes;
    uint32_t a[8], b[8];
    float face[3][8], face_doubt[8];
    float side[3][8], side_height[8], side_doubt[8], reach[8];
};

// Checks that triangles which are not neighbours do not intersect.
class Contact
{
public:
    Contact(const cwi_mesh_block &block, const Surface &surface);

    bool arises(Surface &surface, const OneRing &ring);
    void change(const Surface &surface, const OneRing &ring); // it has become so

private:
    // Triangles around a vertex of very many: they are looked for by the directions in which they
    // are seen from it, until it moves.
    struct Fan {
        uint32_t hub;
        Vec center;
        Box around;                  // grows, and never shrinks
        std::vector<uint32_t> faces; // at first
        std::unique_ptr<Nearby> directions;
    };

    void build(const Surface &surface);
    void build_fans(const Surface &surface);
    static Box direction(const Fan &fan, const uint32_t id[3], const Vec at[3]);
    static Box direction(const Fan &fan, const OneRing &ring, const RingTriangle &s);
    bool meets_fans(const Surface &surface, const OneRing &ring, const Box &around) const;
    void release_fan(const Surface &surface, uint32_t fan);
    void remove(uint32_t face);
    void move(const OneRing &ring, const RingTriangle &moved);
    bool meets(const Surface &surface, const OneRing &ring, uint32_t face,
               const float box[6]) const;
    bool meets_others(const Surface &surface, const OneRing &ring, const Box &around) const;
    bool meets_others_avx2(const Surface &surface, const OneRing &ring,
                           const Box &around) const;
    bool find_others(const Surface &surface, const OneRing &ring, const Box &around) const;
    bool ring_meets_itself(const Surface &surface, const OneRing &ring) const;
    bool opens_like_a_fan(const OneRing &ring) const;

    size_t interior_count, live, built;
    std::vector<uint32_t> corners;  // of triangles, x 3: faster than a walk
    std::unique_ptr<Nearby> nearby; // triangles of no fan
    std::vector<Fan> fans;
    std::vector<uint32_t>
        fan_of; // triangles: their fan or CWI_NO_FAN; empty where there is none
    std::vector<uint32_t> marks; // faces of the ring have the last number
    uint32_t mark = 0;
    std::vector<Eight> triangles;
    bool has_avx2 = false;
};

} // namespace cw

#endif
