/* Stands in for the CGAL bench in a build without CGAL: reports that there is none. */
#include "cgal_bench.h"

double bench_cgal_intersections(const cw_mesh *mesh, int threads, size_t *pairs)
{
    (void)mesh, (void)threads, (void)pairs;
    return -1;
}

double bench_cgal_boolean(const cw_mesh *a, const cw_mesh *b, int op, double *volume)
{
    (void)a, (void)b, (void)op, (void)volume;
    return -1;
}
