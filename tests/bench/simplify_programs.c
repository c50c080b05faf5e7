/* Lists the programs that bench_simplify measures, and calls ours. */
#include "simplify_programs.h"

#include <cubewright/simplify.h>

#include <stdio.h>

int bench_our_threads;

/* Without normals, as the others. */
static bool ask_ours(const cw_mesh *in, const cw_simplify_desc *desc, cw_mesh *out)
{
    cw_mesh bare = *in;
    cw_error err = {0};
    bare.normals = NULL;
    const cw_status st = cw_simplify(&bare, desc, out, NULL, &err);
    if (st != CW_OK)
        fprintf(stderr, "%s\n", err.message);
    return st == CW_OK;
}

static bool ours(const cw_mesh *in, size_t triangles, cw_mesh *out, double *build_s)
{
    *build_s = 0;
    return ask_ours(
        in, &(cw_simplify_desc){.triangles = triangles, .threads = bench_our_threads}, out);
}

static bool ours_within(const cw_mesh *in, double error_mm, cw_mesh *out)
{
    return ask_ours(in, &(cw_simplify_desc){.error_mm = error_mm, .threads = bench_our_threads},
                    out);
}

static bool ours_crossing(const cw_mesh *in, size_t triangles, cw_mesh *out, double *build_s)
{
    const cw_simplify_desc desc = {
        .triangles = triangles, .threads = bench_our_threads, .allow_crossings = true};
    *build_s = 0;
    return ask_ours(in, &desc, out);
}

const bench_program bench_programs[PROGRAMS] = {
    [OURS_ERROR] = {"cubewright-error", NULL, ours_within},
    [OURS] = {"cubewright", ours, NULL},
    [OURS_CROSSING] = {"cubewright-crossing", ours_crossing, NULL}, /* allow_crossings */
    [MESHOPT] = {"meshoptimizer", bench_meshopt, NULL},
    [MESHOPT_ERROR] = {"meshoptimizer-error", NULL, bench_meshopt_error},
    [VTK] = {"vtk", bench_vtk, NULL},
    [OPENMESH] = {"openmesh", bench_openmesh, NULL},
    [CGAL] = {"cgal", bench_cgal, NULL},
    [CGAL_ENVELOPE] = {"cgal-envelope", NULL, bench_cgal_envelope},
};

bool bench_is_here(int program)
{
    const bool ours_is = cw_simplify_available();
    const bool here[PROGRAMS] = {[OURS_ERROR] = ours_is,
                                 [OURS] = ours_is,
                                 [OURS_CROSSING] = ours_is,
                                 [MESHOPT] = bench_has_meshopt,
                                 [MESHOPT_ERROR] = bench_has_meshopt,
                                 [VTK] = bench_has_vtk,
                                 [OPENMESH] = bench_has_openmesh,
                                 [CGAL] = bench_has_cgal,
                                 [CGAL_ENVELOPE] = bench_has_cgal};
    return here[program];
}
