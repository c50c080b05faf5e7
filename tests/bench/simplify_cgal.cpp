// Simplifies a mesh with CGAL's edge collapse and Garland-Heckbert plane quadrics, to a number of
// triangles or within an envelope.
#include "simplify_peers.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Polyhedral_envelope_filter.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

namespace sms = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Simple_cartesian<double>;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using Policies = sms::GarlandHeckbert_plane_policies<Surface, Kernel>;
using Exact = CGAL::Exact_predicates_inexact_constructions_kernel; // as the envelope needs it
using Exact_surface = CGAL::Surface_mesh<Exact::Point_3>;
using Exact_policies = sms::GarlandHeckbert_plane_policies<Exact_surface, Exact>;
using Filter = sms::Polyhedral_envelope_filter<Exact, sms::Bounded_normal_change_filter<>>;
using Placement = sms::Bounded_normal_change_placement<Policies::Get_placement>;

const bool bench_has_cgal = true;

namespace
{

struct few_triangles {
    size_t enough;
    template <typename Cost, typename Profile>
    bool operator()(const Cost &, const Profile &edge, size_t, size_t) const
    {
        return edge.surface_mesh().number_of_faces() <= enough;
    }
};

template <typename Mesh> void to_surface(const cw_mesh &in, Mesh &surface)
{
    using Index = typename Mesh::Vertex_index;
    using Size = typename Mesh::size_type;
    surface.reserve(Size(in.vertex_count), Size(in.vertex_count + in.triangle_count),
                    Size(in.triangle_count));
    for (size_t v = 0; v < in.vertex_count; v++) {
        const float *p = in.positions + 3 * v;
        surface.add_vertex(typename Mesh::Point(double(p[0]), double(p[1]), double(p[2])));
    }
    for (size_t t = 0; t < in.triangle_count; t++) {
        const uint32_t *c = in.triangles + 3 * t;
        surface.add_face(Index(c[0]), Index(c[1]), Index(c[2]));
    }
}

template <typename Mesh> bool from_surface(const Mesh &surface, cw_mesh *out)
{
    if (!bench_mesh_alloc(out, surface.number_of_vertices(), surface.number_of_faces()))
        return false;
    for (const auto v : surface.vertices())
        for (int a = 0; a < 3; a++)
            out->positions[3 * size_t(v) + size_t(a)] = float(surface.point(v)[a]);
    for (const auto f : surface.faces()) {
        uint32_t *corner = out->triangles + 3 * size_t(f);
        for (const auto v : surface.vertices_around_face(surface.halfedge(f)))
            *corner++ = uint32_t(v);
    }
    return true;
}

} // namespace

bool bench_cgal(const cw_mesh *in, size_t triangles, cw_mesh *out, double *build_s)
try {
    const double begin = bench_now_s();
    Surface surface;
    to_surface(*in, surface);
    *build_s = bench_now_s() - begin;
    const Policies policies(surface);
    sms::edge_collapse(surface, few_triangles{triangles},
                       CGAL::parameters::get_cost(policies.get_cost())
                           .get_placement(Placement(policies.get_placement())));
    surface.collect_garbage();
    return from_surface(surface, out);
} catch (...) {
    return false;
}

bool bench_cgal_envelope(const cw_mesh *in, double error_mm, cw_mesh *out)
try {
    Exact_surface surface;
    to_surface(*in, surface);
    const Exact_policies policies(surface);
    sms::edge_collapse(surface, few_triangles{0},
                       CGAL::parameters::get_cost(policies.get_cost())
                           .get_placement(policies.get_placement())
                           .filter(Filter(error_mm)));
    surface.collect_garbage();
    return from_surface(surface, out);
} catch (...) {
    return false;
}
