// Triangles side by side, for their distances from a point four at a time.
#ifndef SIMPLIFY_COLLAPSE_TRIANGLE_PACKET_HPP
#define SIMPLIFY_COLLAPSE_TRIANGLE_PACKET_HPP

#include "core/geometry/bvh.h"
#include "simplify/collapse/halfedge_mesh.hpp"

#include <array>
#include <vector>

namespace cw
{

// Places are relative to an origin among them: so single precision is enough.
class Facets
{
public:
    // A point and the facets that it is near: bit n, facet n. Of 64 at most.
    struct Seen {
        Vec at;
        uint64_t near;
    };

    // Returns true if no point would be looked at from further facets.
    bool is_full() const
    {
        return corners.size() >= 64;
    }

    void clear(float distance_)
    {
        distance = distance_;
        corners.clear();
        fours.clear();
        reach = 0;
    }

    void add(const Vec &a, const Vec &b, const Vec &c);

    // The facet nearest to a point, and the square of its distance.
    size_t nearest(const Vec &p, float *distance_sq) const;

    // Finds the facets that are not farther than the distance for certain.
    Seen look(const Vec &p) const;

    // Returns true if all of a triangle is near facets for certain.
    bool are_near(const Seen &a, const Seen &b, const Seen &c, int cuts = 10) const;

private:
    using Corners = std::array<Vec, 3>;

    // Four facets, seen from corner a. The dot products of a displacement from there with
    // b_weight and c_weight are the barycentric weights of b and c.
    struct Four {
        cwi_lanes a[3], ab[3], ac[3], bc[3], normal[3], b_weight[3], c_weight[3];
        cwi_lanes ab_inverse, ac_inverse, bc_inverse, max_sum;

        cwi_lanes distances_sq(const Vec &p) const;
    };

    Seen between(const Seen &a, const Seen &b, float fraction) const;
    int find_cut(const Seen corner[3], unsigned facet, float height[3]) const;
    bool are_cut_near(const Seen corner[3], int lone, const float height[3], int cuts) const;
    bool are_halves_near(const Seen corner[3], int cuts) const;

    float distance, reach; // no corner is farther from the origin
    std::vector<Corners> corners;
    std::vector<Four> fours;
};

} // namespace cw

#endif
