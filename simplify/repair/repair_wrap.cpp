// CGAL's Boolean operations and alpha wraps are under the GPL, and so is this module once it is built.
#undef NDEBUG // CGAL checks its preconditions, and throws: broken meshes must not crash it
#include "simplify/repair/repair_wrap.h"

#include "core/base/guard.hpp"
#include "core/mesh/mesh.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/bbox.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>
#include <CGAL/boost/graph/copy_face_graph.h>

#include <array>
#include <cstddef>
#include <vector>

namespace
{

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using Triangle = std::array<std::size_t, 3>;

// Components that cannot be united are made smaller by this factor, and tried again.
constexpr int ATTEMPTS = 3;
constexpr double SHRINK = 0.999;

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
    return true;
}

bool is_solid(const Surface &surface)
{
    return CGAL::is_valid_polygon_mesh(surface) && CGAL::is_triangle_mesh(surface) &&
           CGAL::is_closed(surface) && pmp::does_bound_a_volume(surface);
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

// Scales a component around the middle of its box.
void shrink(Surface &surface, double factor)
{
    const auto box = pmp::bbox(surface);
    const Kernel::Point_3 middle((box.xmin() + box.xmax()) / 2, (box.ymin() + box.ymax()) / 2,
                                 (box.zmin() + box.zmax()) / 2);
    for (const auto v : surface.vertices())
        surface.point(v) = middle + factor * (surface.point(v) - middle);
}

// Unites two solids. CGAL throws when one crosses itself, and fails when the union is no manifold.
bool unite_two(Surface all, Surface shell, Surface &united)
{
    try {
        return pmp::corefine_and_compute_union(
                   all, shell, united, pmp::parameters::throw_on_self_intersection(true)) &&
               is_solid(united);
    } catch (const pmp::Corefinement::Self_intersection_exception &) {
        return false;
    } catch (const CGAL::Failure_exception &) {
        return false;
    }
}

// Unites one component after the other with those before. Where surfaces lie on each other, the union
// may be no manifold, or lose a part to rounding; a component that is slightly smaller may do.
std::size_t unite_all(std::vector<Surface> &shells, Surface &all, Surface &rest)
{
    std::size_t count = 0;
    for (auto &shell : shells) {
        bool is_united = false;
        for (int attempt = 0; attempt < ATTEMPTS && is_solid(shell) && !is_united; attempt++) {
            Surface united;
            if (pmp::volume(shell) < 0)
                pmp::reverse_face_orientations(shell);
            if (attempt > 0)
                shrink(shell, SHRINK);
            is_united = all.is_empty() || unite_two(all, shell, united);
            if (is_united)
                all = united.is_empty() ? shell : united;
        }
        count += is_united;
        if (!is_united)
            CGAL::copy_face_graph(shell, rest);
    }
    return count;
}

cw_status unite(const cw_mesh *mesh, const uint32_t *shell, uint32_t shells, const bool *marked,
                cw_mesh *out, bool *is_done, cw_error *err) noexcept
{
    *out = cw_mesh{};
    *is_done = false;
    return cw::guard(err, "CGAL", [&] {
        CGAL::set_error_handler(say_nothing);
        CGAL::set_warning_handler(say_nothing);
        const cw::Taken taken(mesh->triangle_count * 400);
        std::vector<Surface> surfaces(shells);
        std::vector<std::vector<uint32_t>> triangles(shells);
        std::vector<Surface::Vertex_index> number(mesh->vertex_count);
        Surface all, rest;
        bool ok = true;
        for (uint32_t t = 0; t < mesh->triangle_count; t++)
            if (marked[t])
                triangles[shell[t]].push_back(t);
        for (uint32_t n = 0; n < shells && ok; n++)
            ok = copy_shell(*mesh, triangles[n], number, surfaces[n]);
        *is_done = ok && unite_all(surfaces, all, rest) > 1;
        if (!*is_done)
            return CW_OK;
        CGAL::copy_face_graph(rest, all);
        all.collect_garbage();
        return copy_out(all, out, err);
    });
}

cw_status wrap(const cw_mesh *mesh, double radius_mm, double offset_mm, cw_mesh *out,
               cw_error *err) noexcept
{
    *out = cw_mesh{};
    return cw::guard(err, "CGAL", [&] {
        CGAL::set_error_handler(say_nothing);
        CGAL::set_warning_handler(say_nothing);
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
