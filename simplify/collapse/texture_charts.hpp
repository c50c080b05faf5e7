// Texture coordinates of corners while edges collapse: charts keep their seams, and no triangle turns
// over in the texture.
#ifndef SIMPLIFY_COLLAPSE_TEXTURE_CHARTS_HPP
#define SIMPLIFY_COLLAPSE_TEXTURE_CHARTS_HPP

#include "simplify/collapse/collapse_checks.hpp"

#include <array>
#include <memory>
#include <vector>

namespace cw
{

// A place in the texture.
using Place = std::array<float, 2>;

// An edge is a seam where the two triangles have different places for one of its ends, and where there is
// one triangle. A vertex on a curve of seams, which has two of them, moves along the curve only; where
// seams meet or end a vertex stays. A chart is then made of the same triangles at any time.
class TextureCharts
{
public:
    // error: how far places may move on the surface; 0: as far as they like
    TextureCharts(const cwi_mesh_block &block, const Surface &surface, double error);

    bool is_requested() const
    {
        return !corners.empty();
    }

    bool is_on_seam(uint32_t vertex) const
    {
        return is_requested() && seams[vertex] > 0;
    }

    // Returns true for an edge that is a seam, from either half-edge.
    bool is_seam(const Surface &surface, HalfedgeHandle h) const;

    // The places that the vertex may take which an edge collapses to.
    enum Target { ANYWHERE, AT_START, AT_END, NOWHERE };
    Target target(const Surface &surface, HalfedgeHandle h) const;

    // Finds the places of the ring's corners after the collapse of h. Returns false if a triangle would
    // turn over in the texture, a chart would vanish, or charts would come to overlap.
    bool is_kept(const Surface &surface, HalfedgeHandle h, const OneRing &ring);

    // Takes over what is_kept() found for the same ring; to be called before the surface changes.
    void change(const Surface &surface, HalfedgeHandle h, const OneRing &ring);

    const Place &at(uint32_t face, uint32_t vertex) const
    {
        return corners[find_corner(face, vertex)].place;
    }

private:
    static constexpr uint32_t NONE = UINT32_MAX;

    // Corner k of a triangle, and the side from it to the next corner.
    struct Corner {
        uint32_t vertex, outline; // outline: number of the side; NONE if it is no seam
        Place place;
    };

    // A corner that moves in the texture.
    struct Move {
        size_t corner;
        bool is_second; // it lies on the second side of the edge
        Place to;
    };

    // A side of an outline that moves: its one end does.
    struct Swept {
        uint32_t outline;
        Place from, to, other;
    };

    size_t find_corner(uint32_t face, uint32_t vertex) const;
    static size_t next(size_t corner);
    void find_seams(const Surface &surface);
    void build_outlines();
    bool plant_outlines();
    bool overlap_at_first() const;
    void ends_of(uint32_t outline, Place &a, Place &b) const;
    void mark_side(const Surface &surface, HalfedgeHandle h);
    bool loses_chart(const Surface &surface, HalfedgeHandle h) const;
    void find_places(const Surface &surface, HalfedgeHandle h, const OneRing &ring);
    Place interpolate(const Surface &surface, const OneRing &ring) const;
    void list_moves(const Surface &surface, HalfedgeHandle h, const OneRing &ring);
    bool turns_over(const Move &move) const;
    double stray_sq(const OneRing &ring, int which_end, bool side) const;
    void list_swept(const Surface &surface, HalfedgeHandle h);
    void add_swept(size_t side, const Place &from, const Place &to, const Place &other);
    bool meets_outlines() const;
    bool is_swept(uint32_t outline) const;
    void hand_over_side(const Surface &surface, HalfedgeHandle h);

    bool holds_seams = false;
    double max_move_sq = INFINITY;    // of a place in the texture
    std::vector<Corner> corners;      // of triangles, x 3
    std::vector<uint8_t> seams;       // vertices: edges of seams there, at most 3
    std::vector<size_t> sides;        // outlines: the corner where the side begins
    std::unique_ptr<Nearby> outlines; // NULL: overlaps are not looked for
    size_t planted = 0, live = 0;     // sides in that tree, at first and now
    // Of the last collapse that was looked at:
    bool along_seam = false;
    Target end = NOWHERE;
    Place old_places[2][2] = {},
          places[2] = {};         // of both ends, and of the target, on both sides of the edge
    std::vector<uint32_t> marked; // triangles of the first side at the edge's start, and of the
                                  // second side at its end
    std::vector<Move> moves;
    std::vector<Swept> swept;
};

} // namespace cw

#endif
