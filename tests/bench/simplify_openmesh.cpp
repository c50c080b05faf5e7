// Simplifies a mesh with OpenMesh's decimater: quadrics, and a check for flipped normals.
#include "simplify_peers.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

using Mesh = OpenMesh::TriMesh_ArrayKernelT<>;
using Decimater = OpenMesh::Decimater::DecimaterT<Mesh>;
using Quadric = OpenMesh::Decimater::ModQuadricT<Mesh>;
using NormalFlipping = OpenMesh::Decimater::ModNormalFlippingT<Mesh>;

const bool bench_has_openmesh = true;

static void to_openmesh(const cw_mesh &in, Mesh &mesh)
{
    mesh.reserve(in.vertex_count, in.vertex_count + in.triangle_count, in.triangle_count);
    for (size_t v = 0; v < in.vertex_count; v++) {
        const float *p = in.positions + 3 * v;
        mesh.add_vertex({p[0], p[1], p[2]});
    }
    for (size_t t = 0; t < in.triangle_count; t++) {
        const uint32_t *c = in.triangles + 3 * t;
        mesh.add_face(mesh.vertex_handle(c[0]), mesh.vertex_handle(c[1]),
                      mesh.vertex_handle(c[2]));
    }
    mesh.request_face_normals(); /* the modules ask for them */
    mesh.update_face_normals();
}

static bool from_openmesh(const Mesh &mesh, cw_mesh *out)
{
    if (!bench_mesh_alloc(out, mesh.n_vertices(), mesh.n_faces()))
        return false;
    for (const auto v : mesh.vertices())
        for (int a = 0; a < 3; a++)
            out->positions[3 * v.idx() + a] = mesh.point(v)[size_t(a)];
    for (const auto f : mesh.faces()) {
        uint32_t *corner = out->triangles + 3 * f.idx();
        for (const auto v : mesh.fv_range(f))
            *corner++ = uint32_t(v.idx());
    }
    return true;
}

bool bench_openmesh(const cw_mesh *in, size_t triangles, cw_mesh *out, double *build_s)
try {
    const double begin = bench_now_s();
    Mesh mesh;
    to_openmesh(*in, mesh);
    *build_s = bench_now_s() - begin;
    Decimater decimater(mesh);
    Quadric::Handle quadric;
    NormalFlipping::Handle flipping;
    if (!decimater.add(quadric) || !decimater.add(flipping) || !decimater.initialize())
        return false;
    decimater.decimate_to_faces(0, triangles);
    mesh.garbage_collection();
    return from_openmesh(mesh, out);
} catch (...) {
    return false;
}
