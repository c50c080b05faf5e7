// Compares a ring with the original where their edges cross.
#include "simplify/collapse/ring_overlay.hpp"

#include <algorithm>
#include <cmath>
#include <new>

namespace cw
{

namespace
{

// The share of the distance for crossings: exact bounds decide about the rest.
const float STRICTER = 0.95f;

float clamp_fraction(float fraction)
{
    return std::min(1.0f, std::max(0.0f, fraction));
}

// Twice the area between two ways, seen along the axis.
float turn(const Vec &a, const Vec &b)
{
    return a[0] * b[1] - a[1] * b[0];
}

// The square of the distance between two edges.
float edges_distance_sq(const Vec &p, const Vec &q, const Vec &a, const Vec &b)
{
    const Vec u = q - p, v = b - a, w = p - a;
    const float uu = u | u, uv = u | v, vv = v | v, uw = u | w, vw = v | w,
                area = uu * vv - uv * uv;
    const float first = area > 1e-6f * uu * vv ? clamp_fraction((uv * vw - vv * uw) / area) : 0,
                t = vv > 0 ? clamp_fraction((uv * first + vw) / vv) : 0,
                s = uu > 0 ? clamp_fraction((uv * t - uw) / uu) : 0;
    return (w + s * u - t * v).sqrnorm();
}

} // namespace

Overlay::Overlay(const cwi_original *original_)
    : original(original_), numbers(nullptr, cwi_free), outer_numbers(nullptr, cwi_free)
{
    if (!original)
        return;
    const size_t triangles = original->fans.first[original->vertices] / 3;
    numbers.reset(
        static_cast<uint32_t *>(cwi_alloc_zeroed(original->vertices, sizeof(uint32_t))));
    outer_numbers.reset(static_cast<uint32_t *>(cwi_alloc_zeroed(triangles, sizeof(uint32_t))));
    if (!numbers || !outer_numbers)
        throw std::bad_alloc();
}

// Where triangles differ much in size, normals of length 1 may see a fan where areas do not.
bool Overlay::lay(const OneRing &star_)
{
    Vec by_area(0), even(0);
    ring = &star_;
    center = ring->position;
    if (!ring->closed || ring->triangles.size() > MAX_TRIANGLES)
        return false;
    for (const RingTriangle &s : ring->triangles)
        by_area += s.normal;
    if (lay_along(*ring, by_area))
        return true;
    for (const RingTriangle &s : ring->triangles)
        even += s.normal / s.normal.norm();
    return lay_along(*ring, even);
}

bool Overlay::lay_along(const OneRing &star_, Vec axis)
{
    const float length = axis.norm();
    if (!(length > 0))
        return false;
    axes[2] = axis / length;
    axes[0] =
        axes[2] % (std::abs(axes[2][0]) < std::abs(axes[2][1]) ? Vec(1, 0, 0) : Vec(0, 1, 0));
    axes[0].normalize();
    axes[1] = axes[2] % axes[0];
    corners_a.clear();
    corners_b.clear();
    fours.assign((star_.triangles.size() + 3) / 4, Four{});
    int rounds = 0;
    for (const RingTriangle &s : star_.triangles) {
        if (!add_triangle(s))
            return false;
        rounds += corners_a.back()[1] < 0 && corners_b.back()[1] >= 0;
    }
    return rounds == 1;
}

bool Overlay::add_triangle(const RingTriangle &s)
{
    const Vec to_a = s.pa - center, to_b = s.pb - center;
    const Vec a(to_a | axes[0], to_a | axes[1], to_a | axes[2]),
        b(to_b | axes[0], to_b | axes[1], to_b | axes[2]);
    const size_t lane = corners_a.size() % 4;
    Four &f = fours[corners_a.size() / 4];
    for (unsigned k = 0; k < 2; k++)
        f.ray[k][lane] = a[k];
    f.out[0][lane] = b[1] - a[1];
    f.out[1][lane] = a[0] - b[0];
    f.reach[lane] = turn(a, b);
    f.slope[0][lane] = (a[2] * b[1] - b[2] * a[1]) / turn(a, b);
    f.slope[1][lane] = (b[2] * a[0] - a[2] * b[0]) / turn(a, b);
    corners_a.push_back(a);
    corners_b.push_back(b);
    return turn(a, b) > 0;
}

uint32_t Overlay::locate(uint32_t vertex)
{
    uint32_t &number = numbers.get()[vertex];
    if (number < vertices.size() && vertices[number] == vertex)
        return number;
    number = uint32_t(vertices.size());
    const Vec displacement = Vec(original->fans.points + 3 * size_t(vertex)) - center;
    vertices.push_back(vertex);
    corners.push_back(
        {{displacement | axes[0], displacement | axes[1], displacement | axes[2]}, 0, 0, 0, 0});
    return number;
}

void Overlay::look(Corner &p) const
{
    for (size_t n = 0; n < fours.size(); n++) {
        const Four &f = fours[n];
        const cwi_mask left = f.ray[0] * p.at[1] >= f.ray[1] * p.at[0],
                       ahead = f.ray[0] * p.at[0] + f.ray[1] * p.at[1] > 0,
                       beyond = f.out[0] * p.at[0] + f.out[1] * p.at[1] > f.reach;
        const cwi_lanes height = p.at[2] - f.slope[0] * p.at[0] - f.slope[1] * p.at[1];
        const cwi_mask near = (height <= f.thickness) & (-height <= f.thickness);
        p.left |= cwi_mask_bits(&left) << 4 * n;
        p.ahead |= cwi_mask_bits(&ahead) << 4 * n;
        p.beyond |= cwi_mask_bits(&beyond) << 4 * n;
        p.near |= cwi_mask_bits(&near) << 4 * n;
    }
}

// Of the planes of the ring triangles, less what rounding may make of heights above them.
void Overlay::set_thickness(float sure, float reach)
{
    for (size_t n = 0; n < corners_a.size(); n++) {
        Four &f = fours[n / 4];
        const float steep = std::abs(f.slope[0][n % 4]) + std::abs(f.slope[1][n % 4]);
        f.thickness[n % 4] = sure - 2e-6f * reach * steep;
    }
}

void Overlay::locate_fans(uint32_t point_count)
{
    across.clear();
    for (uint32_t i = 0; i < point_count; i++) {
        const uint32_t *first = original->fans.first + vertices[i];
        for (const uint32_t *v = original->across + 2 * size_t(first[0]);
             v < original->across + 2 * size_t(first[1]); v++)
            across.push_back(locate(*v));
    }
    for (Corner &p : corners)
        look(p);
}

// Whether edges that cross, as seen along the axis, are near each other there; true, too, where
// only the lines cross.
bool Overlay::is_crossing_near(const Corner &p, const Corner &q, const Vec &a, const Vec &b,
                               bool *crosses) const
{
    const Vec along = b - a;
    const float from = turn(along, p.at - a), to = turn(along, q.at - a);
    if ((from < 0) == (to < 0))
        return true;
    const Vec c = p.at + from / (from - to) * (q.at - p.at) - a;
    const float fraction =
        (c[0] * along[0] + c[1] * along[1]) / (along[0] * along[0] + along[1] * along[1]);
    if (!(fraction >= 0 && fraction <= 1))
        return true;
    if (crosses)
        *crosses = true;
    return (c - fraction * along).sqrnorm() <= distance_sq ||
           edges_distance_sq(p.at, q.at, a, b) <= distance_sq;
}

// Those around a corner.
void Overlay::doubt_ring_triangles(uint32_t corner)
{
    for (size_t n = 0; n < ring->triangles.size(); n++)
        if (ring->triangles[n].a == corner || ring->triangles[n].b == corner)
            ring_triangles_in_doubt |= 1u << n;
}

// Those on both sides of an edge.
void Overlay::doubt_triangles(uint32_t from, uint32_t to)
{
    cwi_fans_choose_end(&original->fans, &from, &to);
    for (uint32_t n = original->fans.first[from]; n < original->fans.first[from + 1]; n++) {
        const uint32_t *c = original->fans.corners + 3 * size_t(original->fans.around[n]);
        if (c[0] == to || c[1] == to || c[2] == to)
            triangles_in_doubt.push_back(original->fans.around[n]);
    }
}

// Rays and sides are left out that the edge cannot cross: both ends are behind the center, beyond
// the outer side at the ray, or to the right of the side.
bool Overlay::is_edge_near(uint32_t i, uint32_t j, bool *crosses)
{
    const Corner &p = corners[i], &q = corners[j];
    const uint32_t flat = crosses ? 0 : p.near & q.near;
    bool near = true;
    for (uint32_t left =
             (p.left ^ q.left) & (p.ahead | q.ahead) & ~(p.beyond & q.beyond) & ~flat;
         left; left &= left - 1) {
        const unsigned n = unsigned(__builtin_ctz(left));
        if (is_crossing_near(p, q, Vec(0), corners_a[n], crosses))
            continue;
        near = false;
        doubt_ring_triangles(ring->triangles[n].a);
    }
    for (uint32_t left = (p.beyond ^ q.beyond) & (p.left | q.left) & ~(p.near & q.near); left;
         left &= left - 1) {
        const unsigned n = unsigned(__builtin_ctz(left));
        if (is_crossing_near(p, q, corners_a[n], corners_b[n], nullptr))
            continue;
        near = false;
        ring_triangles_in_doubt |= 1u << n;
    }
    return near;
}

// Whether one of three vertices has one of the first places.
bool Overlay::has_point(const uint32_t v[3], uint32_t point_count) const
{
    for (int k = 0; k < 3; k++) {
        const uint32_t number = numbers.get()[v[k]];
        if (number < point_count && vertices[number] == v[k])
            return true;
    }
    return false;
}

void Overlay::add_outer(uint32_t triangle)
{
    uint32_t &number = outer_numbers.get()[triangle];
    if (number < outer.size() && outer[number] == triangle)
        return;
    number = uint32_t(outer.size());
    outer.push_back(triangle);
}

// Adds the triangles on the other side of an edge, if no point is at them.
void Overlay::look_across(uint32_t i, uint32_t j, uint32_t point_count)
{
    uint32_t from = vertices[i], to = vertices[j];
    meets_wide_fan |=
        cwi_fan_is_wide(&original->fans, from) || cwi_fan_is_wide(&original->fans, to);
    cwi_fans_choose_end(&original->fans, &from, &to);
    for (uint32_t n = original->fans.first[from]; n < original->fans.first[from + 1]; n++) {
        const uint32_t t = original->fans.around[n],
                       *c = original->fans.corners + 3 * size_t(t);
        if ((c[0] == to || c[1] == to || c[2] == to) && !has_point(c, point_count))
            add_outer(t);
    }
}

// Each edge between two points is looked at from one of them. Returns the end of the fan's others.
const uint32_t *Overlay::compare_fan(uint32_t i, uint32_t point_count, const uint32_t *others)
{
    const uint32_t hub = vertices[i];
    for (uint32_t n = original->fans.first[hub]; n < original->fans.first[hub + 1]; n++) {
        const uint32_t j = *others++, k = *others++;
        bool crosses = false;
        if ((j >= point_count || j > i) && !is_edge_near(i, j, nullptr))
            doubt_triangles(hub, vertices[j]);
        if (j < point_count || k < point_count)
            continue;
        if (!is_edge_near(j, k, &crosses))
            triangles_in_doubt.push_back(original->fans.around[n]);
        else if (crosses)
            look_across(j, k, point_count);
    }
    return others;
}

void Overlay::compare_outer(uint32_t triangle, uint32_t point_count)
{
    const uint32_t *c = original->fans.corners + 3 * size_t(triangle);
    const size_t known = corners.size();
    for (int k = 0; k < 3; k++)
        locate(c[k]);
    for (size_t n = known; n < corners.size(); n++)
        look(corners[n]);
    for (int k = 0; k < 3; k++) {
        const uint32_t i = locate(c[k]), j = locate(c[(k + 1) % 3]);
        bool crosses = false;
        if (!is_edge_near(i, j, &crosses))
            triangles_in_doubt.push_back(triangle);
        else if (crosses)
            look_across(i, j, point_count);
    }
}

// Rounding errors are a few parts in 2^24 of the lengths between points.
bool Overlay::compare(const std::vector<uint32_t> &points, float distance)
{
    float reach = 0;
    for (const Vec &a : corners_a)
        reach = std::max(reach, a.sqrnorm());
    reach = std::sqrt(reach);
    const float sure = std::max(0.0f, STRICTER * distance - 2e-6f * reach);
    set_thickness(sure, reach);
    distance_sq = sure * sure;
    ring_triangles_in_doubt = 0;
    triangles_in_doubt.clear();
    vertices.clear();
    corners.clear();
    outer.clear();
    meets_wide_fan = false;
    for (uint32_t p : points) {
        locate(p);
        meets_wide_fan |= cwi_fan_is_wide(&original->fans, p);
    }
    if (meets_wide_fan)
        return false;
    const uint32_t point_count = uint32_t(points.size());
    locate_fans(point_count);
    const uint32_t *others = across.data();
    for (uint32_t i = 0; i < point_count; i++)
        others = compare_fan(i, point_count, others);
    for (size_t n = 0; n < outer.size() && !meets_wide_fan; n++)
        compare_outer(outer[n], point_count);
    return triangles_in_doubt.empty() && !meets_wide_fan;
}

} // namespace cw
