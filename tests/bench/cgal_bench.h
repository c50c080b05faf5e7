/* CGAL's answers to the same questions, timed. */
#ifndef BENCH_CGAL_BENCH_H
#define BENCH_CGAL_BENCH_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Milliseconds of CGAL's self_intersections() on a mesh that is a manifold, its own data
 * structure being made already; with more than one thread by TBB, where CGAL has it. Negative:
 * not in this build. */
double bench_cgal_intersections(const cw_mesh *mesh, int threads, size_t *pairs);

#ifdef __cplusplus
}
#endif

#endif
