// Times CGAL's self_intersections() on a mesh, with TBB where CGAL has it, and its booleans.
#include "cgal_bench.h"
#include "bench.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <chrono>
#include <iterator>
#include <utility>
#include <vector>

#ifdef CGAL_LINKED_WITH_TBB
#include <tbb/global_control.h>
#endif

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using Pairs = std::vector<std::pair<Surface::Face_index, Surface::Face_index>>;

namespace
{

Surface to_surface(const cw_mesh &mesh)
{
    Surface surface;
    for (size_t v = 0; v < mesh.vertex_count; v++) {
        const float *p = mesh.positions + 3 * v;
        surface.add_vertex(Kernel::Point_3(double(p[0]), double(p[1]), double(p[2])));
    }
    for (size_t t = 0; t < mesh.triangle_count; t++) {
        const uint32_t *c = mesh.triangles + 3 * t;
        surface.add_face(Surface::Vertex_index(c[0]), Surface::Vertex_index(c[1]),
                         Surface::Vertex_index(c[2]));
    }
    return surface;
}

double wall_ms()
{
    const std::chrono::duration<double, std::milli> now =
        std::chrono::steady_clock::now().time_since_epoch();
    return now.count();
}

template <typename Tag>
double measure(const Surface &surface, double (*now_ms)(), size_t *pairs)
{
    Pairs found;
    const double start = now_ms();
    CGAL::Polygon_mesh_processing::self_intersections<Tag>(surface, std::back_inserter(found));
    const double spent = now_ms() - start;
    *pairs = found.size();
    return spent;
}

} // namespace

double bench_cgal_intersections(const cw_mesh *mesh, int threads, size_t *pairs)
{
    const Surface surface = to_surface(*mesh);
#ifdef CGAL_LINKED_WITH_TBB
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(threads));
    if (threads > 1)
        return measure<CGAL::Parallel_tag>(surface, wall_ms, pairs);
#else
    if (threads > 1)
        return -1;
#endif
    return measure<CGAL::Sequential_tag>(surface, bench_cpu_ms, pairs);
}

double bench_cgal_boolean(const cw_mesh *a, const cw_mesh *b, int op, double *volume)
{
    namespace pmp = CGAL::Polygon_mesh_processing;
    Surface first = to_surface(*a), second = to_surface(*b), out;
    const auto check = CGAL::parameters::throw_on_self_intersection(true);
    const double start = bench_cpu_ms();
    bool done;
    try {
        done = op == 0   ? pmp::corefine_and_compute_union(first, second, out, check)
               : op == 1 ? pmp::corefine_and_compute_difference(first, second, out, check)
                         : pmp::corefine_and_compute_intersection(first, second, out, check);
    } catch (const pmp::Corefinement::Self_intersection_exception &) {
        done = false;
    }
    const double spent = bench_cpu_ms() - start;
    *volume = done ? CGAL::to_double(pmp::volume(out)) : 0;
    return done ? spent : -1;
}
