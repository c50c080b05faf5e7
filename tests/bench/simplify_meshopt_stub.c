/* Stands in for the simplifiers of meshoptimizer in a build without it: they always fail. */
#include "simplify_peers.h"

const bool bench_has_meshopt = false;

bool bench_meshopt(const cw_mesh *in, size_t triangles, cw_mesh *out, double *build_s)
{
    (void)in, (void)triangles, (void)out, (void)build_s;
    return false;
}

bool bench_meshopt_error(const cw_mesh *in, double error_mm, cw_mesh *out)
{
    (void)in, (void)error_mm, (void)out;
    return false;
}
