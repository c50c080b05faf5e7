// The distance that a surface and its original keep.
#ifndef SIMPLIFY_BOUND_HPP
#define SIMPLIFY_BOUND_HPP

#include "simplify/checks.hpp"

namespace cw
{

// Laid over each other, as seen along their normals, the two surfaces are farthest apart in a
// corner of what their edges draw: in a vertex of one, or where an edge of one crosses one of
// the other [Cohen1997]. Vertices are measured to the nearest triangles of the other, crossings
// between the two lines. Each point of the original is listed with the triangle nearest to it.
class Bound
{
public:
    Bound(const cwi_block &block, const cwi_original *original, double error);

    bool is_asked() const
    {
        return !heads.empty();
    }

    uint32_t list(uint32_t face) const
    {
        return heads[face];
    }

    bool is_kept(const Star &star);
    void change(const Star &star);

private:
    // Sides from the moved vertex, for arithmetic on several at a time.
    struct Sides {
        std::vector<float> x, y, z, at;
    };

    Vec point(uint32_t p) const
    {
        return Vec(original->points + 3 * size_t(p));
    }

    void collect(uint32_t face);
    float allowed() const;
    bool is_near(const Vec &place, float square) const;
    bool are_listed(const Star &star, float square);
    static float square_from(const Star &star, const Vec &place, uint32_t *nearest);
    void set_sides(const Star &star);
    void find_crossings(const Vec &edge, const Vec &way, float square);
    bool cross_near(const Star &star, float square);

    const cwi_original *original;
    float error;
    std::vector<uint32_t> heads;            // first point of a face's list
    std::vector<uint32_t> points, spoke_of; // of the star; the nearest spoke
    Sides sides;
};

} // namespace cw

#endif
