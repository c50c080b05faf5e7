// Bounds the distance between a simplified surface and its original, and refuses collapses
// beyond it.
#include "simplify/collapse/distance_bound.hpp"

#include "core/geometry/triangle_cover.h"

#include <algorithm>
#include <cmath>

namespace cw
{

namespace
{

// Triangles of a ring up to which every walk starts at the moved vertex. In larger ones the next
// triangle is near the end of the last walk: walks around a fan would be long.
const size_t NEARBY_RING = 192;

// Triangles of the original to cross for an edge, besides those that there are points for.
const size_t MIN_STEPS = 64;

// The share of a segment at which it is nearest to what lies `from` its start.
float share_near(const Vec &from, const Vec &along)
{
    const float length = along.sqrnorm();
    return length > 0 ? std::min(1.0f, std::max(0.0f, (from | along) / length)) : 0;
}

float segment_square(const Vec &from, const Vec &along)
{
    return (from - share_near(from, along) * along).sqrnorm();
}

float triangle_distance_sq(const Vec &p, const Vec &a, const Vec &b, const Vec &c)
{
    const Vec ab = b - a, ac = c - a, ap = p - a, n = ab % ac;
    const float area = n.sqrnorm(), in_c = (ab % ap) | n, in_b = (ap % ac) | n;
    if (area > 0 && in_b >= 0 && in_c >= 0 && in_b + in_c <= area) {
        const float height = ap | n;
        return height * height / area;
    }
    return std::min(std::min(segment_square(ap, ab), segment_square(ap, ac)),
                    segment_square(p - b, c - b));
}

// A walk on the original, and the triangles that it led to.
struct Passage {
    cwi_surface_walk walk;
    std::vector<uint32_t> passed; // some more than once
};

double find_passed(void *context, const double p[3], const float *facet[3])
{
    Passage *passage = static_cast<Passage *>(context);
    const double distance_sq = cwi_walk_to(&passage->walk, p);
    cwi_walk_facet(&passage->walk, passage->walk.at, facet);
    passage->passed.push_back(passage->walk.at);
    return distance_sq;
}

} // namespace

// Makes room for at most `max` numbers, of which half stays empty.
void Numbers::clear(size_t max_count)
{
    size_t size = 64;
    while (size < 2 * max_count)
        size *= 2;
    slots.assign(size, {UINT32_MAX, 0});
    count = 0;
}

uint32_t Numbers::of(uint32_t vertex, bool *fresh)
{
    const size_t mask = slots.size() - 1;
    size_t at = (vertex * 2654435769u >> 7) & mask;
    while (slots[at].vertex != UINT32_MAX && slots[at].vertex != vertex)
        at = (at + 1) & mask;
    *fresh = slots[at].vertex == UINT32_MAX;
    if (*fresh)
        slots[at] = {vertex, count++};
    return slots[at].number;
}

Bound::Bound(const cwi_mesh_block &block, const cwi_original *original_, double error_)
    : original(original_), error(float(error_)), trace(original_)
{
    if (!original || !block.nearest_points)
        return;
    requested = true;
    heads.assign(block.nearest_points, block.nearest_points + block.interior_count);
    marks.resize(block.interior_count);
    has_limits = original->allowed != nullptr;
    for (size_t f = 0; f < block.interior_count && !has_limits; f++)
        for (uint32_t p = heads[f]; p != UINT32_MAX && !has_limits; p = original->next[p])
            has_limits = original->tighten_level[p] > 0;
}

void Bound::collect(uint32_t face)
{
    for (uint32_t p = heads[face]; p != UINT32_MAX; p = original->next[p]) {
        __builtin_prefetch(original->fans.points + 3 * size_t(p));
        points.push_back(p);
    }
}

void Bound::collect(const OneRing &ring)
{
    points.clear();
    for (uint32_t f : ring.gone)
        collect(f);
    for (const RingTriangle &s : ring.triangles)
        collect(s.face);
}

// The distance that holds for all of the points; negative: nothing may change. Without a point
// nothing tells where the original is.
float Bound::allowed() const
{
    if (!has_limits)
        return points.empty() ? -1 : error;
    uint8_t tighten_level = points.empty() ? uint8_t(CWI_MAX_TIGHTEN_LEVEL) : 0;
    float min_distance = error;
    for (uint32_t p : points) {
        tighten_level = std::max(tighten_level, original->tighten_level[p]);
        if (original->allowed)
            min_distance = std::min(min_distance, original->allowed[p]);
    }
    return tighten_level < CWI_MAX_TIGHTEN_LEVEL ? std::ldexp(min_distance, -tighten_level)
                                                 : -1;
}

// Whether what is seen of the ring was about as even as one that is joined.
bool Bound::is_straight() const
{
    Vec mean(0);
    if (!original->normals)
        return true;
    for (uint32_t p : points)
        mean += Vec(original->normals + 3 * size_t(p));
    const float min_cosine = original->min_normal_cosine * mean.norm();
    for (uint32_t p : points) {
        const Vec normal(original->normals + 3 * size_t(p));
        if (normal.sqrnorm() > 0 && !((normal | mean) >= min_cosine))
            return false;
    }
    return true;
}

// From the triangles around the nearest point: a distance that is not too small.
bool Bound::is_near(const Vec &position, float distance_sq)
{
    float nearest_sq = INFINITY;
    uint32_t start = points[0];
    for (uint32_t p : points) {
        const float s = (point(p) - position).sqrnorm();
        start = s < nearest_sq ? p : start;
        nearest_sq = std::min(nearest_sq, s);
    }
    nearest_sq = INFINITY;
    for (uint32_t i = original->fans.first[start]; i < original->fans.first[start + 1]; i++) {
        const uint32_t t = original->fans.around[i], *c = corners(t);
        const float s = triangle_distance_sq(position, point(c[0]), point(c[1]), point(c[2]));
        nearest = s < nearest_sq ? t : nearest;
        nearest_sq = std::min(nearest_sq, s);
    }
    return nearest_sq <= distance_sq;
}

// Returns true if every point is near a ring triangle.
bool Bound::are_listed(const OneRing &ring, float distance)
{
    facets.clear(distance);
    triangle_of.clear();
    for (const RingTriangle &s : ring.triangles)
        facets.add(Vec(0), s.pa - ring.position, s.pb - ring.position);
    for (uint32_t p : points) {
        float distance_sq;
        triangle_of.push_back(uint32_t(facets.nearest(point(p) - ring.position, &distance_sq)));
        if (!(distance_sq <= distance * distance))
            return false;
    }
    return true;
}

// Returns true if the ring triangles, all or those in doubt, are near the original.
bool Bound::is_ring_near(const OneRing &ring, bool only_doubts, float distance)
{
    const double distance_sq = double(distance) * double(distance);
    Passage passage = {{&original->fans, distance_sq, nearest}, {}};
    cwi_cover cover = {find_passed, &passage, distance_sq, {}};
    for (size_t n = 0; n < ring.triangles.size(); n++) {
        const RingTriangle &s = ring.triangles[n];
        if (only_doubts && !trace.ring_in_doubt[n])
            continue;
        double corner[3][3];
        for (unsigned k = 0; k < 3; k++) {
            corner[0][k] = double(ring.position[k]);
            corner[1][k] = double(s.pa[k]);
            corner[2][k] = double(s.pb[k]);
        }
        if (ring.triangles.size() <= NEARBY_RING)
            passage.walk.at = nearest;
        if (!cwi_is_covered(&cover, corner))
            return false;
    }
    under.swap(passage.passed);
    std::sort(under.begin(), under.end());
    under.erase(std::unique(under.begin(), under.end()), under.end());
    return true;
}

void Bound::add_around(const Surface &surface, const OneRing &ring)
{
    mark++;
    for (uint32_t f : ring.gone)
        marks[f] = mark;
    for (const RingTriangle &s : ring.triangles)
        marks[s.face] = mark;
    for (const RingTriangle &s : ring.triangles)
        for (uint32_t v : {s.a, s.b})
            for (auto f = surface.cvf_iter(VertexHandle(int(v)));
                 f.is_valid() && !facets.is_full(); ++f) {
                uint32_t &last = marks[size_t(f->idx())];
                if (last == mark)
                    continue;
                last = mark;
                Vec corner[3];
                size_t n = 0;
                for (auto c = surface.cfv_iter(*f); c.is_valid(); ++c)
                    corner[n++] = surface.point(*c) - ring.position;
                facets.add(corner[0], corner[1], corner[2]);
            }
}

void Bound::see_points(const Vec &position)
{
    size_t max_numbers = 3 * under.size();
    bool fresh;
    for (uint32_t p : points)
        max_numbers += 1 + 2 * (original->fans.first[p + 1] - original->fans.first[p]);
    numbers.clear(max_numbers);
    seen.clear();
    for (uint32_t p : points) {
        numbers.of(p, &fresh);
        seen.push_back(facets.look(point(p) - position));
    }
}

// True, too, for a triangle with a point listed before the `first`: it was asked about then.
bool Bound::is_triangle_near(uint32_t triangle, uint32_t first, const Vec &position)
{
    uint32_t n[3];
    for (int k = 0; k < 3; k++) {
        bool fresh;
        const uint32_t p = corners(triangle)[k];
        n[k] = numbers.of(p, &fresh);
        if (fresh)
            seen.push_back(facets.look(point(p) - position));
    }
    return n[0] < first || n[1] < first || n[2] < first ||
           facets.are_near(seen[n[0]], seen[n[1]], seen[n[2]]);
}

bool Bound::is_original_near(const Surface &surface, const OneRing &ring)
{
    add_around(surface, ring);
    see_points(ring.position);
    for (uint32_t n = 0; n < points.size(); n++)
        for (uint32_t i = original->fans.first[points[n]];
             i < original->fans.first[points[n] + 1]; i++)
            if (!is_triangle_near(original->fans.around[i], n, ring.position))
                return false;
    for (uint32_t t : under)
        if (!is_triangle_near(t, uint32_t(points.size()), ring.position))
            return false;
    return true;
}

// Whether a place, seen from the moved vertex, is near the ring.
bool Bound::is_ring_at(const Vec &place, float distance) const
{
    float distance_sq;
    facets.nearest(place, &distance_sq);
    return distance_sq <= distance * distance;
}

// Folds of the original may stand out beside all edges of the ring, with points near it only. So
// middles of edges are looked at whose ends are both near.
void Bound::doubt_folds(const Vec &position, float distance)
{
    for (uint32_t p : points)
        for (uint32_t n = original->fans.first[p];
             original->folded[p] && n < original->fans.first[p + 1]; n++)
            for (const uint32_t q :
                 {original->across[2 * size_t(n)], original->across[2 * size_t(n) + 1]}) {
                const Vec end = point(q) - position,
                          middle = 0.5f * (point(p) - position + end);
                if (!is_ring_at(middle, distance) && is_ring_at(end, distance))
                    trace.triangles_in_doubt.push_back(original->fans.around[n]);
            }
}

// A trace may stray from the ring, as into the letters of a text: what it meets there need not be
// near the ring. So of the triangles in doubt only those stay that a point of the ring is at.
void Bound::forget_other_doubts()
{
    std::vector<uint32_t> &doubts = trace.triangles_in_doubt;
    bool fresh;
    numbers.clear(points.size() + 3 * doubts.size());
    for (uint32_t p : points)
        numbers.of(p, &fresh);
    const auto is_other = [&](uint32_t triangle) {
        const uint32_t *c = corners(triangle), count = uint32_t(points.size());
        return numbers.of(c[0], &fresh) >= count && numbers.of(c[1], &fresh) >= count &&
               numbers.of(c[2], &fresh) >= count;
    };
    doubts.erase(std::remove_if(doubts.begin(), doubts.end(), is_other), doubts.end());
}

// Whether the original's triangles in doubt are, and those under ring triangles in doubt.
bool Bound::are_doubts_near(const Surface &surface, const OneRing &ring)
{
    add_around(surface, ring);
    numbers.clear(3 * (trace.triangles_in_doubt.size() + under.size()));
    seen.clear();
    for (const std::vector<uint32_t> *triangles : {&trace.triangles_in_doubt, &under})
        for (uint32_t t : *triangles)
            if (!is_triangle_near(t, 0, ring.position))
                return false;
    return true;
}

// The exact bounds decide where crossing edges do not.
bool Bound::is_covered(const Surface &surface, const OneRing &ring, float distance)
{
    trace.compare(ring, nearest, distance, MIN_STEPS + 4 * points.size());
    if (trace.is_lost)
        return is_ring_near(ring, false, distance) && is_original_near(surface, ring);
    doubt_folds(ring.position, distance);
    if (trace.triangles_in_doubt.empty())
        return true;
    forget_other_doubts();
    return is_ring_near(ring, true, distance) && are_doubts_near(surface, ring);
}

// Runs the checks that refuse most for the least work first.
bool Bound::is_kept(const Surface &surface, const OneRing &ring)
{
    if (!is_requested())
        return true;
    collect(ring);
    const float distance = allowed();
    return distance > 0 && is_straight() && is_near(ring.position, distance * distance) &&
           are_listed(ring, distance) && is_covered(surface, ring, distance);
}

void Bound::change(const OneRing &ring)
{
    if (!is_requested())
        return;
    for (uint32_t f : ring.gone)
        heads[f] = UINT32_MAX;
    for (const RingTriangle &s : ring.triangles)
        heads[s.face] = UINT32_MAX;
    for (size_t i = 0; i < points.size(); i++) {
        uint32_t &head = heads[ring.triangles[triangle_of[i]].face];
        original->next[points[i]] = head;
        head = points[i];
    }
}

} // namespace cw
