/* Level sets of meshes: the checks, limits and sampling that their uses share. */
#ifndef EXTRACT_LEVEL_SET_LEVEL_SET_H
#define EXTRACT_LEVEL_SET_LEVEL_SET_H

#include "core/geometry/lattice_map.h"

#include <cubewright/level_set.h>
#include <cubewright/quality.h>

/* Number of voxels by which distances reach farther than requested: enough for gradients. */
enum { CWI_BAND = 3 };

/* Measures a mesh; fails with CW_ERR_ARGUMENT for a mesh that encloses nothing.
 * Solids may touch in edges: winding numbers decide what is inside. */
CW_NODISCARD cw_status cwi_level_set_check(const cw_mesh *mesh, int threads,
                                           cw_quality *quality, cw_error *err);

/* Rounds a surface to another origin, that of the mesh it is made from: files then hold these very
 * positions, and what is found out about the surface is true of the file. */
void cwi_level_set_round(cw_mesh *mesh, const double origin[3]);

/* Proves that a surface does not cross itself. Returns CW_ERR_CHECK, else as cw_self_intersections() */
CW_NODISCARD cw_status cwi_level_set_prove(const cw_mesh *surface, int threads,
                                           const cw_progress *progress, cw_error *err);

/* Estimates the bytes for a level set of a mesh, by its area; with reach_mm beyond CWI_BAND
 * voxels. */
double cwi_level_set_bytes(const cw_quality *q, double voxel_mm, double reach_mm);

/* Returns true if that is within max_bytes and other limits. */
bool cwi_level_set_fits(const cw_quality *q, double voxel_mm, double reach_mm,
                        size_t max_bytes);

/* Does the same as cw_level_set_from_mesh(), for a mesh that was checked, with inside_mm and
 * outside_mm beyond CWI_BAND voxels.
 * level  distances must be exact near it; NULL: everywhere */
CW_NODISCARD cw_status cwi_level_set_make(const cw_mesh *mesh, const cw_quality *q,
                                          const cw_level_set_desc *desc, const double *level,
                                          cw_volume *volume, cw_error *err);

/* Numbers a level set's leaves by their places; false: no memory. */
bool cwi_level_set_leaves(const cw_volume *volume, cwi_lattice_map *leaves);

/* Returns a sample of it; NULL: there is none. */
float *cwi_level_set_voxel(const cw_volume *volume, const cwi_lattice_map *leaves,
                           const uint32_t at[3]);

#endif
