/* Which triangles of a mesh are near another mesh? */
#ifndef SIMPLIFY_QUALITY_MESH_WITHIN_H
#define SIMPLIFY_QUALITY_MESH_WITHIN_H

#include <cubewright/mesh.h>

/* Sets beyond[t] to 0 where no point of triangle t is farther than limit_mm from the reference,
 * for certain; else to 1. Nothing is looked for beyond the limit: so this takes a fraction of
 * the time of cw_distance_to_mesh().
 * limits           triangle_count: a limit for each, in place of limit_mm and at most that;
 *                  or NULL
 * mesh, reference  with triangles; every vertex of the mesh is in one */
CW_NODISCARD cw_status cwi_mesh_within(const cw_mesh *mesh, const cw_mesh *reference,
                                       double limit_mm, const double *limits, int threads,
                                       const cw_progress *progress, uint8_t *beyond,
                                       cw_error *err);

#endif
