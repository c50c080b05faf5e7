#include "simplify/bound.hpp"

#include <cmath>

namespace cw
{

namespace
{

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

float triangle_square(const Vec &p, const Vec &a, const Vec &b, const Vec &c)
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

} // namespace

Bound::Bound(const cwi_block &block, const cwi_original *original_, double error_)
    : original(original_), error(float(error_))
{
    if (original && block.lists)
        heads.assign(block.lists, block.lists + block.own);
}

void Bound::collect(uint32_t face)
{
    for (uint32_t p = heads[face]; p != UINT32_MAX; p = original->next[p])
        points.push_back(p);
}

// The square of the distance that holds for all of the points; negative: nothing may change.
float Bound::allowed() const
{
    uint8_t care = 0;
    for (uint32_t p : points)
        care = std::max(care, original->care[p]);
    return care < CWI_MOST_CARE ? std::ldexp(error * error, -2 * care) : -1;
}

// From the triangles around the nearest point: a distance that is not too small.
bool Bound::is_near(const Vec &place, float square) const
{
    float least = INFINITY;
    uint32_t nearest = 0;
    for (uint32_t p : points) {
        const float s = (point(p) - place).sqrnorm();
        nearest = s < least ? p : nearest;
        least = std::min(least, s);
    }
    for (uint32_t i = original->first[nearest];
         i < original->first[nearest + 1] && least > square; i++) {
        const uint32_t *c = original->corners + 3 * size_t(original->around[i]);
        least = std::min(least, triangle_square(place, point(c[0]), point(c[1]), point(c[2])));
    }
    return least <= square;
}

// The square of the distance from the triangles of the star, and the nearest.
float Bound::square_from(const Star &star, const Vec &place, uint32_t *nearest)
{
    float least = INFINITY;
    for (size_t i = 0; i < star.spokes.size(); i++) {
        const Spoke &s = star.spokes[i];
        const float d = triangle_square(place, star.place, s.pa, s.pb);
        *nearest = d < least ? uint32_t(i) : *nearest;
        least = std::min(least, d);
    }
    return least;
}

// Whether every point is near a spoke.
bool Bound::are_listed(const Star &star, float square)
{
    for (uint32_t p : points) {
        uint32_t nearest = 0;
        if (square_from(star, point(p), &nearest) > square)
            return false;
        spoke_of.push_back(nearest);
    }
    return true;
}

void Bound::set_sides(const Star &star)
{
    const size_t count = star.spokes.size();
    sides.x.resize(count);
    sides.y.resize(count);
    sides.z.resize(count);
    sides.at.resize(count);
    for (size_t i = 0; i < count; i++) {
        const Vec side = star.spokes[i].pa - star.place;
        sides.x[i] = side[0];
        sides.y[i] = side[1];
        sides.z[i] = side[2];
    }
}

// Where an edge of the original, `way` from the moved vertex, comes nearest to the sides that
// it crosses, between the ends of both, but stays farther than allowed: its share there; else a
// negative number.
void Bound::find_crossings(const Vec &edge, const Vec &way, float square)
{
    const float *x = sides.x.data(), *y = sides.y.data(), *z = sides.z.data();
    const float ex = edge[0], ey = edge[1], ez = edge[2], wx = way[0], wy = way[1], wz = way[2],
                mx = wy * ez - wz * ey, my = wz * ex - wx * ez, mz = wx * ey - wy * ex;
    for (size_t k = 0; k < sides.at.size(); k++) {
        const float nx = ey * z[k] - ez * y[k], ny = ez * x[k] - ex * z[k],
                    nz = ex * y[k] - ey * x[k], n = nx * nx + ny * ny + nz * nz,
                    height = wx * nx + wy * ny + wz * nz,
                    // shares of the edge and of the side, times n
            s = -((wy * z[k] - wz * y[k]) * nx + (wz * x[k] - wx * z[k]) * ny +
                  (wx * y[k] - wy * x[k]) * nz),
                    t = -(mx * nx + my * ny + mz * nz);
        const bool crosses =
            (s > 0) & (s < n) & (t > 0) & (t < n) & (height * height > n * square);
        sides.at[k] = crosses ? s / n : -1;
    }
}

// Whether the original's edges at the points pass near the sides that they cross. Two lines may
// come nearest elsewhere than where the surfaces lie over each other: what seems far is
// measured from all of the other surface.
bool Bound::cross_near(const Star &star, float square)
{
    uint32_t nearest;
    set_sides(star);
    for (uint32_t p : points)
        for (uint32_t i = original->first[p]; i < original->first[p + 1]; i++) {
            const uint32_t *c = original->corners + 3 * size_t(original->around[i]);
            const uint32_t q = c[0] == p ? c[1] : c[1] == p ? c[2] : c[0];
            const Vec edge = point(q) - point(p);
            find_crossings(edge, point(p) - star.place, square);
            for (size_t k = 0; k < sides.at.size(); k++) {
                if (sides.at[k] < 0)
                    continue;
                const Vec on_edge = point(p) + sides.at[k] * edge,
                          side = star.spokes[k].pa - star.place,
                          on_side = star.place + share_near(on_edge - star.place, side) * side;
                if (square_from(star, on_edge, &nearest) > square || !is_near(on_side, square))
                    return false;
            }
        }
    return true;
}

bool Bound::is_kept(const Star &star)
{
    if (!is_asked())
        return true;
    points.clear();
    spoke_of.clear();
    for (uint32_t f : star.gone)
        collect(f);
    for (const Spoke &s : star.spokes)
        collect(s.face);
    const float square = allowed();
    return points.empty() || (is_near(star.place, square) && are_listed(star, square) &&
                              cross_near(star, square));
}

void Bound::change(const Star &star)
{
    if (!is_asked())
        return;
    for (uint32_t f : star.gone)
        heads[f] = UINT32_MAX;
    for (const Spoke &s : star.spokes)
        heads[s.face] = UINT32_MAX;
    for (size_t i = 0; i < points.size(); i++) {
        uint32_t &head = heads[star.spokes[spoke_of[i]].face];
        original->next[points[i]] = head;
        head = points[i];
    }
}

} // namespace cw
