/* Stands in for the simplifier of CGAL in a build without it: always fails. */
#include "simplify_peers.h"

const bool bench_has_cgal = false;

bool bench_cgal(const cw_mesh *in, size_t triangles, cw_mesh *out, double *build_s)
{
    (void)in, (void)triangles, (void)out, (void)build_s;
    return false;
}
