// Closed shells of few triangles: a collapse could turn them inside out, or jump over them.
#ifndef SIMPLIFY_COLLAPSE_SMALL_SHELLS_HPP
#define SIMPLIFY_COLLAPSE_SMALL_SHELLS_HPP

#include "simplify/collapse/collapse_checks.hpp"

namespace cw
{

// Surfaces that do not meet before and after a collapse can have passed through each other on the
// way: a ring jumps over a small shell, or one side of a thin shell, which is the ring of one
// vertex, passes through the other side. Normals may hardly change: only the sign of the shell's
// volume tells.
class SmallShells
{
public:
    explicit SmallShells(const cwi_mesh_block &block);

    // Returns true if the shell of a ring would change the sign of its volume, or lose it. While
    // the rest of a small shell is beyond a seam it may: then *open is set, too.
    bool turns(const Surface &surface, const OneRing &ring, bool *open);

    // Returns true if a small shell is between the ring as it is and as it would be.
    bool sweeps(const Surface &surface, const OneRing &ring) const;

    void change(const OneRing &ring); // it has become so

private:
    void list_shells(const cwi_mesh_block &block);

    enum class End { CLOSED, SEAM, BORDER };

    End collect(const Surface &surface, uint32_t first);

    std::vector<uint32_t> shell_of;  // faces
    std::vector<uint32_t> left;      // shells: their faces
    std::vector<uint32_t> faces;     // of the shell at hand
    std::vector<uint8_t> locked;     // vertices: at a seam
    std::vector<uint32_t> vertex_of; // shells: one of their vertices
    std::vector<Box> boxes;          // shells: around all their places so far
    std::unique_ptr<Nearby> nearby;  // tree of the small shells, or NULL
};

} // namespace cw

#endif
