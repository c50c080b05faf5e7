// Computes the distances of a point from four triangles at a time, and decides whether a
// triangle is near to several facets.
#include "simplify/collapse/triangle_packet.hpp"

#include "core/geometry/vec3.h"

#include <algorithm>
#include <cmath>

namespace cw
{

namespace
{

cwi_lanes choose(cwi_mask mask, cwi_lanes yes, cwi_lanes no)
{
    return cwi_lanes((cwi_mask(yes) & mask) | (cwi_mask(no) & ~mask));
}

cwi_lanes lesser(cwi_lanes a, cwi_lanes b)
{
    return choose(a < b, a, b);
}

cwi_lanes dot(const cwi_lanes a[3], const cwi_lanes b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// The square of the distance of what lies `from` the start of a segment.
cwi_lanes from_segment(const cwi_lanes from[3], const cwi_lanes along[3], cwi_lanes inverse)
{
    const cwi_lanes none = {0, 0, 0, 0}, one = {1, 1, 1, 1}, t = dot(from, along) * inverse,
                    fraction = lesser(choose(t > 0, t, none), one);
    const cwi_lanes displacement[3] = {from[0] - fraction * along[0],
                                       from[1] - fraction * along[1],
                                       from[2] - fraction * along[2]};
    return dot(displacement, displacement);
}

float inverse(double length_sq)
{
    return length_sq > 0 ? float(1 / length_sq) : 0;
}

} // namespace

// In double precision, as the normal of a sliver is a small difference. Without an area a
// triangle is its sides only; empty lanes are infinitely far.
void Facets::add(const Vec &a, const Vec &b, const Vec &c)
{
    const size_t lane = corners.size() % 4;
    if (lane == 0) {
        fours.emplace_back();
        fours.back().a[0] = cwi_lanes{INFINITY, INFINITY, INFINITY, INFINITY};
    }
    Four &f = fours.back();
    double ab[3], ac[3], bc[3], normal[3], to_b[3], to_c[3];
    for (unsigned k = 0; k < 3; k++) {
        ab[k] = double(b[k]) - double(a[k]);
        ac[k] = double(c[k]) - double(a[k]);
        bc[k] = ac[k] - ab[k];
    }
    cwi_cross(ab, ac, normal);
    cwi_cross(ac, normal, to_b);
    cwi_cross(normal, ab, to_c);
    const double normal_sq = cwi_dot(normal, normal), scale = normal_sq > 0 ? 1 / normal_sq : 0;
    for (unsigned k = 0; k < 3; k++) {
        f.a[k][lane] = a[k];
        f.ab[k][lane] = float(ab[k]);
        f.ac[k][lane] = float(ac[k]);
        f.bc[k][lane] = float(bc[k]);
        f.normal[k][lane] = float(std::sqrt(scale) * normal[k]);
        f.b_weight[k][lane] = float(scale * to_b[k]);
        f.c_weight[k][lane] = float(scale * to_c[k]);
    }
    f.ab_inverse[lane] = inverse(cwi_dot(ab, ab));
    f.ac_inverse[lane] = inverse(cwi_dot(ac, ac));
    f.bc_inverse[lane] = inverse(cwi_dot(bc, bc));
    f.max_sum[lane] = normal_sq > 0 ? 1 : -1;
    corners.push_back({a, b, c});
    for (const Vec &p : corners.back())
        reach = std::max(reach, p.norm());
}

cwi_lanes Facets::Four::distances_sq(const Vec &p) const
{
    cwi_lanes from_a[3], from_b[3];
    for (unsigned k = 0; k < 3; k++) {
        from_a[k] = p[k] - a[k];
        from_b[k] = from_a[k] - ab[k];
    }
    const cwi_lanes height = dot(from_a, normal), in_b = dot(from_a, b_weight),
                    in_c = dot(from_a, c_weight);
    const cwi_lanes sides = lesser(
        lesser(from_segment(from_a, ab, ab_inverse), from_segment(from_a, ac, ac_inverse)),
        from_segment(from_b, bc, bc_inverse));
    return choose((in_b >= 0) & (in_c >= 0) & (in_b + in_c <= max_sum), height * height, sides);
}

size_t Facets::nearest(const Vec &p, float *distance_sq) const
{
    cwi_lanes smallest = {INFINITY, INFINITY, INFINITY, INFINITY};
    cwi_mask four = {0, 0, 0, 0};
    for (size_t n = 0; n < fours.size(); n++) {
        const cwi_lanes distances_sq = fours[n].distances_sq(p);
        const cwi_mask is_less = distances_sq < smallest;
        smallest = choose(is_less, distances_sq, smallest);
        four = (int32_t(n) & is_less) | (four & ~is_less);
    }
    unsigned best = 0;
    for (unsigned l = 1; l < 4; l++)
        if (smallest[l] < smallest[best])
            best = l;
    *distance_sq = smallest[best];
    return 4 * size_t(four[best]) + best;
}

// Rounding errors are a few parts in 2^24 of the lengths between points.
Facets::Seen Facets::look(const Vec &p) const
{
    const float sure = distance - 1e-6f * (reach + p.norm());
    uint64_t near = 0;
    for (size_t n = 0; n < fours.size() && n < 16 && sure > 0; n++) {
        const cwi_mask is_near = fours[n].distances_sq(p) <= sure * sure,
                       bit = is_near & cwi_mask{1, 2, 4, 8};
        near |= uint64_t(bit[0] | bit[1] | bit[2] | bit[3]) << 4 * n;
    }
    return {p, near};
}

Facets::Seen Facets::between(const Seen &a, const Seen &b, float fraction) const
{
    return look(a.at + fraction * (b.at - a.at));
}

// A facet that is near all corners is near all of the triangle. Else it is cut along a side of
// a facet that is near some of them, two at best.
bool Facets::are_near(const Seen &a, const Seen &b, const Seen &c, int cuts) const
{
    const Seen corner[3] = {a, b, c};
    if (a.near & b.near & c.near)
        return true;
    if (!a.near || !b.near || !c.near || cuts == 0)
        return false;
    const uint64_t two = (a.near & b.near) | (b.near & c.near) | (c.near & a.near);
    for (uint64_t left = two ? two : a.near; left; left &= left - 1) {
        float height[3];
        const int lone = find_cut(corner, unsigned(__builtin_ctzll(left)), height);
        if (lone >= 0)
            return are_cut_near(corner, lone, height, cuts - 1);
    }
    return are_halves_near(corner, cuts - 1);
}

// Finds a side of a facet beyond which a corner lies that the facet is not near: heights above
// the plane through it, along the triangle's normal, and the corner that is alone on its side
// of that; negative if there is none.
int Facets::find_cut(const Seen corner[3], unsigned facet, float height[3]) const
{
    const Corners &f = corners[facet];
    const Vec normal = (corner[1].at - corner[0].at) % (corner[2].at - corner[0].at);
    for (unsigned side = 0; side < 3; side++) {
        Vec out = (f[(side + 1) % 3] - f[side]) % normal;
        if ((out | (f[(side + 2) % 3] - f[side])) > 0)
            out = -out;
        float high = 0, low = 0;
        int above = 0;
        bool helps = false;
        for (int k = 0; k < 3; k++) {
            height[k] = out | (corner[k].at - f[side]);
            high = std::max(high, height[k]);
            low = std::max(low, -height[k]);
            above += height[k] > 0;
            helps |= height[k] > 0 && !(corner[k].near >> facet & 1);
        }
        if (helps && std::min(high, low) > 1e-3f * std::max(high, low))
            for (int k = 0; k < 3; k++)
                if ((height[k] > 0) == (above == 1))
                    return k;
    }
    return -1;
}

bool Facets::are_cut_near(const Seen corner[3], int lone, const float height[3], int cuts) const
{
    const int i = (lone + 1) % 3, j = (lone + 2) % 3;
    const float own_height = height[lone];
    const Seen to_i = between(corner[lone], corner[i], own_height / (own_height - height[i])),
               to_j = between(corner[lone], corner[j], own_height / (own_height - height[j]));
    return are_near(corner[lone], to_i, to_j, cuts) &&
           are_near(to_i, corner[i], corner[j], cuts) && are_near(to_i, corner[j], to_j, cuts);
}

bool Facets::are_halves_near(const Seen corner[3], int cuts) const
{
    float longest = -1;
    int start = 0;
    for (int k = 0; k < 3; k++) {
        const float side_sq = (corner[(k + 1) % 3].at - corner[k].at).sqrnorm();
        start = side_sq > longest ? k : start;
        longest = std::max(longest, side_sq);
    }
    const Seen &a = corner[start], &b = corner[(start + 1) % 3], &c = corner[(start + 2) % 3],
               middle = between(a, b, 0.5f);
    return are_near(a, middle, c, cuts) && are_near(middle, b, c, cuts);
}

} // namespace cw
