// CGAL's Polygon Mesh Processing is under the GPL, and so is this module once it is built.
#include "simplify/quality/cgal_wrap.h"

#include "core/base/guard.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/distance.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/shape_predicates.h>
#include <CGAL/Surface_mesh.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace
{

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using Triangle = std::array<std::size_t, 3>;

struct Soup {
    std::vector<Kernel::Point_3> points;
    std::vector<Triangle> triangles;
};

// CGAL announces what it then throws; we only want to catch it.
void say_nothing(const char *, const char *, const char *, int, const char *)
{
}

// Triangles that name a vertex twice are no polygons.
Soup to_soup(const float *points, const uint32_t *corners, std::size_t vertices,
             std::size_t triangles, const double origin[3])
{
    Soup soup;
    for (std::size_t v = 0; v < vertices; v++)
        soup.points.emplace_back(origin[0] + double(points[3 * v]),
                                 origin[1] + double(points[3 * v + 1]),
                                 origin[2] + double(points[3 * v + 2]));
    for (std::size_t t = 0; t < triangles; t++) {
        const uint32_t *c = corners + 3 * t;
        if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0])
            soup.triangles.push_back({c[0], c[1], c[2]});
    }
    return soup;
}

// Vertices without triangles would count as components.
Surface to_surface(const Soup &soup)
{
    Surface surface;
    pmp::polygon_soup_to_polygon_mesh(soup.points, soup.triangles, surface);
    for (const auto v : surface.vertices())
        if (surface.is_isolated(v))
            surface.remove_vertex(v);
    return surface;
}

void judge_shapes(const Surface &surface, cw_cgal_facts &out)
{
    const double cap = std::cos(CW_CAP_ANGLE_DEG * std::acos(-1.0) / 180);
    for (const auto f : surface.faces()) {
        if (pmp::is_degenerate_triangle_face(f, surface)) {
            out.degenerate++;
            continue;
        }
        const bool is_cap =
            pmp::is_cap_triangle_face(f, surface, cap) != Surface::null_halfedge();
        out.caps += is_cap;
        out.needles += !is_cap && pmp::is_needle_triangle_face(f, surface, CW_NEEDLE_RATIO) !=
                                      Surface::null_halfedge();
    }
}

std::size_t count_self_intersections(const Surface &surface)
{
    std::vector<std::pair<Surface::Face_index, Surface::Face_index>> pairs;
    std::size_t count = 0;
    pmp::self_intersections(surface, std::back_inserter(pairs));
    for (const auto &pair : pairs)
        count += pair.first != pair.second; // a pair with itself: a face without area
    return count;
}

// Whether shells bound a volume can only be asked where none meets another.
bool bounds_volume(const Surface &surface, const cw_cgal_facts &facts)
{
    return facts.closed && !facts.self_intersections && !facts.degenerate &&
           pmp::does_bound_a_volume(surface);
}

void judge_surface(Surface &surface, cw_cgal_facts &out)
{
    using Border = std::vector<boost::graph_traits<Surface>::halfedge_descriptor>;
    Border loops;
    pmp::extract_boundary_cycles(surface, std::back_inserter(loops));
    auto ids = surface.add_property_map<Surface::Face_index, std::size_t>("f:part", 0).first;
    out.border_loops = loops.size();
    out.components = pmp::connected_components(surface, ids);
    out.closed = CGAL::is_closed(surface);
    out.area_mm2 = pmp::area(surface);
    out.volume_mm3 = out.closed ? pmp::volume(surface) : 0;
    judge_shapes(surface, out);
    out.self_intersections = count_self_intersections(surface);
    out.bounds_volume = bounds_volume(surface, out);
    out.outward = out.bounds_volume && pmp::is_outward_oriented(surface);
}

cw_status judge(const cwi_welded *welded, cw_cgal_facts *out, cw_error *err) noexcept
{
    return cw::guard(err, "CGAL", [&] {
        CGAL::set_error_handler(say_nothing);
        const double zero[3] = {0, 0, 0};
        const Soup soup = to_soup(welded->points, welded->vertex, welded->mesh->vertex_count,
                                  welded->mesh->triangle_count, zero);
        out->is_polygon_mesh = pmp::is_polygon_soup_a_polygon_mesh(soup.triangles);
        if (out->is_polygon_mesh) {
            Surface surface = to_surface(soup);
            judge_surface(surface, *out);
        }
        return CW_OK;
    });
}

cw_status hausdorff(const cw_mesh *mesh, const cw_mesh *reference, double tolerance_mm,
                    double *out_mm, cw_error *err) noexcept
{
    return cw::guard(err, "CGAL", [&] {
        CGAL::set_error_handler(say_nothing);
        Surface surfaces[2];
        const cw_mesh *meshes[2] = {mesh, reference};
        for (int n = 0; n < 2; n++) {
            const cw_mesh &m = *meshes[n];
            const Soup soup =
                to_soup(m.positions, m.triangles, m.vertex_count, m.triangle_count, m.origin);
            if (!pmp::is_polygon_soup_a_polygon_mesh(soup.triangles))
                return cwi_fail(err, CW_ERR_BACKEND,
                                "CGAL takes no mesh that is not an oriented manifold");
            surfaces[n] = to_surface(soup);
        }
        *out_mm = pmp::bounded_error_Hausdorff_distance<CGAL::Sequential_tag>(
            surfaces[0], surfaces[1], tolerance_mm);
        return CW_OK;
    });
}

} // namespace

extern "C" const cwi_cgal_functions cwi_module_cgal = {judge, hausdorff};
