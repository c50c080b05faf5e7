// CGAL's alpha wraps are under the GPL, and so is this module once it is built.
#undef NDEBUG // CGAL checks its preconditions, and throws: broken meshes must not crash it
#include "simplify/repair/repair_wrap.h"

#include "core/base/guard.hpp"
#include "core/mesh/mesh.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <array>
#include <cstddef>
#include <vector>

namespace
{

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

extern "C" const cwi_wrap_functions cwi_module_wrap = {wrap};
