/* Moves samples of a distance from a mesh to the features that they miss: sharp edges, tips,
 * and walls and gaps thinner than a voxel.
 *
 * Each sample stands for the cube of points that are nearest to it along every axis. If a sharp
 * edge or a thin wall runs through that cube and the sample is on the wrong side of the
 * surface, it is moved within its cube to the right one, and has the distance from there.
 * Samples of successive cubes along an edge are neighbours in the grid, so marching cubes joins
 * them. Its vertices, which lie between samples, then follow the samples. */
#ifndef EXTRACT_LEVEL_SET_FEATURE_WARP_H
#define EXTRACT_LEVEL_SET_FEATURE_WARP_H

#include "core/geometry/lattice_map.h"

#include <cubewright/mesh.h>
#include <cubewright/volume.h>

/* A sample that was moved. */
typedef struct cwi_move {
    uint32_t at[3];
    int rank;               /* corners go before edges, edges before faces */
    double distance_sq;     /* of the distance it is moved by, in voxels */
    double displacement[3]; /* voxels */
    double value;           /* mm */
} cwi_move;

typedef struct cwi_warp {
    cwi_move *moves; /* in the order in which `numbers` numbers their samples */
    size_t count, capacity;
    cwi_lattice_map numbers;
    double corner[3], voxel; /* where sample 0 stands in the world; mm */
} cwi_warp;

/* Moves samples: their values in the volume become those at the new places. Free with
 * cwi_warp_free(), also after an error.
 * volume   of cwi_level_set_make() with level 0
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_warp_init(cwi_warp *warp, const cw_mesh *mesh, cw_volume *volume,
                                     cw_error *err);
void cwi_warp_free(cwi_warp *warp);

/* Moves the vertices of the surface that was extracted from these samples. They follow the
 * samples, and then go to the mesh, as far as nothing crosses or becomes flat.
 * surface  free of crossings, before and after
 * Returns  as cw_self_intersections(); CW_ERR_NO_MEMORY: then vertices are where they may cross
 * Threads  the same to the bit for any number */
CW_NODISCARD cw_status cwi_unwarp(const cwi_warp *warp, const cw_mesh *mesh, int threads,
                                  const cw_progress *progress, cw_mesh *surface, cw_error *err);

/* Finds the n-th of the eight samples around a place in the grid, and returns its trilinear
 * weight. */
double cwi_warp_corner(const double at[3], int n, uint32_t corner[3]);

/* Finds the move of a sample; NULL: the sample was not moved. */
cwi_move *cwi_warp_find(const cwi_warp *warp, const uint32_t at[3]);

/* Stores a move, in place of the sample's earlier move, if any. Returns false without
 * memory. */
bool cwi_warp_put(cwi_warp *warp, const cwi_move *move);

#endif
