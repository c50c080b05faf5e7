/* Stands in for the CGAL bench in a build without CGAL: reports that there is none. */
#include "cgal_bench.h"

double bench_cgal_intersections(const cw_mesh *mesh, int threads, size_t *pairs)
{
    (void)mesh, (void)threads, (void)pairs;
    return -1;
}
