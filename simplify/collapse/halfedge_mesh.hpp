// OpenMesh's half-edges, as lean as they can be, made from arrays. Not a corner table: OpenMesh
// collapses on links of its own.
#ifndef SIMPLIFY_COLLAPSE_HALFEDGE_MESH_HPP
#define SIMPLIFY_COLLAPSE_HALFEDGE_MESH_HPP

#include "simplify/collapse/openmesh_wrap.h"
#include "simplify/collapse/quadric.hpp"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include <vector>

namespace cw
{

struct Traits : OpenMesh::DefaultTraits {
    using Point = Vec;
    VertexAttributes(OpenMesh::Attributes::Status);
    EdgeAttributes(OpenMesh::Attributes::Status);
    FaceAttributes(OpenMesh::Attributes::Status);
};

using Surface = OpenMesh::TriMesh_ArrayKernelT<Traits>;
using VertexHandle = OpenMesh::VertexHandle;
using HalfedgeHandle = OpenMesh::HalfedgeHandle;
using EdgeHandle = OpenMesh::EdgeHandle;
using FaceHandle = OpenMesh::FaceHandle;

// Connects the block's own triangles; numbers of vertices and faces are those of the arrays.
// Sides that do not pair off two by two become borders. Returns the vertices whose triangles
// are then no single fan, or that lie at such sides: they must not be moved.
std::vector<uint8_t> connect(const cwi_mesh_block &block, Surface &surface);

} // namespace cw

#endif
