// Makes an OpenMesh surface of half-edges from the arrays of a block, and marks vertices that
// are no single fan.
#include "simplify/collapse/halfedge_mesh.hpp"

#include "core/geometry/triangle.h"

#include <algorithm>

namespace cw
{

namespace
{

// A side of a triangle is the number of the corner it starts at.
class Sides
{
public:
    explicit Sides(const cwi_mesh_block &block)
        : corners(block.corners), count(3 * block.interior_count), first(block.vertices + 1),
          order(count)
    {
        for (size_t s = 0; s < count; s++)
            first[corners[s] + 1]++;
        for (size_t v = 0; v < block.vertices; v++)
            first[v + 1] += first[v];
        std::vector<uint32_t> next_slot(first.begin(), first.end() - 1);
        for (size_t s = 0; s < count; s++)
            order[next_slot[corners[s]]++] = uint32_t(s);
        for (size_t v = 0; v < block.vertices; v++)
            std::sort(order.begin() + first[v], order.begin() + first[v + 1],
                      [this](uint32_t s, uint32_t t) { return to(s) < to(t); });
    }

    uint32_t from(uint32_t side) const
    {
        return corners[side];
    }

    uint32_t to(uint32_t side) const
    {
        return corners[cwi_corner_next(side)];
    }

    uint32_t around(uint32_t vertex) const
    {
        return first[vertex + 1] - first[vertex];
    }

    // How many run from one vertex to another: none, one, or 2 for more; *side is one of them.
    int between(uint32_t a, uint32_t b, uint32_t *side) const
    {
        const auto end = order.begin() + first[a + 1];
        const auto found =
            std::lower_bound(order.begin() + first[a], end, b,
                             [this](uint32_t s, uint32_t v) { return to(s) < v; });
        if (found == end || to(*found) != b)
            return 0;
        *side = *found;
        return found + 1 != end && to(found[1]) == b ? 2 : 1;
    }

private:
    const uint32_t *corners;
    size_t count;
    std::vector<uint32_t> first, order; // sides of a vertex by the vertex they run to
};

// One edge for a pair of sides, or for a side alone.
std::vector<HalfedgeHandle> make_edges(const cwi_mesh_block &block, const Sides &sides,
                                       Surface &surface, std::vector<uint8_t> &cut)
{
    std::vector<HalfedgeHandle> halfedges(3 * block.interior_count);
    for (uint32_t s = 0; s < halfedges.size(); s++) {
        if (halfedges[s].is_valid())
            continue;
        uint32_t same, opposite = 0;
        const uint32_t a = sides.from(s), b = sides.to(s);
        const int ahead = sides.between(a, b, &same), back = sides.between(b, a, &opposite);
        halfedges[s] = surface.new_edge(VertexHandle(int(a)), VertexHandle(int(b)));
        if (ahead == 1 && back == 1)
            halfedges[opposite] = surface.opposite_halfedge_handle(halfedges[s]);
        else if (ahead + back > 1)
            cut[a] = cut[b] = 1;
    }
    return halfedges;
}

void make_faces(const std::vector<HalfedgeHandle> &halfedges, Surface &surface)
{
    for (size_t s = 0; s < halfedges.size(); s += 3) {
        const FaceHandle face = surface.new_face();
        surface.set_halfedge_handle(face, halfedges[s]);
        for (size_t k = 0; k < 3; k++) {
            const HalfedgeHandle h = halfedges[s + k];
            surface.set_face_handle(h, face);
            surface.set_next_halfedge_handle(h, halfedges[s + (k + 1) % 3]);
            surface.set_halfedge_handle(surface.from_vertex_handle(h), h);
        }
    }
}

// The border goes on from where a halfedge of it ends, within the same fan.
void make_borders(Surface &surface)
{
    for (int i = 0; i < int(surface.n_halfedges()); i++) {
        const HalfedgeHandle h(i);
        if (!surface.is_boundary(h))
            continue;
        HalfedgeHandle next = surface.opposite_halfedge_handle(h);
        do
            next = surface.opposite_halfedge_handle(
                surface.next_halfedge_handle(surface.next_halfedge_handle(next)));
        while (!surface.is_boundary(next));
        surface.set_next_halfedge_handle(h, next);
        surface.set_halfedge_handle(surface.from_vertex_handle(h), h);
    }
}

} // namespace

std::vector<uint8_t> connect(const cwi_mesh_block &block, Surface &surface)
{
    const Sides sides(block);
    std::vector<uint8_t> cut(block.vertices);
    surface.reserve(block.vertices, 3 * block.interior_count,
                    block.interior_count); // pages not used cost nothing
    for (size_t v = 0; v < block.vertices; v++)
        surface.new_vertex(Vec(block.points + 3 * v));
    make_faces(make_edges(block, sides, surface, cut), surface);
    make_borders(surface);
    for (uint32_t v = 0; v < block.vertices; v++) {
        uint32_t fan = 0;
        for (auto f = surface.cvf_begin(VertexHandle(int(v))); f.is_valid(); ++f)
            fan++;
        cut[v] |= fan != sides.around(v);
    }
    return cut;
}

} // namespace cw
