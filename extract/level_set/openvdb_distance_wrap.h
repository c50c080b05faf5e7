/* OpenVDB behind plain C: the functions of the module "levelset". They find how far the voxels
 * of an even grid are from a mesh, where that is not far. */
#ifndef EXTRACT_LEVEL_SET_OPENVDB_DISTANCE_WRAP_H
#define EXTRACT_LEVEL_SET_OPENVDB_DISTANCE_WRAP_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_distances_desc {
    const cw_mesh *mesh;
    double first[3]; /* where voxel 0 stands, relative to the mesh's origin */
    double voxel_mm;
    double reach; /* distances are found up to this number of voxels, on both sides */
    int threads;
    cw_progress progress;
} cwi_distances_desc;

/* Distances in leaves, each 8 x 8 x 8 voxels: all leaves within reach of the mesh, and few
 * others. */
typedef struct cwi_distances cwi_distances;

typedef struct cwi_levelset_functions {
    /* Free with close. The same for any number of threads.
     * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED; CW_ERR_BACKEND */
    cw_status (*open)(const cwi_distances_desc *desc, cwi_distances **out, cw_error *err);
    size_t (*leaves)(const cwi_distances *distances);
    /* Takes a leaf's place, in leaves, and the distances of its voxels from the mesh, in
     * voxels, x fastest: never negative. Beyond the reach it is the reach. */
    void (*take)(const cwi_distances *distances, size_t leaf, int32_t at[3], float voxels[512]);
    void (*close)(cwi_distances *distances); /* harmless on NULL */
} cwi_levelset_functions;

extern CW_API const cwi_levelset_functions cwi_module_levelset;

#ifdef __cplusplus
}
#endif

#endif
