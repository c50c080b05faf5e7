// Follows the edges of a one-ring on the original.
#include "simplify/collapse/edge_trace.hpp"

#include <algorithm>
#include <cmath>

namespace cw
{

namespace
{

// The fraction of the distance for crossings: exact bounds decide about the rest.
const float STRICTER = 0.95f;

// Where two corners are on both sides of a plane.
Vec find_crossing(const Vec &a, float height_a, const Vec &b, float height_b)
{
    return a + height_a / (height_a - height_b) * (b - a);
}

// The ring triangle that ends where another one begins. Most stand one behind the other.
size_t find_before(const OneRing &ring, size_t n)
{
    const uint32_t corner = ring.triangles[n].a;
    size_t before = n ? n - 1 : ring.triangles.size() - 1;
    if (ring.triangles[before].b != corner)
        for (before = 0; before < ring.triangles.size(); before++)
            if (ring.triangles[before].b == corner)
                break;
    return before;
}

Vec unit(const Vec &normal)
{
    const float length = normal.norm();
    return length > 0 ? normal / length : Vec(0);
}

// Distances by which a trace may begin beside its edge.
const float MAX_SHIFT = 0.05f;

// Triangles around a vertex that are searched without a look at the side's other end.
const uint32_t SMALL_FAN = 12;

// Distances from an edge, squared, over that allowed, beyond which it is not followed.
const float FAR_SQ = 4;

} // namespace

EdgeTrace::Corner EdgeTrace::look(const Trace &trace, uint32_t vertex) const
{
    const Vec at = Vec(original->fans.points + 3 * size_t(vertex)) - center;
    return {vertex, at, (trace.normal | at) - trace.offset};
}

// The square of the distance between the edge and where the trace is; or between its end and where
// the trace passes that, or last was, as the original may turn away at a crease.
float EdgeTrace::distance_from_edge(const Trace &trace, const Vec &last, float fraction)
{
    if (fraction < 1)
        return (trace.crossing - std::max(0.0f, fraction) * trace.along).sqrnorm();
    const float before = (last | trace.along) * trace.inverse_length_sq;
    const Vec above =
        before < 1 ? last + (1 - before) / (fraction - before) * (trace.crossing - last) : last;
    return std::min((last - trace.along).sqrnorm(), (above - trace.along).sqrnorm());
}

// A point of the triangle near the moved vertex, but off its sides: each plane through it cuts it.
void EdgeTrace::find_inside(uint32_t start)
{
    const uint32_t *v = original->fans.corners + 3 * size_t(start);
    double weights[3];
    const double p[3] = {double(center[0]), double(center[1]), double(center[2])};
    const float *const points = original->fans.points;
    cwi_facet_nearest(points + 3 * size_t(v[0]), points + 3 * size_t(v[1]),
                      points + 3 * size_t(v[2]), p, weights);
    Vec foot(0), middle(0);
    for (int k = 0; k < 3; k++) {
        const Vec corner = Vec(points + 3 * size_t(v[k])) - center;
        foot += float(weights[k]) * corner;
        middle += corner / 3;
    }
    const float way = (middle - foot).norm(), max_way = MAX_SHIFT * std::sqrt(distance_sq);
    inside = foot + std::min(0.02f, way > 0 ? max_way / way : 0) * (middle - foot);
}

// Stands in the first triangle, at the side through which the edge leaves it, as triangles wind, or
// at that where it comes from. So what lies ahead is clear on steep triangles, too.
bool EdgeTrace::begin(Trace &trace, uint32_t start, bool ahead) const
{
    const uint32_t *v = original->fans.corners + 3 * size_t(start);
    const Corner corner[3] = {look(trace, v[0]), look(trace, v[1]), look(trace, v[2])};
    trace.at = start;
    for (int k = 0; k < 3; k++) {
        const Corner &from = corner[k], &to = corner[(k + 1) % 3];
        if ((from.height < 0) == (to.height < 0) || (to.height < 0) != ahead)
            continue;
        trace.from = from;
        trace.to = to;
        trace.crossing = find_crossing(from.at, from.height, to.at, to.height);
        return true;
    }
    return false;
}

// Goes to the triangle across the side. Returns false if there is not exactly one, or both ends
// are hubs of wide fans.
bool EdgeTrace::cross(Trace &trace) const
{
    const cwi_fans &fans = original->fans;
    uint32_t hub = trace.from.vertex, other = trace.to.vertex, found = UINT32_MAX, third = 0;
    if (fans.first[hub + 1] - fans.first[hub] > SMALL_FAN)
        cwi_fans_choose_end(&fans, &hub, &other);
    if (cwi_fan_is_wide(&fans, hub))
        return false;
    const uint32_t first = fans.first[hub], end = fans.first[hub + 1];
    const uint32_t *pair = original->across + 2 * size_t(first);
    const unsigned side =
        hub == trace.from.vertex; // the other triangle has them in turned order
    for (uint32_t n = first; n < end; n++, pair += 2) {
        if (pair[side] != other)
            continue;
        if (found != UINT32_MAX)
            return false;
        found = fans.around[n];
        third = pair[1 - side];
    }
    if (found == UINT32_MAX)
        return false;
    const Corner next = look(trace, third);
    trace.at = found;
    ((next.height < 0) == (trace.from.height < 0) ? trace.from : trace.to) = next;
    trace.crossing =
        find_crossing(trace.from.at, trace.from.height, trace.to.at, trace.to.height);
    return true;
}

// Follows an edge from where it begins until it has passed its end, or is so far away that exact
// bounds have to tell. The original's triangles at such places are in doubt.
EdgeTrace::Result EdgeTrace::follow(Trace &trace, size_t max_steps)
{
    Vec last = inside;
    bool is_near = true;
    for (size_t step = 0; step < max_steps; step++) {
        const float fraction = (trace.crossing | trace.along) * trace.inverse_length_sq,
                    gap_sq = distance_from_edge(trace, last, fraction);
        const bool is_far = !(gap_sq <= distance_sq);
        if (fraction >= 1 && !is_far)
            return is_near ? NEAR : IN_DOUBT;
        const uint32_t left = trace.at;
        last = trace.crossing;
        is_near &= !is_far;
        if (!cross(trace))
            return LOST;
        if (is_far)
            triangles_in_doubt.insert(triangles_in_doubt.end(), {left, trace.at});
        if (is_far && (fraction >= 1 || !(gap_sq <= FAR_SQ * distance_sq)))
            return IN_DOUBT;
    }
    return LOST;
}

// Follows the edge between two ring triangles. Where the original turns back, as at the tip of a
// flap, what lies ahead is not clear: both sides of the first triangle are tried.
EdgeTrace::Result EdgeTrace::compare_edge(const OneRing &ring, size_t n, size_t before,
                                          uint32_t start, size_t max_steps)
{
    Trace trace;
    const Vec axis = unit(ring.triangles[n].normal) + unit(ring.triangles[before].normal);
    const size_t known = triangles_in_doubt.size();
    trace.along = ring.triangles[n].pa - center;
    trace.normal = trace.along % axis;
    trace.offset = trace.normal | inside;
    trace.inverse_length_sq = 1 / trace.along.sqrnorm();
    for (const bool ahead : {true, false}) {
        const Result result = begin(trace, start, ahead) ? follow(trace, max_steps) : LOST;
        if (result == LOST)
            return LOST;
        if (result == NEAR) {
            triangles_in_doubt.resize(known);
            return NEAR;
        }
    }
    ring_in_doubt[n] = ring_in_doubt[before] = 1;
    return IN_DOUBT;
}

// Rounding errors are a few parts in 2^24 of the lengths between points.
bool EdgeTrace::compare(const OneRing &ring, uint32_t start, float distance, size_t max_steps)
{
    float reach_sq = 0;
    for (const RingTriangle &s : ring.triangles)
        reach_sq = std::max(reach_sq, (s.pa - ring.position).sqrnorm());
    const float sure = std::max(0.0f, STRICTER * distance - 2e-6f * std::sqrt(reach_sq));
    distance_sq = sure * sure;
    center = ring.position;
    ring_in_doubt.assign(ring.triangles.size(), 0);
    triangles_in_doubt.clear();
    is_lost = !ring.closed;
    if (is_lost)
        return false;
    find_inside(start);
    for (size_t n = 0; n < ring.triangles.size() && !is_lost; n++) {
        const size_t before = find_before(ring, n);
        is_lost = before == ring.triangles.size() ||
                  compare_edge(ring, n, before, start, max_steps) == LOST;
    }
    return !is_lost && triangles_in_doubt.empty();
}

} // namespace cw
