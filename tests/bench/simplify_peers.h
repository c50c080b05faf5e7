/* Other programs' simplifiers, to be measured beside ours. */
#ifndef BENCH_SIMPLIFY_PEERS_H
#define BENCH_SIMPLIFY_PEERS_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reduces a mesh with shared vertices to a number of triangles, or as near as the program gets,
 * with the settings that its documentation starts from. build_s is the part of the time before
 * the first collapse is looked for: copying into the program's own structure; 0 where it has
 * none that can be told apart. False: it failed. */
typedef bool bench_simplifier(const cw_mesh *in, size_t triangles, cw_mesh *out,
                              double *build_s);

/* Reduces a mesh as far as an error in millimetres lets it. */
typedef bool bench_bounded_simplifier(const cw_mesh *in, double error_mm, cw_mesh *out);

bench_simplifier bench_meshopt;  /* meshopt_simplify */
bench_simplifier bench_vtk;      /* vtkQuadricDecimation */
bench_simplifier bench_openmesh; /* DecimaterT, ModQuadricT, ModNormalFlippingT at 90 degrees */
bench_simplifier bench_cgal;     /* edge_collapse, GarlandHeckbert_plane_policies,
                                    Bounded_normal_change_placement */

/* meshopt_simplify with target_error: the root of what its quadrics add up to. It is no bound. */
bench_bounded_simplifier bench_meshopt_error;

/* bench_cgal with Polyhedral_envelope_filter: the result is within the error of the input, and the
 * other way has no bound. The input must be closed. */
bench_bounded_simplifier bench_cgal_envelope;

/* Which of them are in this build. */
extern const bool bench_has_meshopt, bench_has_vtk, bench_has_openmesh, bench_has_cgal;

/* Helpers for the simplifiers: room for a result, and a clock. */
bool bench_mesh_alloc(cw_mesh *mesh, size_t vertices, size_t triangles);
double bench_now_s(void);

#ifdef __cplusplus
}
#endif

#endif
