// The edges of a one-ring from its moved vertex, followed on the original below them.
#ifndef SIMPLIFY_COLLAPSE_EDGE_TRACE_HPP
#define SIMPLIFY_COLLAPSE_EDGE_TRACE_HPP

#include "simplify/collapse/collapse_checks.hpp"

#include <vector>

namespace cw
{

// Edges cut a ring and the original into common pieces. A piece of either is near the other if its
// corners are, as the distance from one triangle is convex [Tang2009]. Corners are vertices,
// which others look at, and places where edges cross. The ring's outer edges were compared when
// they were made, and have not changed. So what is left are the edges from the moved vertex: a
// plane through each cuts the original along a line, which is followed from triangle to triangle.
class EdgeTrace
{
public:
    explicit EdgeTrace(const cwi_original *original_) : original(original_)
    {
    }

    // Follows all edges of a ring. Notes the triangles of both at places that are not within the
    // distance for certain. Returns true if all are.
    // start      triangle of the original that is nearest to the moved vertex
    // max_steps  triangles to cross for one edge; then it is lost
    bool compare(const OneRing &ring, uint32_t start, float distance, size_t max_steps);

    // An edge led nowhere, or the ring has a border: nothing is decided then.
    bool is_lost;

    std::vector<uint8_t> ring_in_doubt;       // for each of the ring's triangles
    std::vector<uint32_t> triangles_in_doubt; // of the original

private:
    enum Result { NEAR, IN_DOUBT, LOST };

    // A vertex of the original, seen from the moved vertex, and its height above the plane.
    struct Corner {
        uint32_t vertex;
        Vec at;
        float height;
    };

    // The edge that is followed, and where that is now: it leaves triangle `at` between two
    // corners, on both sides of the plane, in the triangle's order.
    struct Trace {
        Vec along, normal;
        float inverse_length_sq, offset;
        uint32_t at;
        Corner from, to;
        Vec crossing;
    };

    Corner look(const Trace &trace, uint32_t vertex) const;
    static float distance_from_edge(const Trace &trace, const Vec &last, float fraction);
    void find_inside(uint32_t start);
    bool begin(Trace &trace, uint32_t start, bool ahead) const;
    bool cross(Trace &trace) const;
    Result follow(Trace &trace, size_t max_steps);
    Result compare_edge(const OneRing &ring, size_t n, size_t before, uint32_t start,
                        size_t max_steps);

    const cwi_original *original;
    Vec center, inside; // the moved vertex; a point of the start, seen from there
    float distance_sq;
};

} // namespace cw

#endif
