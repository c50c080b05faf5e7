// CGAL's Boolean operations and alpha wraps are under the GPL, and so is this module once it is built.
#include "simplify/repair/repair_wrap.h"

#include "core/base/guard.hpp"
#include "core/mesh/mesh.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace
{

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using Triangle = std::array<std::size_t, 3>;

// CGAL announces what it then throws; we only want to catch it.
void say_nothing(const char *, const char *, const char *, int, const char *)
{
}

Kernel::Point_3 get_point(const cw_mesh &mesh, std::size_t v)
{
    const float *p = mesh.positions + 3 * v;
    return {double(p[0]), double(p[1]), double(p[2])};
}

// Copies the triangles of one component, whose vertices no other component names. False if it is no
// manifold.
bool copy_shell(const cw_mesh &mesh, const std::vector<uint32_t> &triangles,
                std::vector<Surface::Vertex_index> &number, Surface &out)
{
    for (const uint32_t t : triangles) {
        Surface::Vertex_index v[3];
        for (std::size_t k = 0; k < 3; k++) {
            const uint32_t at = mesh.triangles[3 * std::size_t(t) + k];
            if (!number[at].is_valid())
                number[at] = out.add_vertex(get_point(mesh, at));
            v[k] = number[at];
        }
        if (!out.add_face(v[0], v[1], v[2]).is_valid())
            return false;
    }
    return CGAL::is_closed(out);
}

cw_status copy_out(const Surface &surface, cw_mesh *out, cw_error *err)
{
    std::vector<uint32_t> number(surface.num_vertices() + surface.number_of_removed_vertices());
    cw_status st = cwi_mesh_alloc(out, surface.number_of_vertices(), surface.number_of_faces(),
                                  false, err);
    if (st != CW_OK)
        return st;
    uint32_t count = 0;
    for (const auto v : surface.vertices()) {
        const auto &p = surface.point(v);
        for (int a = 0; a < 3; a++)
            out->positions[3 * std::size_t(count) + std::size_t(a)] = float(p[a]);
        number[v] = count++;
    }
    std::size_t corner = 0;
    for (const auto f : surface.faces())
        for (const auto v : CGAL::vertices_around_face(surface.halfedge(f), surface))
            out->triangles[corner++] = number[v];
    return CW_OK;
}

// Unites one component after the other. CGAL throws when one crosses itself, which rounding to single
// precision may cause.
bool unite_all(std::vector<Surface> &shells, Surface &all)
{
    try {
        for (auto &shell : shells) {
            if (pmp::volume(shell) < 0)
                pmp::reverse_face_orientations(shell);
            if (all.is_empty()) {
                all = shell;
                continue;
            }
            Surface united;
            if (!pmp::corefine_and_compute_union(
                    all, shell, united, pmp::parameters::throw_on_self_intersection(true)))
                return false;
            all = std::move(united);
        }
    } catch (const pmp::Corefinement::Self_intersection_exception &) {
        return false;
    }
    return true;
}

cw_status unite(const cw_mesh *mesh, const uint32_t *shell, uint32_t shells, const bool *marked,
                cw_mesh *out, bool *is_done, cw_error *err) noexcept
{
    *out = cw_mesh{};
    *is_done = false;
    return cw::guard(err, "CGAL", [&] {
        CGAL::set_error_handler(say_nothing);
        const cw::Taken taken(mesh->triangle_count * 400);
        std::vector<Surface> surfaces(shells);
        std::vector<std::vector<uint32_t>> triangles(shells);
        std::vector<Surface::Vertex_index> number(mesh->vertex_count);
        Surface all;
        bool ok = true;
        for (uint32_t t = 0; t < mesh->triangle_count; t++)
            if (marked[t])
                triangles[shell[t]].push_back(t);
        for (uint32_t n = 0; n < shells && ok; n++)
            ok = copy_shell(*mesh, triangles[n], number, surfaces[n]);
        *is_done = ok && unite_all(surfaces, all);
        return *is_done ? copy_out(all, out, err) : CW_OK;
    });
}

cw_status wrap(const cw_mesh *mesh, double radius_mm, double offset_mm, cw_mesh *out,
               cw_error *err) noexcept
{
    *out = cw_mesh{};
    return cw::guard(err, "CGAL", [&] {
        CGAL::set_error_handler(say_nothing);
        const cw::Taken taken(mesh->triangle_count * 400);
        std::vector<Kernel::Point_3> points;
        std::vector<Triangle> triangles;
        Surface surface;
        points.reserve(mesh->vertex_count);
        triangles.reserve(mesh->triangle_count);
        for (std::size_t v = 0; v < mesh->vertex_count; v++)
            points.push_back(get_point(*mesh, v));
        for (std::size_t t = 0; t < mesh->triangle_count; t++) {
            const uint32_t *c = mesh->triangles + 3 * t;
            triangles.push_back({c[0], c[1], c[2]});
        }
        CGAL::alpha_wrap_3(points, triangles, radius_mm, offset_mm, surface);
        return copy_out(surface, out, err);
    });
}

} // namespace

extern "C" const cwi_wrap_functions cwi_module_wrap = {unite, wrap};
