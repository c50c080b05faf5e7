/* CGAL's answers to the same questions, timed. */
#ifndef BENCH_CGAL_BENCH_H
#define BENCH_CGAL_BENCH_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Milliseconds of CGAL's self_intersections() on a mesh that is a manifold, its own data
 * structure being made already: processor time on one thread. With more than one thread time by the
 * clock, by TBB, where CGAL has it. Negative: not in this build. */
double bench_cgal_intersections(const cw_mesh *mesh, int threads, size_t *pairs);

/* Makes the union, difference or intersection (0, 1, 2) of closed meshes by corefinement, on one
 * thread, their data structures being made already. Returns its processor time in ms; negative: not in
 * this build, or it found no result. volume: of the result */
double bench_cgal_boolean(const cw_mesh *a, const cw_mesh *b, int op, double *volume);

#ifdef __cplusplus
}
#endif

#endif
