// Keeps the charts of a texture while edges collapse.
#include "simplify/collapse/texture_charts.hpp"

#include "core/geometry/point_triangle.h"

#include <algorithm>
#include <cmath>

namespace cw
{

namespace
{

// Boxes of outlines that are visited for one collapse. Where more are in the way, it is refused.
const size_t MAX_VISITS = 4096;

bool is_same(const Place &a, const Place &b)
{
    return a[0] == b[0] && a[1] == b[1];
}

// Twice the signed area of a triangle in the texture.
double area_of(const Place &a, const Place &b, const Place &c)
{
    return (double(b[0]) - double(a[0])) * (double(c[1]) - double(a[1])) -
           (double(b[1]) - double(a[1])) * (double(c[0]) - double(a[0]));
}

double length_sq(const Place &a, const Place &b)
{
    const double x = double(b[0]) - double(a[0]), y = double(b[1]) - double(a[1]);
    return x * x + y * y;
}

bool are_apart(double a, double b)
{
    return (a > 0 && b < 0) || (a < 0 && b > 0);
}

// Segments that touch do not cross.
bool do_cross(const Place &a, const Place &b, const Place &c, const Place &d)
{
    return are_apart(area_of(a, b, c), area_of(a, b, d)) &&
           are_apart(area_of(c, d, a), area_of(c, d, b));
}

bool is_inside(const Place &p, const Place &a, const Place &b, const Place &c)
{
    const double in_c = area_of(a, b, p), in_a = area_of(b, c, p), in_b = area_of(c, a, p);
    return (in_a > 0 && in_b > 0 && in_c > 0) || (in_a < 0 && in_b < 0 && in_c < 0);
}

void add(Box &box, const Place &p)
{
    box.add(Vec(p[0], p[1], 0));
}

HalfedgeHandle previous(const Surface &surface, HalfedgeHandle h)
{
    return surface.next_halfedge_handle(surface.next_halfedge_handle(h));
}

} // namespace

TextureCharts::TextureCharts(const cwi_mesh_block &block, const Surface &surface, double error)
    : holds_seams(block.holds_seams)
{
    if (!block.texture)
        return;
    corners.resize(3 * block.interior_count);
    for (size_t c = 0; c < corners.size(); c++)
        corners[c] = {block.corners[c],
                      NONE,
                      {block.texture[2 * c] + 0.0f, block.texture[2 * c + 1] + 0.0f}};
    seams.assign(block.vertices, 0);
    const double side = double(block.texture_scale);
    if (error > 0 && side > 0)
        max_move_sq = error / side * (error / side);
    find_seams(surface);
    if (!holds_seams)
        build_outlines();
}

size_t TextureCharts::find_corner(uint32_t face, uint32_t vertex) const
{
    const size_t c = 3 * size_t(face);
    return corners[c].vertex == vertex ? c : corners[c + 1].vertex == vertex ? c + 1 : c + 2;
}

size_t TextureCharts::next(size_t corner)
{
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

void TextureCharts::find_seams(const Surface &surface)
{
    for (int i = 0; i < int(surface.n_halfedges()); i += 2) {
        const HalfedgeHandle h(i), back = surface.opposite_halfedge_handle(h);
        const FaceHandle f = surface.face_handle(h), g = surface.face_handle(back);
        const auto u = uint32_t(surface.from_vertex_handle(h).idx()),
                   v = uint32_t(surface.to_vertex_handle(h).idx());
        if (f.is_valid() && g.is_valid() &&
            is_same(at(uint32_t(f.idx()), u), at(uint32_t(g.idx()), u)) &&
            is_same(at(uint32_t(f.idx()), v), at(uint32_t(g.idx()), v)))
            continue;
        for (const uint32_t w : {u, v})
            seams[w] = uint8_t(std::min(3, seams[w] + 1));
        for (const HalfedgeHandle side : {h, back})
            if (surface.face_handle(side).is_valid()) {
                const size_t c = find_corner(uint32_t(surface.face_handle(side).idx()),
                                             uint32_t(surface.from_vertex_handle(side).idx()));
                corners[c].outline = uint32_t(sides.size());
                sides.push_back(c);
            }
    }
}

void TextureCharts::ends_of(uint32_t outline, Place &a, Place &b) const
{
    a = corners[sides[outline]].place;
    b = corners[next(sides[outline])].place;
}

// Puts the sides that are left into a tree. Returns false where one is not finite.
bool TextureCharts::plant_outlines()
{
    std::vector<uint32_t> numbers;
    std::vector<Box> boxes;
    for (uint32_t n = 0; n < sides.size(); n++) {
        Place a, b;
        Box box;
        if (corners[sides[n]].outline != n)
            continue;
        ends_of(n, a, b);
        for (const Place &p : {a, b}) {
            if (!std::isfinite(p[0]) || !std::isfinite(p[1]))
                return false;
            add(box, p);
        }
        numbers.push_back(n);
        boxes.push_back(box);
    }
    outlines = std::make_unique<Nearby>(numbers, boxes, sides.size());
    planted = live = numbers.size();
    return true;
}

void TextureCharts::build_outlines()
{
    if (!plant_outlines() || overlap_at_first())
        outlines.reset();
}

// Charts that overlap at first, as those of mirrored or repeated textures do, may go on so. Charts lie on
// one side of their outlines, so that the same side in the same direction belongs to two that overlap.
bool TextureCharts::overlap_at_first() const
{
    size_t visits = 0;
    for (uint32_t n = 0; n < sides.size(); n++) {
        Place a, b;
        Box box;
        ends_of(n, a, b);
        const double turn = area_of(a, b, corners[next(next(sides[n]))].place);
        add(box, a);
        add(box, b);
        const bool found = outlines->any(box, [&](uint32_t other, const float *) {
            Place c, d;
            ends_of(other, c, d);
            const double other_turn = area_of(c, d, corners[next(next(sides[other]))].place);
            const bool are_alike = (turn > 0) == (other_turn > 0);
            return ++visits > MAX_VISITS + 64 * sides.size() ||
                   (other != n &&
                    (do_cross(a, b, c, d) || (are_alike ? is_same(a, c) && is_same(b, d)
                                                        : is_same(a, d) && is_same(b, c))));
        });
        if (found)
            return true;
    }
    return false;
}

bool TextureCharts::is_seam(const Surface &surface, HalfedgeHandle h) const
{
    const FaceHandle f = surface.face_handle(h);
    return !f.is_valid() || corners[find_corner(uint32_t(f.idx()),
                                                uint32_t(surface.from_vertex_handle(h).idx()))]
                                    .outline != NONE;
}

TextureCharts::Target TextureCharts::target(const Surface &surface, HalfedgeHandle h) const
{
    const unsigned at_start = seams[size_t(surface.from_vertex_handle(h).idx())],
                   at_end = seams[size_t(surface.to_vertex_handle(h).idx())];
    if (at_start == 0 || at_end == 0)
        return at_start ? AT_START : at_end ? AT_END : ANYWHERE;
    if (holds_seams || !is_seam(surface, h))
        return NOWHERE;
    return at_start == 2 && at_end == 2 ? ANYWHERE
           : at_start == 2              ? AT_END
           : at_end == 2                ? AT_START
                                        : NOWHERE;
}

// --- the places after a collapse -----------------------------------------------------------

// Marks triangles around the start of a half-edge, from its own up to the next seam.
void TextureCharts::mark_side(const Surface &surface, HalfedgeHandle h)
{
    for (HalfedgeHandle at = h; surface.face_handle(at).is_valid();) {
        marked.push_back(uint32_t(surface.face_handle(at).idx()));
        at = surface.opposite_halfedge_handle(previous(surface, at));
        if (at == h || is_seam(surface, at))
            break;
    }
}

// The two other sides of a triangle that vanishes become one edge: it cannot be two seams.
bool TextureCharts::loses_chart(const Surface &surface, HalfedgeHandle h) const
{
    return surface.face_handle(h).is_valid() &&
           is_seam(surface, surface.next_halfedge_handle(h)) &&
           is_seam(surface, previous(surface, h));
}

// Finds the place of the nearest point of the ring as it was.
Place TextureCharts::interpolate(const Surface &surface, const OneRing &ring) const
{
    const double point[3] = {double(ring.position[0]), double(ring.position[1]),
                             double(ring.position[2])};
    double best = INFINITY;
    Place place = {};
    const auto look = [&](uint32_t face) {
        const Corner *c = &corners[3 * size_t(face)];
        Vec p[3];
        for (int k = 0; k < 3; k++)
            p[k] = surface.point(VertexHandle(int(c[k].vertex)));
        const double distance_sq =
            cwi_facet_distance_sq(p[0].data(), p[1].data(), p[2].data(), point);
        if (!(distance_sq < best))
            return;
        double weights[3];
        best = distance_sq;
        cwi_facet_nearest(p[0].data(), p[1].data(), p[2].data(), point, weights);
        for (size_t i = 0; i < 2; i++)
            place[i] =
                float(weights[0] * double(c[0].place[i]) + weights[1] * double(c[1].place[i]) +
                      weights[2] * double(c[2].place[i]));
    };
    for (const uint32_t f : ring.gone)
        look(f);
    for (const RingTriangle &s : ring.triangles)
        look(s.face);
    return place;
}

// The place of the target, on both sides of a seam.
void TextureCharts::find_places(const Surface &surface, HalfedgeHandle h, const OneRing &ring)
{
    const auto u = uint32_t(surface.from_vertex_handle(h).idx()),
               v = uint32_t(surface.to_vertex_handle(h).idx());
    const HalfedgeHandle side[2] = {h, surface.opposite_halfedge_handle(h)};
    const Vec along = ring.old[1] - ring.old[0];
    const float length_sq = along.sqrnorm(),
                fraction =
                    length_sq > 0 ? ((ring.position - ring.old[0]) | along) / length_sq : 0.5f,
                t = end == AT_START ? 0.0f
                    : end == AT_END ? 1.0f
                                    : std::min(1.0f, std::max(0.0f, fraction));
    for (int s = 0; s < 2; s++) {
        const FaceHandle f = surface.face_handle(side[s]);
        if (!f.is_valid())
            continue;
        old_places[s][0] = at(uint32_t(f.idx()), u);
        old_places[s][1] = at(uint32_t(f.idx()), v);
        for (size_t k = 0; k < 2; k++)
            places[s][k] = t == 0   ? old_places[s][0][k]
                           : t == 1 ? old_places[s][1][k]
                                    : old_places[s][0][k] +
                                          t * (old_places[s][1][k] - old_places[s][0][k]);
    }
    if (end == ANYWHERE && !along_seam)
        places[0] = places[1] = interpolate(surface, ring);
}

void TextureCharts::list_moves(const Surface &surface, HalfedgeHandle h, const OneRing &ring)
{
    const auto u = uint32_t(surface.from_vertex_handle(h).idx());
    marked.clear();
    moves.clear();
    if (along_seam) {
        mark_side(surface, h);
        mark_side(surface, surface.opposite_halfedge_handle(h));
    }
    for (const RingTriangle &s : ring.triangles) {
        const Corner *c = &corners[3 * size_t(s.face)];
        const bool at_start = c[0].vertex == u || c[1].vertex == u || c[2].vertex == u,
                   is_marked = std::find(marked.begin(), marked.end(), s.face) != marked.end(),
                   is_second = along_seam && is_marked != at_start;
        const size_t corner = find_corner(s.face, at_start ? u : ring.vertex);
        const bool stays = end == (at_start ? AT_START : AT_END);
        moves.push_back({corner, is_second, stays ? corners[corner].place : places[is_second]});
    }
}

// Needles may stay, and get wider.
bool TextureCharts::turns_over(const Move &move) const
{
    const Place &old = corners[move.corner].place, &a = corners[next(move.corner)].place,
                &b = corners[next(next(move.corner))].place;
    const double before = area_of(old, a, b), now = area_of(move.to, a, b);
    if (is_same(old, move.to) || before == 0)
        return false;
    const double longest =
        std::max(length_sq(a, b), std::max(length_sq(move.to, a), length_sq(move.to, b)));
    return !(before > 0 ? now > 0 : now < 0) ||
           (std::abs(now) < 1e-5 * longest && std::abs(now) < std::abs(before));
}

// Finds how far the place of one of the edge's ends is, on one side of the edge, from that of the nearest
// point of the ring to be.
double TextureCharts::stray_sq(const OneRing &ring, int which_end, bool side) const
{
    const Vec &old = ring.old[which_end];
    const double point[3] = {double(old[0]), double(old[1]), double(old[2])};
    double best = INFINITY, move_sq = 0;
    for (size_t n = 0; n < ring.triangles.size(); n++) {
        const RingTriangle &s = ring.triangles[n];
        const float *p = ring.position.data(), *a = s.pa.data(), *b = s.pb.data();
        const double here = moves[n].is_second == side || !along_seam
                                ? cwi_facet_distance_sq(p, a, b, point)
                                : INFINITY;
        if (!(here < best))
            continue;
        const Place &at_a = corners[find_corner(s.face, s.a)].place,
                    &at_b = corners[find_corner(s.face, s.b)].place;
        double weights[3];
        best = here;
        move_sq = 0;
        cwi_facet_nearest(p, a, b, point, weights);
        for (size_t k = 0; k < 2; k++) {
            const double move = weights[0] * double(moves[n].to[k]) +
                                weights[1] * double(at_a[k]) + weights[2] * double(at_b[k]) -
                                double(old_places[side][which_end][k]);
            move_sq += move * move;
        }
    }
    return move_sq;
}

bool TextureCharts::is_kept(const Surface &surface, HalfedgeHandle h, const OneRing &ring)
{
    const HalfedgeHandle back = surface.opposite_halfedge_handle(h);
    end = target(surface, h);
    if (end == NOWHERE || loses_chart(surface, h) || loses_chart(surface, back))
        return false;
    along_seam = is_seam(surface, h);
    find_places(surface, h, ring);
    list_moves(surface, h, ring);
    for (const Move &m : moves)
        if (turns_over(m))
            return false;
    for (int n = 0; n < (along_seam ? 4 : 2) && std::isfinite(max_move_sq); n++)
        if (stray_sq(ring, n % 2, n / 2) > max_move_sq)
            return false;
    list_swept(surface, h);
    return !outlines || !along_seam || !meets_outlines();
}

// --- outlines ------------------------------------------------------------------------------

void TextureCharts::add_swept(size_t side, const Place &from, const Place &to,
                              const Place &other)
{
    if (corners[side].outline != NONE)
        swept.push_back({corners[side].outline, from, to, other});
}

void TextureCharts::list_swept(const Surface &surface, HalfedgeHandle h)
{
    swept.clear();
    if (!along_seam)
        return;
    for (const Move &m : moves) {
        const size_t after = next(m.corner), before = next(after);
        const Place &from = corners[m.corner].place;
        add_swept(m.corner, from, m.to, corners[after].place);
        add_swept(before, from, m.to, corners[before].place);
    }
    const HalfedgeHandle side[2] = {h, surface.opposite_halfedge_handle(h)};
    for (int s = 0; s < 2; s++) {
        if (surface.is_boundary(side[s]))
            continue;
        const size_t first = find_corner(uint32_t(surface.face_handle(side[s]).idx()),
                                         uint32_t(surface.from_vertex_handle(side[s]).idx()));
        const size_t second = next(first), third = next(second);
        const Place &across = corners[third].place;
        add_swept(first, corners[first].place, places[s], corners[second].place);
        add_swept(second, corners[second].place, places[s], across);
        add_swept(third, corners[first].place, places[s], across);
    }
}

bool TextureCharts::is_swept(uint32_t outline) const
{
    for (const Swept &s : swept)
        if (s.outline == outline)
            return true;
    return false;
}

// A side that does not move must not cross those that do, nor begin in what they sweep over. The two sides of a
// seam may lie far apart in the texture, so that each moving side is looked at by itself.
bool TextureCharts::meets_outlines() const
{
    size_t visits = 0;
    for (const Swept &s : swept) {
        Box box;
        add(box, s.from);
        add(box, s.to);
        add(box, s.other);
        for (const Swept &t : swept)
            if (do_cross(s.to, s.other, t.to, t.other) ||
                is_inside(t.other, s.from, s.to, s.other))
                return true;
        const bool meets = outlines->any(box, [&](uint32_t other, const float *) {
            Place a, b;
            ends_of(other, a, b);
            return ++visits > MAX_VISITS ||
                   ((do_cross(a, b, s.to, s.other) || is_inside(a, s.from, s.to, s.other)) &&
                    !is_swept(other));
        });
        if (meets)
            return true;
    }
    return false;
}

// Of a triangle that vanishes, hands the side along a seam over to the triangle across the other one.
void TextureCharts::hand_over_side(const Surface &surface, HalfedgeHandle h)
{
    if (surface.is_boundary(h))
        return;
    const size_t first = find_corner(uint32_t(surface.face_handle(h).idx()),
                                     uint32_t(surface.from_vertex_handle(h).idx()));
    const size_t second = next(first), third = next(second);
    if (corners[first].outline != NONE && outlines) {
        outlines->remove(corners[first].outline);
        live--;
    }
    corners[first].outline = NONE;
    for (const size_t from : {second, third}) {
        const uint32_t outline = corners[from].outline;
        if (outline == NONE)
            continue;
        const HalfedgeHandle across = surface.opposite_halfedge_handle(
            from == second ? previous(surface, h) : surface.next_halfedge_handle(h));
        const size_t to = find_corner(uint32_t(surface.face_handle(across).idx()),
                                      corners[from == second ? first : third].vertex);
        corners[to].outline = outline;
        sides[outline] = to;
    }
}

void TextureCharts::change(const Surface &surface, HalfedgeHandle h, const OneRing &ring)
{
    hand_over_side(surface, h);
    hand_over_side(surface, surface.opposite_halfedge_handle(h));
    for (const Move &m : moves) {
        corners[m.corner].vertex = ring.vertex;
        corners[m.corner].place = m.to;
    }
    // A vertex inside a chart that went to a seam takes over its number of seams, and so does the other.
    const auto u = size_t(surface.from_vertex_handle(h).idx());
    if (end == AT_START)
        seams[ring.vertex] = seams[u];
    for (const Swept &s : swept) {
        if (!outlines)
            break;
        Box box;
        add(box, s.to);
        add(box, s.other);
        if (s.outline == corners[sides[s.outline]].outline)
            outlines->move(s.outline, box);
    }
    if (outlines && 2 * live < planted && live > 256) // most boxes are empty, or too large
        plant_outlines();
}

} // namespace cw
