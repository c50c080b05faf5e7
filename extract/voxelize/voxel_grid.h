/* The grid of a voxelization, and meshes in its index space. */
#ifndef EXTRACT_VOXELIZE_VOXEL_GRID_H
#define EXTRACT_VOXELIZE_VOXEL_GRID_H

#include <cubewright/voxelize.h>

/* Makes a volume of zeros with the grid that is asked for. Errors as cw_voxelize(). */
CW_NODISCARD cw_status cwi_voxel_grid_make(const cw_mesh *const *meshes, size_t count,
                                           const cw_voxelize_desc *desc, cw_type type,
                                           cw_volume *out, cw_error *err);

/* Computes the fractional indices of a mesh's vertices. Returns -1 where the frame is mirrored, else 1. */
int cwi_voxel_grid_map(const cw_volume *grid, const cw_mesh *mesh, int threads,
                       double (*points)[3]);

#endif
